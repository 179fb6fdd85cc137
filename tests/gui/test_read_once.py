"""A file that is dropped on the window is opened once to be recognised and once to be read, beside the window."""

import subprocess
import sys
import threading

import pytest

from studio.app.application import import_views, show_views
from studio.app.verbs.files import open_path
from studio.core.captures import remarks
from studio.core.captures.annotations import Annotations, Label
from studio.core.normalized import normalize
from studio.io.export import take_of_capture, write_take
from tests.builders import make_capture
from tests.gui.window_use import drop, wait_until_idle
from tests.io.fbx_skin import skinned_fbx
from tests.io.fbx_text import fbx_text
from tests.patience import SECONDS

opened: dict[str, list[bool]] = {}
"""By path, for each time that it was opened, whether the window's own thread did it."""


def _hear(event, arguments):
    if event == "open" and str(arguments[0]) in opened:
        opened[str(arguments[0])].append(threading.current_thread() is threading.main_thread())
    if event == "subprocess.Popen":
        for path in set(map(str, arguments[1])) & set(opened):
            opened[path].append(threading.current_thread() is threading.main_thread())


sys.addaudithook(_hear)


@pytest.fixture
def watched():
    """Have a path watched from now on."""
    yield lambda path: opened.setdefault(str(path), [])
    opened.clear()


def put(path, frames=30):
    """Write the take, or the text, that a file of this suffix holds."""
    if path.suffix == ".fbx":
        path.write_text(skinned_fbx() if path.stem == "hero" else fbx_text())
    else:
        write_take(take_of_capture(make_capture(frames=frames), Annotations(labels=(Label("turn", 3, 3),))), path)


@pytest.mark.parametrize("name", ["walk.bvh", "walk.c3d", "walk.s4d", "walk.glb", "walk.fbx", "hero.fbx"])
def test_a_dropped_file_is_recognised_once_and_read_once_beside_the_window(qtbot, window, tmp_path, watched, name):
    put(tmp_path / name)
    times = watched(tmp_path / name)
    captures = len(window.bench.document.project.captures)
    drop(window, tmp_path / name)
    wait_until_idle(qtbot, window)
    assert len(window.bench.document.project.captures) == captures + (name not in ("hero.fbx", "walk.glb"))
    assert times == [False, False]


def test_a_dropped_capture_is_normalised_once_for_its_contacts_and_its_bodies(qtbot, window, tmp_path, monkeypatch):
    measured, real = [], normalize.measure_actor
    put(tmp_path / "jump.bvh", frames=41)

    def measure(marks, *rest):
        measured.append(len(marks.points))
        return real(marks, *rest)

    monkeypatch.setattr(normalize, "measure_actor", measure)
    drop(window, tmp_path / "jump.bvh")
    wait_until_idle(qtbot, window)
    assert window.bench.live.wait_until_solved(SECONDS)
    assert measured.count(41) == 1


def test_what_is_odd_about_a_capture_is_looked_for_once_beside_the_window(qtbot, window, tmp_path, monkeypatch):
    looked, real, frames = [], remarks.joint_positions, 41
    put(tmp_path / "jump.bvh", frames=frames)

    def positions(skeleton, poses):
        looked.append((poses.frame_count, threading.current_thread() is threading.main_thread()))
        return real(skeleton, poses)

    monkeypatch.setattr(remarks, "joint_positions", positions)
    import_views()
    show_views(window)
    drop(window, tmp_path / "jump.bvh")
    wait_until_idle(qtbot, window)
    document = window.bench.document
    document.selection.set(("captures", list(document.project.captures)[-1]))
    assert window.bench.live.wait_until_solved(SECONDS)
    assert [each for each in looked if each[0] == frames] == [(frames, False)]
    document.save(tmp_path / "shot.studio")
    looked.clear()
    open_path(window.bench, tmp_path / "shot.studio")
    wait_until_idle(qtbot, window)
    assert window.bench.live.wait_until_solved(SECONDS)
    assert (frames, False) in looked
    assert not any(on_the_windows for _, on_the_windows in looked)


def test_a_file_whose_kind_was_corrected_is_read_no_more_often(qtbot, window, tmp_path, watched):
    put(tmp_path / "first.bvh")
    drop(window, tmp_path / "first.bvh")
    wait_until_idle(qtbot, window)
    window.inspector.reimport_requested.emit(list(window.bench.document.project.captures)[-1], {"unit": "inch"})
    wait_until_idle(qtbot, window)
    put(tmp_path / "second.bvh")
    times = watched(tmp_path / "second.bvh")
    drop(window, tmp_path / "second.bvh")
    wait_until_idle(qtbot, window)
    assert list(window.bench.document.project.captures.values())[-1].unit == "inch"
    assert times == [False, False]


def test_what_cannot_be_read_is_told_from_beside_the_window_too(qtbot, window, tmp_path, watched):
    (tmp_path / "notes.bvh").write_text("no motion")
    times = watched(tmp_path / "notes.bvh")
    drop(window, tmp_path / "notes.bvh")
    wait_until_idle(qtbot, window)
    assert window.strip.text.endswith("Your project was not changed.")
    assert times
    assert not any(times)


def test_watching_sees_a_file_that_is_opened_on_the_window_s_own_thread(tmp_path, watched):
    path = tmp_path / "walk.bvh"
    put(path)
    times = watched(path)
    path.read_bytes()
    subprocess.run([sys.executable, "-c", "", str(path)], check=True)
    assert times == [True, True]
