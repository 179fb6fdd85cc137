"""Preferences: kept between runs, acting at once; key maps and the user's own keys."""

import json
from dataclasses import replace

import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtGui import QDesktopServices, QKeySequence
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QToolButton

from studio.app.actions import ACTIONS
from studio.app.application import show_views
from studio.app.preferences import (
    Preferences,
    conflicts_in,
    key_maps,
    keys_in,
    keys_with,
    load_preferences,
    save_preferences,
)
from studio.app.preferences_dialog import PreferencesDialog
from studio.app.settings import Settings
from studio.app.theme import style_sheet
from studio.app.verbs.files import save_to
from studio.core.stage.prop import Prop
from studio.document import colours
from studio.io.project.project_file import read_project
from studio.panels.command_palette import ShortcutSheet
from studio.resources_folder import guide_file
from studio.viewport.body_points import body_joints
from studio.viewport.picking import PickedJoint
from tests.gui.viewport_use import LEFT, MIDDLE, NONE, drag, on_arrow, settle
from tests.patience import PATIENCE

RIGHT = Qt.MouseButton.RightButton
ALT, CTRL, SHIFT = (getattr(Qt.KeyboardModifier, f"{name}Modifier") for name in ("Alt", "Control", "Shift"))
DEFAULTS = {row.id: row.shortcuts for row in ACTIONS}


@pytest.mark.parametrize("name", list(key_maps()))
def test_a_bundled_map_names_actions_that_exist_and_keys_that_qt_knows_without_conflict(name):
    changed = key_maps()[name].keys
    assert changed.keys() <= DEFAULTS.keys()
    assert all(QKeySequence(key).toString() for keys in changed.values() for key in keys)
    keys = keys_with(DEFAULTS, changed)
    assert conflicts_in(keys) == {}
    for action, given in changed.items():
        assert keys[action] == tuple(QKeySequence(key).toString() for key in given)


def test_a_key_goes_to_the_last_who_gives_it_and_two_of_one_layer_are_a_conflict():
    keys = keys_with({"one": ("A",), "two": ("B", "C")}, {"one": ("B",)}, {"gone": ("C",)})
    assert keys == {"one": ("B",), "two": ("C",)}
    assert conflicts_in(keys_with(keys, {"one": ("X",), "two": ("X",)})) == {"X": ("one", "two")}


def test_what_a_person_types_is_keys_or_a_sentence():
    assert keys_in("ctrl+shift+k  F5") == ("Ctrl+Shift+K", "F5")
    assert keys_in("") == ()
    with pytest.raises(ValueError, match="'Hello' is not a shortcut"):
        keys_in("Hello")


def test_preferences_are_kept_and_what_makes_no_sense_in_the_file_is_left_aside(tmp_path):
    settings = Settings(tmp_path / "studio.ini")
    mine = Preferences(rotate_step=5.0, key_map="maya", own_keys={"play": ("P",)})
    save_preferences(settings, mine)
    assert load_preferences(Settings(tmp_path / "studio.ini")) == mine
    settings.preferences = {"rotate_step": -1.0, "move_step": "far", "scale_step": 5.0, "unknown": 3, "own_keys": 7}
    assert load_preferences(settings) == Preferences(scale_step=5.0)
    settings._store.setValue("preferences", "{")
    assert load_preferences(settings) == Preferences()
    assert json.loads(json.dumps(settings.preferences)) == {}


def test_a_map_that_is_chosen_and_a_key_that_is_typed_act_at_once(window):
    dialog = PreferencesDialog(window.bench)
    dialog.map.value_chosen.emit("blender")
    action = window.actions_by_id.by_id
    assert action["move_tool"].shortcut().toString() == "G"
    assert "G" not in {each.toString() for each in action["ghost"].shortcuts()}
    line = next(index for index, row in enumerate(ACTIONS) if row.id == "play")
    dialog.table.item(line, 1).setText("P")
    assert action["play"].shortcut().toString() == "P"
    assert load_preferences(window.bench.settings).own_keys == {"play": ("P",)}
    dialog.table.item(line, 1).setText("Nonsense")
    assert "is not a shortcut" in dialog.words.text()
    assert action["play"].shortcut().toString() == "P"
    dialog.close()


CAMERA_BUTTONS = {
    "studio": ((LEFT, ALT), (MIDDLE, NONE), (RIGHT, ALT)),
    "maya": ((LEFT, ALT), (MIDDLE, ALT), (RIGHT, ALT)),
    "blender": ((MIDDLE, NONE), (MIDDLE, SHIFT), (MIDDLE, CTRL)),
    "motionbuilder": ((LEFT, CTRL | SHIFT), (LEFT, SHIFT), (LEFT, CTRL)),
}
"""Buttons and keys that orbit, pan and zoom in each program."""


@pytest.mark.parametrize("width", [1600, 1280])
def test_tools_in_the_bar_show_the_keys_of_the_map(window, width):
    """With Blender's keys the bar said ``R scale``, and R rotated."""
    window.resize(width, 800)
    dialog = PreferencesDialog(window.bench)
    dialog.map.value_chosen.emit("blender")
    QApplication.processEvents()
    texts = {button.text() for button in window.top_bar.findChildren(QToolButton) if button.defaultAction()}
    assert texts in ({"W select", "G move", "R rotate", "S scale"}, {"W", "G", "R", "S"})
    dialog.close()


