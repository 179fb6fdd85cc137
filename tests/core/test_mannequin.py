"""The mannequins: closed, symmetric, plausible bodies, one for each character."""

import numpy as np
import pytest

from studio.core.character import Character
from studio.core.mannequin.physiques import BUNDLED
from studio.core.mannequin.sculpt import make_mannequin
from studio.io.character_file import bundled_characters

STATURES = {"adult_woman": 1.66, "tall_man": 1.94, "stocky_man": 1.68, "child": 1.20, "giant": 2.21}


@pytest.fixture(params=STATURES)
def character(request: pytest.FixtureRequest) -> Character:
    return bundled_characters()[request.param]


def volume(character: Character) -> float:
    a, b, c = np.moveaxis(character.skin.vertices[character.skin.triangles].astype(float), 1, 0)
    return float(np.einsum("ti,ti->", a, np.cross(b, c)) / 6)


@pytest.mark.parametrize("name", STATURES)
def test_each_character_has_the_stature_it_is_known_for(name: str):
    character = bundled_characters()[name]
    assert character.build.stature == pytest.approx(STATURES[name])
    assert np.ptp(character.skin.vertices[:, 2]) == pytest.approx(STATURES[name], rel=0.01)


def test_the_surface_is_closed_and_each_edge_is_shared_by_two_triangles_in_opposite_order(
    character: Character,
):
    triangles = character.skin.triangles
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    assert len(np.unique(edges, axis=0)) == len(edges)
    assert np.array_equal(np.unique(edges, axis=0), np.unique(edges[:, ::-1], axis=0))


def test_a_mannequin_is_one_ball_without_handles(character: Character):
    vertices, triangles = len(character.skin.vertices), len(character.skin.triangles)
    assert vertices - triangles / 2 == 2


def test_left_and_right_mirror_each_other(character: Character):
    vertices = np.round(character.skin.vertices.astype(float), 3)
    mirrored = vertices * [1, -1, 1]
    distance = np.array([np.abs(vertices - vertex).max(axis=1).min() for vertex in mirrored[::7]])
    assert distance.max() < 2.1e-3


def test_it_stands_on_the_ground(character: Character):
    assert character.skin.vertices[:, 2].min() == pytest.approx(0, abs=0.005)


def test_its_size_suits_a_viewport_and_every_segment_carries_some_of_it(character: Character):
    skin = character.skin
    assert 4000 <= len(skin.vertices) <= 6500
    strong = skin.segments[skin.weights > 0.4]
    assert np.bincount(strong, minlength=character.build.layout.segment_count).min() >= 5


def test_no_weight_leaks_from_one_side_to_the_limbs_of_the_other(character: Character):
    skin, layout = character.skin, character.build.layout
    margin = 0.035 * character.build.stature
    for side, beyond in ((0, skin.vertices[:, 1] < -margin), (1, skin.vertices[:, 1] > margin)):
        limbs = [*range(layout.spine_count + 2 + 4 * side, layout.spine_count + 6 + 4 * side)]
        limbs += [segment + 8 for segment in limbs]
        leaked = np.isin(skin.segments, limbs) & (skin.weights > 0.02)
        assert not leaked[beyond].any()


def test_triangles_are_even(character: Character):
    corners = character.skin.vertices[character.skin.triangles]
    sides = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)
    ratio = sides.max(axis=1) / sides.min(axis=1)
    assert np.median(ratio) < 1.4
    assert np.percentile(ratio, 99.5) < 3.0


def test_normals_point_outwards(character: Character):
    skin = character.skin
    a, b, c = np.moveaxis(skin.vertices[skin.triangles], 1, 0)
    facing = np.einsum("ti,ti->t", np.cross(b - a, c - a), skin.normals[skin.triangles].mean(axis=1))
    assert (facing > 0).mean() > 0.999
    assert volume(character) > 0


def test_bodies_weigh_what_such_people_weigh():
    litres = {name: 1000 * volume(character) for name, character in bundled_characters().items()}
    assert 45 < litres["adult_woman"] < 72
    assert 62 < litres["tall_man"] < 95
    assert 75 < litres["stocky_man"] < 120
    assert 17 < litres["child"] < 30
    assert 130 < litres["giant"] < 220


def test_sculpting_again_gives_the_bundled_mesh():
    name = "child"
    again = make_mannequin(BUNDLED[name][2])
    bundled = bundled_characters()[name]
    assert len(again.vertices) == pytest.approx(len(bundled.skin.vertices), rel=0.02)
    assert BUNDLED[name][2].morphology() == bundled.build
