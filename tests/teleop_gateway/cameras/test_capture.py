"""OpenCV captures: a file at its own rate, again and again; what is not there is a sentence, and logs nothing."""

from __future__ import annotations

from pathlib import Path

import pytest

from mart.protocol import clock
from mart.teleop_gateway.cameras.camera_source import load_source
from mart.teleop_gateway.cameras.capture import CameraFailure, OpenCvCapture
from tests.teleop_gateway.cameras.fake_capture import write_video


def test_a_file_plays_at_its_own_rate_and_begins_anew_at_its_end(tmp_path: Path) -> None:
    capture = OpenCvCapture(load_source(write_video(tmp_path / "green.avi", (60, 180, 30))))
    capture.open()
    begun_s = clock.monotonic_s()
    pictures = [capture.read() for _ in range(30)]  # of 25, 25 a second
    assert clock.monotonic_s() - begun_s > 1.0
    assert all(picture.shape == (240, 320, 3) for picture in pictures)
    assert pictures[26][120, 160].tolist() == pytest.approx([30, 180, 60], abs=20)  # BGR
    capture.close()


@pytest.mark.parametrize("source", ["97", "/dev/video97", "rtsp://ana:geheim@127.0.0.1:1/x", "bad.mp4"])
def test_what_cannot_be_opened_is_a_sentence_without_its_address(
    source: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("bad.mp4").write_text("no video")
    with pytest.raises(CameraFailure) as failed:
        OpenCvCapture(load_source(source)).open()
    out, err = capfd.readouterr()
    assert str(failed.value) == "It cannot be opened"
    assert out + err == ""