def test_the_camera_is_moved_by_the_buttons_of_the_map_and_the_gizmo_keeps_its_own(window, qtbot):
    show_views(window)
    viewport, document = window.bench.viewport, window.bench.document
    dialog = PreferencesDialog(window.bench)
    qtbot.waitUntil(lambda: bool(viewport.posed), timeout=PATIENCE)
    document.selection.set(("performers", "performer 0"), ("constraints", "constraint 0"))
    viewport.frame_selection()
    settle(viewport)
    corner, step = QPoint(30, viewport.height() - 30), QPoint(40, -20)
    for name, buttons in CAMERA_BUTTONS.items():
        dialog.map.value_chosen.emit(name)
        for (button, held), changed in zip(buttons, ("azimuth", "target", "distance"), strict=True):
            before = viewport.camera
            drag(viewport, corner, corner + step, button, held)
            seen = {
                each for each in ("azimuth", "target", "distance") if vars(viewport.camera)[each] != vars(before)[each]
            }
            assert seen == {changed}, (name, button, held)
            viewport.set_camera(before)
        assert document.selection.current == ("constraints", "constraint 0")
    settle(viewport)
    before = viewport.camera
    drag(viewport, on_arrow(viewport, "z", 0.7), on_arrow(viewport, "z", 1.2), modifiers=SHIFT)
    assert viewport.camera == before
    assert document.undo_stack.count() == 1
    dialog.close()


@pytest.mark.parametrize(
    "wrong",
    [
        {"theme": "pink"},
        {"activation": "sometimes"},
        {"interface_scale": 10},
        {"autosave_minutes": -1},
        {"onion_step": 0},
    ],
)
def test_a_preference_out_of_its_range_is_refused(wrong):
    [name] = wrong
    with pytest.raises(ValueError, match=name):
        Preferences(**wrong)


def luminance(colour):
    """Relative luminance of ``#RRGGBB``, as WCAG has it."""
    parts = [int(colour[k : k + 2], 16) / 255.0 for k in (1, 3, 5)]
    linear = [part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


@pytest.mark.parametrize("theme", list(colours.THEMES))
@pytest.mark.parametrize(
    ("text", "least"),
    [("TEXT", 4.5), ("TEXT_SECOND", 4.5), ("TEXT_THIRD", 4.5), ("PARTLY", 3.0), ("NOT_REACHED", 3.0)],
)
@pytest.mark.parametrize("ground", ["PANEL", "BAR", "WELL"])
def test_words_can_be_read_on_every_ground_of_every_theme(theme, text, least, ground):
    """Contrasts of WCAG 2: 4.5 for words, 3 for words that stand out by their colour, too."""
    values = colours.THEMES[theme]
    bright, dark = sorted((luminance(values[text]), luminance(values[ground])), reverse=True)
    assert (bright + 0.05) / (dark + 0.05) >= least


def test_a_theme_is_taken_whole_and_the_3d_view_keeps_its_own_colours():
    try:
        colours.use_theme("light")
        assert {name: getattr(colours, name) for name in colours.LIGHT} == colours.LIGHT
        assert colours.DARK["TEXT"] == colours.STAGE_TEXT
        assert colours.LIGHT["PANEL"] in style_sheet()
    finally:
        colours.use_theme("dark")
    assert colours.DARK["PANEL"] in style_sheet()


def test_autosave_writes_a_project_that_has_a_file_and_has_changed(qtbot, window, tmp_path):
    document, path = window.bench.document, tmp_path / "stage.studio"
    window._autosave.timeout.emit()
    assert document.path is None
    save_to(window.bench, path)
    qtbot.waitUntil(lambda: document.path is not None, timeout=PATIENCE)
    window.set_preferences(replace(window.bench.preferences, autosave_minutes=5))
    assert window._autosave.interval() == 300_000
    document.add("props", Prop("Box"), "Add a box")
    window._autosave.timeout.emit()
    qtbot.waitUntil(lambda: not document.dirty, timeout=PATIENCE)
    assert [each.name for each in read_project(path).project.props.values()] == ["Box"]
    window.set_preferences(replace(window.bench.preferences, autosave_minutes=0))
    assert not window._autosave.isActive()


def test_new_constraints_act_for_the_whole_clip_if_that_is_preferred(studio):
    viewport, document, _ = studio
    for fits in (True, False):
        viewport.fits_activation = fits
        pose = viewport.posed["performer 0"]
        joint = next(one for one in body_joints(pose.motion.morphology.layout) if one.name == "right wrist")
        viewport.pick(PickedJoint("performer 0", joint))
        constraint_id = viewport.add_constraint_at_pick()
    clip = document.project.performers["performer 0"].clips[0]
    rate = document.project.frame_rate_of(clip)
    curve = document.project.constraints[constraint_id].activation
    assert (curve.start, curve.end) == (clip.first / rate, clip.last / rate)


def test_help_opens_the_guide_or_says_where_it_is(window, monkeypatch):
    opened, said = [], []
    window.bench.message_posted.connect(lambda message: said.append(message.sentence))
    monkeypatch.setattr(QDesktopServices, "openUrl", lambda url: opened.append(url.toLocalFile()) or len(opened) == 1)
    QTest.keyClick(window, Qt.Key.Key_F1)
    assert opened == [str(guide_file())]
    assert guide_file().read_text(encoding="utf-8").startswith("# Guide")
    assert said == []
    QTest.keyClick(window, Qt.Key.Key_F1)
    assert str(guide_file()) in said[0]


@pytest.mark.parametrize("opened", ["preferences", "shortcuts"])
def test_a_dialog_fits_on_the_screen(window, opened):
    dialog = {
        "preferences": lambda: PreferencesDialog(window.bench),
        "shortcuts": lambda: ShortcutSheet(window, window.actions_by_id.by_menu()),
    }[opened]()
    dialog.show()
    room = window.screen().availableSize()
    assert dialog.width() <= room.width()
    assert dialog.height() <= room.height()
    dialog.close()
