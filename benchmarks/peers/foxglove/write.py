"""Writes the messages of an MCAP file into another one with foxglove-sdk, once for each line it is told.

    python write.py SOURCE TARGET

Chunks and compression are those of MART's recorder. Answers how long it took, in seconds.
"""

import json
import sys
import time
from pathlib import Path

import foxglove
from foxglove import Channel, Schema
from foxglove.mcap import MCAPWriteOptions
from mcap.reader import make_reader


def main() -> None:
    source, target = map(Path, sys.argv[1:])
    with source.open("rb") as file:
        found = [
            (channel.topic, schema.name, schema.data, message.data, message.log_time)
            for schema, channel, message in make_reader(file).iter_messages(log_time_order=False)
        ]
    channels = {}
    for topic, name, data, *_ in found:
        if topic not in channels:
            schema = Schema(name=name, encoding="protobuf", data=data)
            channels[topic] = Channel(topic, schema=schema, message_encoding="protobuf")
    for _ in sys.stdin:
        began_s, began_cpu_s = time.perf_counter(), time.process_time()
        options = MCAPWriteOptions(chunk_size=256 * 1024, compression_threads=0)
        with foxglove.open_mcap(target, allow_overwrite=True, writer_options=options):
            for topic, _, _, payload, log_time in found:
                channels[topic].log(payload, log_time=log_time)
        taken = {"wall_s": time.perf_counter() - began_s, "cpu_s": time.process_time() - began_cpu_s}
        print(json.dumps(taken | {"messages": len(found), "bytes": target.stat().st_size}), flush=True)


main()
