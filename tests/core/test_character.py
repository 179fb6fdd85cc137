"""A character is a build with proportions put upon it."""

from dataclasses import replace

import pytest

from studio.core.body.morphology import Proportions
from studio.io.project.character_file import bundled_characters


def test_a_character_without_sliders_moved_has_the_measures_of_its_build():
    for character in bundled_characters().values():
        assert character.morphology == character.build


def test_a_stature_slider_scales_the_character():
    child = bundled_characters()["child"]
    assert replace(child, proportions=Proportions(stature=1.5)).morphology.stature == pytest.approx(1.8)


def test_the_five_characters_are_told_apart_by_name_and_colour():
    characters = bundled_characters().values()
    assert [c.colour for c in characters] == ["#7FB4E6", "#E8A95B", "#8FCB8A", "#D98BB5", "#B9A6E8"]
    assert len({c.name for c in characters}) == 5


def test_builds_differ_clearly_in_proportion():
    bodies = {name: character.build for name, character in bundled_characters().items()}
    legs = {name: body.leg_length / body.stature for name, body in bodies.items()}
    arms = {name: body.arm[0].sum() / body.stature for name, body in bodies.items()}
    heads = {name: body.head / body.stature for name, body in bodies.items()}
    assert max(arms, key=arms.__getitem__) == "giant"
    assert max(heads, key=heads.__getitem__) == "child"
    assert max(legs, key=legs.__getitem__) == "tall_man"
    assert legs["stocky_man"] < legs["adult_woman"] - 0.03
