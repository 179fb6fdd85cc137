"""A film of the 3D view from the window: written beside it, cancelled without a trace."""

from types import SimpleNamespace

import pytest
from imageio_ffmpeg import count_frames_and_secs

from studio.app import filming
from studio.app.application import make_application, make_window
from studio.app.settings import Settings
from studio.document.document import Document
from studio.viewport.camera import OrbitCamera
from tests.builders import make_project

PATIENCE = 60_000
SMALL = (160, 90)


@pytest.fixture
def window(qtbot, tmp_path):
    make_application()
    window = make_window(Settings(tmp_path / "studio.ini"), Document(make_project(characters=1)))
    quiet = {name: lambda *_: None for name in ("trail_point", "show_progress", "close", "show_again")}
    window.bench.viewport = SimpleNamespace(camera=OrbitCamera(), **quiet)
    window.bench.document.playhead.set_range(6, 18)
    (tmp_path / "out").mkdir()
    yield window
    window.bench.viewport = None
    window.leave()
    window.deleteLater()


def idle(qtbot, window):
    qtbot.waitUntil(lambda: not window.bench.runner.running, timeout=PATIENCE)


def test_the_range_of_the_timeline_becomes_a_film(qtbot, window, tmp_path):
    filming.film(window.bench, tmp_path / "out" / "walk.mp4", SMALL, 30.0)
    idle(qtbot, window)
    assert "walk.mp4" in window.strip.text
    assert count_frames_and_secs(str(tmp_path / "out" / "walk.mp4"))[0] == 7


def test_a_cancelled_film_leaves_nothing_and_the_next_one_is_whole(qtbot, window, tmp_path):
    shares = []
    runner = window.bench.runner

    def stop(task, share, _text):
        shares.append(share)
        if share > 0.3:
            runner.cancel(task)

    runner.progressed.connect(stop)
    filming.film(window.bench, tmp_path / "out" / "shots", SMALL, 30.0)
    idle(qtbot, window)
    assert max(shares) < 1.0
    assert list((tmp_path / "out").iterdir()) == []
    runner.progressed.disconnect(stop)
    filming.film(window.bench, tmp_path / "out" / "shots", SMALL, 30.0)
    idle(qtbot, window)
    assert len(list((tmp_path / "out" / "shots").iterdir())) == 7
