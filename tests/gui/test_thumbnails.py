"""Pictures in the library: of captures and characters, drawn beside the window, once each."""

import gc
import threading
import time
import weakref
from dataclasses import replace

from PySide6.QtGui import QImage
from PySide6.QtTest import QTest

from studio.core.stage.project import Project
from studio.document.document import Document
from studio.io.project.character_file import bundled_characters
from studio.library.scenes import SCENES
from studio.panels import thumbnails
from studio.panels.library_delegate import COLLECTIONS_WITH_PICTURE
from studio.panels.thumbnails import _square, capture_picture, character_picture
from tests.builders import make_capture, make_project
from tests.patience import SECONDS


def filled(picture: QImage) -> list[tuple[int, int]]:
    """Columns and rows of pixels that are not transparent."""
    return [(x, y) for y in range(picture.height()) for x in range(picture.width()) if picture.pixelColor(x, y).alpha()]


def wait_for(done) -> None:
    end = time.monotonic() + SECONDS
    while not done() and time.monotonic() < end:
        QTest.qWait(5)
    assert done()


def test_a_character_fills_its_picture_upright_and_on_both_sides_alike(qapp):
    pixels = filled(character_picture(bundled_characters()["stocky_man"]))
    columns, rows = ([each[axis] for each in pixels] for axis in (0, 1))
    assert max(max(rows) - min(rows), max(columns) - min(columns)) >= thumbnails.THUMBNAIL_PIXELS - 14
    middle = sum(columns) / len(columns)
    assert abs(middle - thumbnails.THUMBNAIL_PIXELS / 2) < 2.0
    assert len(pixels) > 500


def test_a_capture_shows_its_poses_within_the_picture(qapp):
    assert len(filled(capture_picture(make_capture()))) > 200
    assert len(filled(capture_picture(make_capture(body_map=None)))) > 200


def test_every_row_gets_its_picture_drawn_beside_the_window_and_only_once(window, monkeypatch):
    threads = []
    draw = thumbnails.character_picture

    def counted(character):
        threads.append(threading.current_thread())
        return draw(character)

    monkeypatch.setattr(thumbnails, "character_picture", counted)
    library, document = window.library, window.bench.document
    key = document.add("characters", bundled_characters()["child"], "Add")
    items = [row.item for row in library.model.rows if row.item and row.item[0] in COLLECTIONS_WITH_PICTURE]
    assert ("characters", key) in items
    wait_for(lambda: all(library.thumbnails.of(*item) is not None for item in items))
    count = len(threads)
    assert threading.main_thread() not in threads
    character = document.project.characters[key]
    document.replace("characters", key, replace(character, name="Other"), "Rename")
    assert library.thumbnails.of("characters", key) is not None
    assert len(threads) == count


def test_pictures_go_with_their_project_after_those_of_files_were_read_again(window):
    """A new table of pictures was no longer the one that is cleared when another project is opened."""
    thumbnails, document = window.library.thumbnails, window.bench.document
    thumbnails.forget_saved()
    document.new(make_project())
    skin = weakref.ref(next(iter(document.project.characters.values())).skin)
    wait_for(lambda: all(thumbnails.of("characters", key) for key in document.project.characters))
    document.new(Project())
    wait_for(lambda: gc.collect() >= 0 and skin() is None)  # a pose that is being solved holds it for a moment


def test_a_picture_that_is_being_drawn_keeps_nothing_of_the_window(qapp, monkeypatch):
    """Else the drawing thread let go of it last and destroyed objects of Qt that the window's thread was using."""
    started, go_on = threading.Event(), threading.Event()

    def slow(character):
        started.set()
        assert go_on.wait(SECONDS)
        return QImage()

    monkeypatch.setattr(thumbnails, "character_picture", slow)
    document = Document(make_project())
    pictures = thumbnails.Thumbnails(document)
    assert pictures.of("characters", next(iter(document.project.characters))) is None
    assert started.wait(SECONDS)
    kept = weakref.ref(pictures)
    del pictures
    gc.collect()
    try:
        assert kept() is None
    finally:
        go_on.set()
        document.close()


def test_a_file_that_is_no_picture_has_no_thumbnail():
    assert _square(b"").isNull()
    assert _square(b"<svg xmlns='http://www.w3.org/2000/svg'/>").isNull()
    assert not _square(SCENES[0].picture.read_bytes()).isNull()
