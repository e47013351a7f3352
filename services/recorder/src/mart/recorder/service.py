"""`mart recorder`: bus, capture and recorder, put together."""

from __future__ import annotations

from contextlib import closing

from mart.protocol.vocabulary import ServiceKind
from mart.recorder.record.inbox import Inbox, RoomSubscriptions
from mart.recorder.record.recorder import Recorder
from mart.recorder.settings import RecorderSettings
from mart.recorder.verify.resimulation import replica, verify
from mart.runtime.bus.zenoh_bus import ZenohBus
from mart.runtime.service import announced, connected


def serve_recorder(settings: RecorderSettings, name: str) -> None:
    """Until the process is asked to stop; what is being recorded then is saved as it is."""
    inbox = Inbox()
    with (
        connected(settings, ServiceKind.RECORDER, name) as service,
        ZenohBus.connect(settings.router) as video_bus,
    ):
        ask = replica(service.bus, settings.replica)
        recorder = Recorder(settings.data_dir, service.bus, inbox, lambda file, room: verify(file, room, ask))
        with closing(RoomSubscriptions(service.bus, video_bus, inbox)), announced(service):
            recorder.run(service.stop)
