"""A film of the 3D view from the window: drawn beside it, as it looks there, cancelled without a trace."""

import os
import sys
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from imageio_ffmpeg import count_frames_and_secs
from PIL import Image
from PySide6.QtGui import QImage

from studio.app import filming
from studio.app.application import make_application, make_window
from studio.app.settings import Settings
from studio.core.captures.contacts import ContactPoint
from studio.core.errors import StudioError
from studio.document.document import Document
from studio.io.project.character_file import bundled_characters
from studio.viewport.camera import OrbitCamera
from studio.viewport.film_pictures import render_shots
from studio.viewport.paths import contact_marks
from studio.viewport.shots import Shots, View
from studio.viewport.stage_picture import StageScene
from studio.viewport.widget import Viewport
from tests.builders import make_contact, make_project
from tests.patience import PATIENCE

SMALL = (160, 90)
CHIPS = 60
VIEW = View(OrbitCamera(), 90.0)


@pytest.fixture
def window(qtbot, tmp_path):
    make_application()
    project = make_project(characters=1)
    project = project.with_entity("characters", "character 0", bundled_characters()["adult_woman"])
    window = make_window(Settings(tmp_path / "studio.ini"), Document(project))
    quiet = {name: lambda *_: None for name in ("show_progress", "close", "redraw")}
    window.bench.set_viewport(SimpleNamespace(view=VIEW, **quiet))
    window.bench.document.playhead.set_range(6, 18)
    (tmp_path / "out").mkdir()
    yield window
    window.bench.set_viewport(None)
    window.close_without_saving()
    window.deleteLater()


@pytest.fixture
def viewport(qtbot, window):
    """A real one, its body adapted and its ghost there."""
    bench = window.bench
    viewport = Viewport(bench.document, bench.live)
    viewport.resize(640, 360)
    bench.set_viewport(viewport)
    with qtbot.waitSignal(viewport.started, timeout=PATIENCE):
        viewport.show()
    viewport.clearFocus()  # whose mark is no part of the stage
    viewport.set_tool("select")
    viewport.set_ghost_shown(True)
    bench.document.playhead.set_time(0.1)
    qtbot.waitUntil(lambda: bool(viewport.posed) and bench.live.source("motion") is not None, timeout=PATIENCE)
    assert bench.live.wait_until_solved(PATIENCE / 1000)
    yield viewport
    viewport.close()
    viewport.deleteLater()


def idle(qtbot, window):
    qtbot.waitUntil(lambda: not window.bench.runner.running, timeout=PATIENCE)


def seen(viewport):
    """Picture of the widget below its chips, (height, width, 3)."""
    viewport.grab_image()
    image = viewport.grab().toImage().convertToFormat(QImage.Format.Format_RGBX8888)
    pixels = np.frombuffer(image.constBits(), np.uint8).reshape(image.height(), image.width(), 4)
    return pixels[CHIPS:, :, :3].astype(int)


def differing(filmed, viewport):
    """The share of pixels that clearly look otherwise than in the widget."""
    away = np.abs(filmed[CHIPS:, :, :3].astype(int) - seen(viewport))
    return (away.max(axis=2) > 24).mean()


def test_a_film_looks_as_the_viewport_does(qtbot, window, viewport, tmp_path):
    window.bench.document.playhead.set_range(6, 7)
    filming.render_film(window.bench, tmp_path / "out" / "shots", (640, 360), 30.0)
    idle(qtbot, window)
    assert window.strip.text.startswith("Exported")
    with Image.open(tmp_path / "out" / "shots" / "shots_0001.png") as picture:
        filmed = np.asarray(picture)
    assert differing(filmed, viewport) < 0.002
    viewport.set_ghost_shown(False)
    assert differing(filmed, viewport) > 0.002


def test_where_bones_are_seen_bones_are_filmed(window, viewport):
    project = window.bench.document.project
    skin, bones = viewport.view, replace(viewport.view, bones=True)
    viewport.toggle_bones()
    assert viewport.view == bones
    filmed = {view: next(render_shots(Shots(project, view, (0.1,), (640, 360)))) for view in (skin, bones)}
    assert differing(filmed[bones], viewport) < 0.002 < differing(filmed[skin], viewport)


