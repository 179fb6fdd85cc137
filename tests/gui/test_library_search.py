"""The search field of the library panel: rows by words of their names."""

from dataclasses import replace

import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QLineEdit

from studio.app.actions import ACTIONS
from studio.app.preferences import key_maps, keys_with
from studio.core.stage.prop import Prop
from studio.io.project.project_file import new_document_id, read_project, write_project
from studio.panels.library_rows import rows_of
from tests.builders import make_project

CONTROL, SHIFT = Qt.KeyboardModifier.ControlModifier, Qt.KeyboardModifier.ShiftModifier


@pytest.fixture
def project():
    """Two bodies, a constraint on the left wrist, a table."""
    project = make_project(characters=2)
    wrist = replace(project.constraints["constraint 0"], name="Left wrist")
    return project.with_entity("constraints", "constraint 0", wrist).with_entity(
        "props", "prop", Prop("Round Table", (1.0, 1.0, 1.0), (1.0, 0.0, 0.0))
    )


def texts(window):
    return [row.text for row in window.library.model.rows]


def write(window, words):
    window.library.search_field.clear()
    QTest.keyClicks(window.library.search_field, words)


@pytest.mark.parametrize("words", ["left wrist", "WRIST  left ", "left w"])
def test_each_word_must_occur_in_any_order_and_case_and_heads_without_hits_go(window, words):
    write(window, words)
    assert texts(window) == ["Constraints", "1 · Left wrist"]


def test_hits_of_all_sections_stand_below_their_heads(window):
    write(window, "d")
    project_rows = texts(window)[: texts(window).index("Scenes")]
    assert project_rows == ["Characters", "Body 0", "Body 1", "Stage", "Ground", "Round Table"]
    write(window, "body table")
    [row] = window.library.model.rows
    assert row.hint
    assert "body table" in row.text


def test_spaces_alone_hide_nothing(window):
    before = window.library.model.rows
    write(window, "  ")
    assert window.library.model.rows == before


@pytest.mark.parametrize(
    ("name", "words"), [("Mu\u0308ller", "m\u00fcller"), ("M\u00dcLLER", "mu\u0308ll"), ("Straße", "STRASSE")]
)
def test_accents_and_letters_are_found_however_they_are_encoded(project, name, words):
    named = replace(project.captures["capture"], name=name)
    rows = rows_of(project.with_entity("captures", "capture", named), None, words)
    assert [row.text for row in rows] == ["Captures", name]


def test_the_key_shows_a_closed_panel_and_escape_lists_everything_and_keeps_the_selection(qtbot, window):
    document, library = window.bench.document, window.library
    before = texts(window)
    document.selection.set(("performers", "performer 1"))
    window.docks["Outliner"].hide()
    QTest.keyClick(window, Qt.Key.Key_F, CONTROL | SHIFT)
    qtbot.waitUntil(library.search_field.hasFocus)
    QTest.keyClicks(library.search_field, "round table")
    assert texts(window) == ["Stage", "Round Table"]
    assert document.selection.items == (("performers", "performer 1"),)
    QTest.keyClick(library.search_field, Qt.Key.Key_Escape)
    assert texts(window) == before
    assert document.selection.items == (("performers", "performer 1"),)
    assert [index.data() for index in library.view.selectionModel().selectedIndexes()] == ["Body 1"]
    assert library.view.hasFocus()


def test_down_goes_to_the_list_and_not_through_time(qtbot, window):
    library, playhead = window.library, window.bench.document.playhead
    window.search_library()
    qtbot.waitUntil(library.search_field.hasFocus)
    before = playhead.time
    QTest.keyClick(library.search_field, Qt.Key.Key_Down)
    assert library.view.hasFocus()
    assert playhead.time == before


def test_a_row_that_is_renamed_comes_and_goes_by_its_name(window):
    document = window.bench.document
    write(window, "round table")
    prop = document.project.props["prop"]
    document.replace("props", "prop", replace(prop, name="Chair"), "Rename")
    assert "Chair" not in texts(window)
    document.undo_stack.undo()
    assert texts(window) == ["Stage", "Round Table"]


def test_a_project_that_is_opened_is_listed_whole(window):
    write(window, "table")
    window.actions_by_id.by_id["new"].trigger()
    assert window.library.search_field.text() == ""
    assert "Captures" in texts(window)


def test_the_window_does_not_begin_in_the_field(window):
    assert not window.library.search_field.hasFocus()


def test_no_key_map_gives_the_key_of_the_search_to_anything_else():
    defaults = {action.id: action.shortcuts for action in ACTIONS}
    for each in key_maps().values():
        assert [key for key, keys in keys_with(defaults, each.keys).items() if "Ctrl+Shift+F" in keys] == [
            "search_library"
        ]


def test_captures_and_characters_are_found_by_tags_that_are_typed_in_their_forms(window, tmp_path):
    document, inspector = window.bench.document, window.inspector
    for item, tags in ((("captures", "capture"), "Slow, calm,slow , "), (("performers", "performer 1"), "hero")):
        document.selection.set(item)
        fields = inspector.findChildren(QLineEdit)
        [field] = [each for each in fields if each.accessibleName() == "Tags" and each.isVisible()]
        field.setFocus()
        QTest.keyClicks(field, tags)
        QTest.keyClick(field, Qt.Key.Key_Return)
    assert document.project.motions["motion"].tags == ("Slow", "calm", "slow")
    assert document.project.characters["character 1"].tags == ("hero",)
    assert document.history == ("Set tags of walk", "Set tags of Body 1")
    for words, found in (("calm walk", "walk"), ("HERO", "Body 1")):
        write(window, words)
        assert found in texts(window)
        assert len(texts(window)) == 2
    write_project(tmp_path / "tagged.studio", document.project, new_document_id())
    assert read_project(tmp_path / "tagged.studio").project.motions["motion"].tags == ("Slow", "calm", "slow")
    document.undo_stack.undo()
    assert document.project.characters["character 1"].tags == ()
