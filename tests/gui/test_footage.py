"""Reference footage: the frame of the playhead in its panel, of films and of numbered pictures."""

import os

import numpy as np
import pytest
from PIL import Image
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest

from studio.app import relinking
from studio.app.verbs.media import add_footage
from studio.core.errors import StudioError
from studio.core.stage.footage import Footage
from studio.engine.footage_frames import READ_AHEAD_FRAMES, FootageFrame, FootageFrames
from studio.io.media.film import write_film
from studio.io.media.footage_file import MOST_FOOTAGE_SIDE_PIXELS, footage_frames, read_footage, sequence_of
from studio.io.media.media_files import MediaMissing, find_media
from studio.io.project.project_file import new_document_id, read_project, write_project
from tests.patience import PATIENCE

BITS, CELL = 8, 32


def numbered(index):
    """(CELL, BITS * CELL, 3) picture whose cells are the bits of a number."""
    cells = [np.full((CELL, CELL, 3), 255 * ((index >> bit) & 1), np.uint8) for bit in range(BITS)]
    return np.concatenate(cells, axis=1)


def number_in(picture):
    """Number that a picture, perhaps compressed, shows."""
    middle = picture[CELL // 2, CELL // 2 :: CELL, 0]
    return sum(int(value > 127) << bit for bit, value in enumerate(middle[:BITS]))


def number_on(image):
    return sum((image.pixelColor(bit * CELL + CELL // 2, CELL // 2).red() > 127) << bit for bit in range(BITS))


def write_numbered_film(path, frames, frame_rate):
    alpha = np.full((CELL, BITS * CELL, 1), 255, np.uint8)
    pictures = (np.concatenate([numbered(k), alpha], axis=2) for k in range(frames))
    write_film(path, pictures, (BITS * CELL, CELL), frame_rate)
    return path


def write_sequence(folder, numbers, stem="shot.", suffix=".png"):
    folder.mkdir(exist_ok=True)
    for index, number in enumerate(numbers):
        Image.fromarray(numbered(index)).save(folder / f"{stem}{number}{suffix}")
    return folder


@pytest.mark.parametrize("frame_rate", [24.0, 29.97, 60.0])
def test_every_frame_of_a_film_is_found_from_wherever_one_begins(tmp_path, frame_rate):
    path = write_numbered_film(tmp_path / "walk.mp4", 120, frame_rate)
    footage = read_footage(path)
    assert (footage.name, footage.frames, footage.file_rate) == ("walk", 120, pytest.approx(frame_rate, abs=0.01))
    for first in (0, 1, 2, 31, 64, 119):
        read = [
            number_in(picture) for picture, _ in zip(footage_frames(path, frame_rate, first), range(4), strict=False)
        ]
        assert read == list(range(first, min(first + 4, 120)))
    assert len(list(footage_frames(path, frame_rate, 0))) == 120


@pytest.mark.parametrize("suffix", [".png", ".jpg"])
def test_numbered_pictures_are_in_the_order_of_their_numbers_whichever_is_chosen(tmp_path, suffix):
    folder = write_sequence(tmp_path / "shots", [8, 9, 10, 100], suffix=suffix)
    write_sequence(folder, [1, 2], stem="other")
    footage = read_footage(folder / f"shot.10{suffix}")
    assert (footage.name, footage.frames) == ("shot", 4)
    assert [each.stem for each in sequence_of(folder / f"shot.9{suffix}")] == [
        "shot.8",
        "shot.9",
        "shot.10",
        "shot.100",
    ]
    assert [number_in(each) for each in footage_frames(folder / f"shot.8{suffix}", 30.0, 1)] == [1, 2, 3]


def test_large_pictures_are_scaled_in_their_proportions(tmp_path):
    Image.new("RGB", (4000, 1000)).save(tmp_path / "wide_1.png")
    assert next(footage_frames(tmp_path / "wide_1.png", 30.0, 0)).shape == (
        MOST_FOOTAGE_SIDE_PIXELS // 4,
        MOST_FOOTAGE_SIDE_PIXELS,
        3,
    )


def test_what_holds_no_pictures_is_a_sentence(tmp_path):
    for name in ("notes.mp4", "notes_1.png"):
        (tmp_path / name).write_text("no pictures", encoding="utf-8")
        with pytest.raises(StudioError, match=r"notes"):
            read_footage(tmp_path / name)
    with pytest.raises(StudioError, match="not there any more"):
        read_footage(tmp_path / "gone.mp4")


@pytest.mark.parametrize(
    "wrong", [{"frames": 0}, {"frame_rate": 0.0}, {"file_rate": float("nan")}, {"start": float("inf")}]
)
def test_footage_that_cannot_be_is_refused(wrong):
    with pytest.raises(ValueError, match="footage 'Walk'"):
        Footage(**{"name": "Walk", "source": "walk.mp4", "frames": 10, "file_rate": 24.0, "frame_rate": 24.0, **wrong})


def test_offset_and_rate_say_which_frame_is_seen():
    footage = Footage("Walk", "walk.mp4", 10, 25.0, 12.5, start=1.0)
    assert footage.end == 1.8
    assert [footage.frame_at(seconds) for seconds in (0.99, 1.0, 1.079, 1.08, 1.79, 1.8)] == [None, 0, 0, 1, 9, None]


def wait_for(qtbot, frames, frame):
    """The picture of a frame, when it has been read."""
    qtbot.waitUntil(lambda: frames.picture(frame) is not None, timeout=PATIENCE)
    return frames.picture(frame)


def test_frames_are_read_ahead_in_both_directions_and_memory_is_bounded(qtbot, tmp_path):
    path = write_numbered_film(tmp_path / "walk.mp4", 200, 30.0)
    size = numbered(0).nbytes
    frames = FootageFrames(cached_bytes=(2 * READ_AHEAD_FRAMES + 5) * size)
    try:
        for index in (150, 149, 148, 3, 199, 100):
            assert number_in(wait_for(qtbot, frames, FootageFrame(path, 30.0, 200, index))) == index
        ahead = FootageFrame(path, 30.0, 200, 100)
        qtbot.waitUntil(lambda: (path, 100 + READ_AHEAD_FRAMES) in frames._kept, timeout=PATIENCE)
        wait_for(qtbot, frames, FootageFrame(path, 30.0, 200, ahead.index - 1))
        assert (path, ahead.index - 1 - READ_AHEAD_FRAMES) in frames._kept
        assert frames.bytes_kept <= (2 * READ_AHEAD_FRAMES + 5) * size
        assert frames.bytes_kept == sum(each.nbytes for each in frames._kept.values())
    finally:
        frames.close()
    assert not frames._thread.is_alive()


def test_a_film_shorter_than_it_says_keeps_its_last_frame(qtbot, tmp_path):
    path = write_numbered_film(tmp_path / "walk.mp4", 20, 30.0)
    frames = FootageFrames()
    assert number_in(wait_for(qtbot, frames, FootageFrame(path, 30.0, 40, 18))) == 18
    assert number_in(wait_for(qtbot, frames, FootageFrame(path, 30.0, 40, 25))) == 19
    frames.close()


@pytest.fixture
def filmed(qtbot, window, tmp_path):
    """The window with a film of two seconds in its panel."""
    path = write_numbered_film(tmp_path / "walk.mp4", 60, 30.0)
    add_footage(window.bench, path)
    qtbot.waitUntil(lambda: bool(window.bench.document.project.footage), timeout=PATIENCE)
    return window, window.footage_playback.view, path


def seen(qtbot, view, number):
    qtbot.waitUntil(lambda: not view.image.isNull() and number_on(view.image) == number, timeout=PATIENCE)


def test_the_panel_shows_the_frame_of_the_playhead_with_its_offset_and_rate(qtbot, filmed):
    window, view, _ = filmed
    document = window.bench.document
    [(key, footage)] = document.project.footage.items()
    assert not window.docks["Footage"].isHidden()
    document.playhead.set_time(0.4)
    seen(qtbot, view, 12)
    assert view.words == "walk, frame 13 of 60"
    editor = window.inspector.editor
    editor._start.setValue(0.3)
    seen(qtbot, view, 3)
    editor._rate.setValue(60.0)
    seen(qtbot, view, 6)
    document.playhead.set_time(0.1)
    assert view.image.isNull()
    assert "no frame here" in view.words
    for _ in range(2):
        document.undo_stack.undo()
    assert document.project.footage[key] == footage
    seen(qtbot, view, 3)
    document.undo_stack.undo()
    assert not document.project.footage
    assert "No footage yet" in view.words


def test_footage_is_written_and_found_again_where_its_file_has_moved(qtbot, filmed, tmp_path, monkeypatch):
    window, view, path = filmed
    document = window.bench.document
    (tmp_path / "project").mkdir()
    project_file = tmp_path / "project" / "stage.studio"
    write_project(project_file, document.project, new_document_id())
    moved = path.rename(tmp_path / "project" / "walk.mp4")
    document.show_opened(read_project(project_file))
    window.bench.settings.folder = tmp_path
    document.playhead.set_time(0.2)
    seen(qtbot, view, 6)
    moved = moved.rename(tmp_path / "project" / "other.mp4")
    document.show_opened(read_project(project_file))
    assert window.strip.text == "The file walk.mp4 of walk cannot be found. Relink it."
    monkeypatch.setattr(relinking, "ask_file", lambda bench, title, kind, then: then(moved))
    window.strip.press("Relink…")
    document.playhead.set_time(0.5)
    seen(qtbot, view, 15)
    document.undo_stack.undo()
    assert [each.source for each in document.project.footage.values()] == [str(path)]


def test_footage_is_shown_once_its_file_is_back_where_it_was_and_relinked_there(qtbot, filmed, tmp_path, monkeypatch):
    window, view, path = filmed
    document, project_file = window.bench.document, tmp_path / "stage.studio"
    write_project(project_file, document.project, new_document_id())
    away = path.rename(tmp_path / "away")
    document.show_opened(read_project(project_file))
    assert view.words == "walk.mp4 cannot be shown: the file is missing or unreadable."
    away.rename(path)
    monkeypatch.setattr(relinking, "ask_file", lambda bench, title, kind, then: then(path))
    window.strip.press("Relink…")
    document.playhead.set_time(0.5)
    seen(qtbot, view, 15)


@pytest.mark.parametrize("source", ["x" * 5000, "\0", "/dev/null/walk.mp4", "gone.mp4"])
def test_a_source_that_no_file_can_have_is_missing_footage(source, tmp_path):
    with pytest.raises(MediaMissing, match="of walk cannot be found"):
        find_media(source, "walk", (tmp_path,))


def test_pipes_and_folders_are_no_pictures_of_a_sequence(tmp_path):
    write_sequence(tmp_path, (1, 2))
    (tmp_path / "shot.3.png").mkdir()
    os.mkfifo(tmp_path / "shot.4.png")
    assert len(sequence_of(tmp_path / "shot.1.png")) == 2


def test_nothing_is_read_while_the_panel_is_hidden(qtbot, window, tmp_path):
    footage = Footage("Walk", str(tmp_path / "gone.mp4"), 60, 30.0, 30.0)
    window.bench.document.add("footage", footage, "Add footage")
    window.bench.document.playhead.set_time(0.4)
    assert window.footage_playback.frames._thread is None
    assert window.strip.text == ""


def test_the_bar_of_footage_is_dragged_selected_and_deleted_on_the_timeline(timeline, document, hand):
    key = document.add("footage", Footage("Walk", "walk.mp4", 30, 30.0, 30.0), "Add footage")
    grabbed = QPoint(round(timeline.x_of_frame(10)), timeline.row_rect("footage", key).center().y())
    hand.drag(grabbed, round(timeline.x_of_frame(30) - timeline.x_of_frame(10)))
    assert document.project.footage[key].start == pytest.approx(20 / 60, abs=1.5 / 60)
    document.undo_stack.undo()
    assert document.project.footage[key].start == 0.0
    hand.press(grabbed)
    hand.release()
    assert document.selection.current == ("footage", key)
    QTest.keyClick(timeline.tracks, Qt.Key.Key_Delete)
    assert not document.project.footage
