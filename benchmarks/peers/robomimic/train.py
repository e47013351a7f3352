"""robomimic's BC-RNN or HBC on an HDF5 file, a few updates at a time.

    train.py FILE bc|hbc

Runs in its own virtual environment (requirements.txt beside it). Reads a number of updates a line from standard input;
answers each with one line of JSON: how long they took, and what robomimic logs about them, means over them.
"""

from __future__ import annotations

import json
import sys
import time

import model  # first: it stands in for what robomimic wants for pictures
import robomimic
import robomimic.utils.train_utils as training
import torch


def main(path: str, algorithm: str) -> None:
    torch.manual_seed(0)
    learning = model.learner(path, algorithm, model.Sizes())
    sizes = {"parameters": model.parameters(learning.model), "windows": len(learning.data)}
    for number, line in enumerate(sys.stdin, 1):
        begun_s = time.perf_counter()
        logged = training.run_epoch(learning.model, learning.loader, epoch=number, num_steps=int(line))
        took_s = time.perf_counter() - begun_s
        answer = {"version": robomimic.__version__, "took_s": took_s, "losses": logged} | sizes
        print(json.dumps(answer), flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
