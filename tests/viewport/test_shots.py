"""A film is asked of another process in plain data: nothing that is read is run."""

from io import BytesIO
from pathlib import Path

import pytest

from studio.core.body.canonical import BodyPart
from studio.core.constraints.base import BodyPoint
from studio.document.journal import StateHash
from studio.viewport.camera import OrbitCamera
from studio.viewport.shots import Shots, View, receive_shots, send_shots
from tests.architecture.sources import ROOT
from tests.builders import make_project


@pytest.mark.parametrize("stem", [None, Path("film") / "film"])
def test_what_is_sent_is_received_to_the_bit(stem: Path | None) -> None:
    view = View(OrbitCamera((0.1, 0.2, 0.3), parallel=True), 640.0, True, BodyPoint(BodyPart.LEFT_HAND), "performer 0")
    shots = Shots(make_project(), view, (0.0, 1 / 3, 2 / 3), (320, 200), stem)
    stream = BytesIO()
    send_shots(shots, stream)
    stream.seek(0)
    got = receive_shots(stream)
    assert (got.view, got.times, got.size, got.stem) == (shots.view, shots.times, shots.size, shots.stem)
    assert StateHash().of(got.project) == StateHash().of(shots.project)


def test_nothing_of_the_studio_reads_pickled_objects() -> None:
    for file in (ROOT / "studio").rglob("*.py"):
        text = file.read_text(encoding="utf-8")
        assert "import pickle" not in text, file
        assert "allow_pickle=True" not in text, file
