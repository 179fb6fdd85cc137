"""Scenes in the library: bundled ones and recent projects, found, seen, and dragged onto the stage."""

from dataclasses import replace

import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QPushButton

from studio.app.application import show_viewport
from studio.app.verbs import files
from studio.io.project.project_file import new_document_id, read_thumbnail, write_project
from studio.library.scenes import SCENES, BundledScene
from studio.panels.thumbnails import THUMBNAIL_PIXELS
from tests.builders import make_project
from tests.gui.test_library_drags import drag
from tests.gui.test_library_search import texts, write
from tests.gui.test_thumbnails import wait_for
from tests.gui.viewport_use import settle
from tests.patience import PATIENCE

CLAP = ("scenes", "clap")


@pytest.fixture
def stage(window):
    show_viewport(window)
    return window.bench.viewport


@pytest.fixture
def opened(window, monkeypatch):
    """Titles of scenes that are made; each has two bodies."""
    titles = []

    def make(scene):
        titles.append(scene.title)
        return make_project(characters=2)

    monkeypatch.setattr(BundledScene, "make", make)
    return titles


def press(window, text):
    buttons = window.question.findChildren(QPushButton)
    button = next(each for each in buttons if each.text() == text and each.isVisible())
    QTest.mouseClick(button, Qt.MouseButton.LeftButton)


def edit(document):
    performer = document.project.performers["performer 0"]
    document.replace("performers", "performer 0", replace(performer, name="Edited"), "Rename")


def test_scenes_are_listed_last_and_found_by_words_of_titles_and_tags(window):
    assert texts(window)[-len(SCENES) :] == [scene.title for scene in SCENES]
    write(window, "clap")
    assert texts(window) == ["Scenes", "A clap"]
    write(window, "fight live")
    assert texts(window) == ["Scenes", "Fight training", "Sparring"]


def test_every_scene_has_a_picture_and_says_what_it_shows(window):
    library = window.library
    wait_for(lambda: all(library.thumbnails.of("scenes", scene.key) is not None for scene in SCENES))
    for scene in SCENES:
        picture = library.thumbnails.of("scenes", scene.key).toImage()
        assert (picture.width(), picture.height()) == (THUMBNAIL_PIXELS, THUMBNAIL_PIXELS)
        row = [each for each in library.model.rows if each.item == ("scenes", scene.key)]
        assert scene.text in library.model.index(library.model.rows.index(*row)).data(Qt.ItemDataRole.ToolTipRole)


def test_a_scene_that_is_dragged_onto_the_stage_opens_as_from_the_menu(qtbot, window, stage, opened):
    document = window.bench.document
    assert drag(window, CLAP, stage)
    qtbot.waitUntil(lambda: len(document.project.performers) == 2, timeout=PATIENCE)
    assert opened == ["A clap"]
    assert document.undo_stack.count() == 0
    document.playhead.pause()


def test_unsaved_work_is_asked_about_before_a_dragged_scene_opens(qtbot, window, stage, opened):
    document = window.bench.document
    document.new(make_project(characters=1))
    edit(document)
    assert drag(window, CLAP, stage)
    assert opened == []
    press(window, "Cancel")
    assert document.project.performers["performer 0"].name == "Edited"
    assert drag(window, CLAP, stage)
    press(window, "Don't save")
    qtbot.waitUntil(lambda: len(document.project.performers) == 2, timeout=PATIENCE)
    document.playhead.pause()


def test_a_click_on_a_scene_keeps_the_selection_of_the_project(window):
    document, library = window.bench.document, window.library
    document.new(make_project(characters=1))
    document.selection.set(("performers", "performer 0"))
    library.view.scrollTo(library.model.index(len(library.model.rows) - 1))
    QTest.mouseClick(library.view.viewport(), Qt.MouseButton.LeftButton, pos=library.row_rect(CLAP).center())
    assert document.selection.items == (("performers", "performer 0"),)
    assert [index.data() for index in library.view.selectionModel().selectedIndexes()] == ["A clap"]


def test_a_saved_project_is_listed_with_the_stage_as_its_picture_and_dragged_back(qtbot, window, stage, tmp_path):
    document, library, path = window.bench.document, window.library, tmp_path / "duel.studio"
    document.new(make_project(characters=2))
    qtbot.waitUntil(lambda: not stage.drawn_image.isNull(), timeout=PATIENCE)
    settle(stage)
    files.save_to(window.bench, path)
    qtbot.waitUntil(lambda: "duel.studio" in texts(window), timeout=PATIENCE)
    assert read_thumbnail(path)
    item = ("projects", str(path))
    wait_for(lambda: library.thumbnails.of(*item) is not None)
    picture = library.thumbnails.of(*item).toImage()
    assert len({picture.pixel(x, y) for x in range(0, 72, 4) for y in range(0, 72, 4)}) > 20
    window.actions_by_id.by_id["new"].trigger()
    assert drag(window, item, stage)
    qtbot.waitUntil(lambda: document.path == path, timeout=PATIENCE)


def test_a_file_without_a_picture_has_none(window, tmp_path):
    path = tmp_path / "plain.studio"
    write_project(path, make_project(), new_document_id())
    assert read_thumbnail(path) is None
    for content in (b"", b"no archive", path.read_bytes()[:2000]):
        (tmp_path / "broken.studio").write_bytes(content)
        assert read_thumbnail(tmp_path / "broken.studio") is None
    assert read_thumbnail(tmp_path / "gone.studio") is None
    window.library.show_recent([path, tmp_path / "broken.studio"])
    assert texts(window)[-len(SCENES) - 2 : -len(SCENES)] == ["plain.studio", "broken.studio"]
    assert window.library.thumbnails.of("projects", str(path)) is None
