"""Preferences: kept between runs, acting at once; key maps and the user's own keys."""

import json

import pytest
from PySide6.QtGui import QKeySequence

from studio.app.actions import ACTIONS
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

DEFAULTS = {row.id: row.shortcuts for row in ACTIONS}


@pytest.mark.parametrize("name", list(key_maps()))
def test_a_bundled_map_names_actions_that_exist_and_keys_that_qt_knows_without_conflict(name):
    _, changed = key_maps()[name]
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
    with pytest.raises(ValueError, match="'Hello' is no key"):
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
    dialog.map.chosen.emit("blender")
    action = window.actions_by_id.by_id
    assert action["move_tool"].shortcut().toString() == "G"
    assert "G" not in {each.toString() for each in action["ghost"].shortcuts()}
    line = next(place for place, row in enumerate(ACTIONS) if row.id == "play")
    dialog.table.item(line, 1).setText("P")
    assert action["play"].shortcut().toString() == "P"
    assert load_preferences(window.bench.settings).own_keys == {"play": ("P",)}
    dialog.table.item(line, 1).setText("Nonsense")
    assert "is no key" in dialog.words.text()
    assert action["play"].shortcut().toString() == "P"
    dialog.close()