def test_marks_of_contacts_are_not_filmed(window, monkeypatch):
    project, drawn, sync = window.bench.document.project, [], StageScene.sync
    project = project.with_entity("contacts", "heel", make_contact(point=ContactPoint.LEFT_HEEL, first=0, last=20))

    def noted(scene, stage, posed, props, bones, paths):
        drawn.append((contact_marks(stage, posed), paths))
        return sync(scene, stage, posed, props, bones, paths)

    monkeypatch.setattr(StageScene, "sync", noted)
    next(render_shots(Shots(project, VIEW, (0.1,), SMALL)))
    [(marks, paths)] = drawn
    assert marks
    assert paths == []


def test_a_film_of_a_camera_that_follows_goes_with_the_character(qtbot, window, viewport):
    document = window.bench.document
    viewport.set_following(True)
    viewport.grab_image()
    view = viewport.view
    document.playhead.set_frame(18)
    viewport.grab_image()
    there = document.playhead.time
    assert viewport.camera.target != view.camera.target
    filmed = next(render_shots(Shots(document.project, view, (there,), (640, 360))))
    assert differing(filmed, viewport) < 0.002
    still = next(render_shots(Shots(document.project, replace(view, followed=None), (there,), (640, 360))))
    assert differing(still, viewport) > 0.002


def test_the_range_of_the_timeline_becomes_a_film(qtbot, window, tmp_path):
    filming.render_film(window.bench, tmp_path / "out" / "walk.mp4", SMALL, 30.0)
    idle(qtbot, window)
    assert "walk.mp4" in window.strip.text
    assert count_frames_and_secs(str(tmp_path / "out" / "walk.mp4"))[0] == 7


HALF = """
import os, sys, time
print('{"share": 0.5, "text": "Frame 3 of 7"}', file=sys.stderr, flush=True)
os.write(1, bytes(160 * 90 * 4))
"""


@pytest.mark.parametrize("name", ["shots", "walk.mp4"])
def test_a_cancelled_film_ends_what_draws_it_and_leaves_nothing(qtbot, window, tmp_path, monkeypatch, name):
    pid = tmp_path / "pid"
    for_ever = f"{HALF}\nopen({str(pid)!r}, 'w').write(str(os.getpid()))\ntime.sleep(1000)"
    monkeypatch.setattr(filming, "RENDER_COMMAND", (sys.executable, "-c", for_ever))
    runner = window.bench.runner
    runner.progressed.connect(lambda task, share, _: share > 0.3 and pid.exists() and runner.cancel(task))
    filming.render_film(window.bench, tmp_path / "out" / name, SMALL, 30.0)
    idle(qtbot, window)
    assert list((tmp_path / "out").iterdir()) == []
    with pytest.raises(ProcessLookupError):
        os.kill(int(pid.read_text()), 0)


@pytest.mark.parametrize("name", ["shots", "walk.mp4"])
def test_a_crash_of_what_draws_is_a_sentence_and_leaves_nothing(qtbot, window, tmp_path, monkeypatch, name):
    monkeypatch.setattr(filming, "RENDER_COMMAND", (sys.executable, "-c", f"{HALF}\nos.abort()"))
    filming.render_film(window.bench, tmp_path / "out" / name, SMALL, 30.0)
    idle(qtbot, window)
    assert "crashed at 'Frame 3 of 7'" in window.strip.text
    assert list((tmp_path / "out").iterdir()) == []


def test_a_film_that_is_cut_short_is_told(qtbot, window, tmp_path, monkeypatch):
    monkeypatch.setattr(filming, "RENDER_COMMAND", (sys.executable, "-c", HALF))
    filming.render_film(window.bench, tmp_path / "out" / "walk.mp4", SMALL, 30.0)
    idle(qtbot, window)
    assert "could not be written completely" in window.strip.text
    assert list((tmp_path / "out").iterdir()) == []


@pytest.mark.timeout(20)
def test_a_film_of_a_day_is_refused_at_once(window, tmp_path):
    window.bench.document.playhead.set_range(0, 9_999_999)
    with pytest.raises(StudioError, match="too many"):
        filming.render_film(window.bench, tmp_path / "out" / "walk.mp4", SMALL, 240.0)


def test_a_film_that_nobody_plays_in_is_refused(window):
    project = window.bench.document.project
    nobody = project.with_entity("performers", "performer 0", None)
    with pytest.raises(StudioError, match="nothing to render"):
        next(render_shots(Shots(nobody, VIEW, (0.0,), SMALL)))
