"""The mannequins: closed, symmetric, plausible bodies, one for each character."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from studio.core.body.canonical import BodyPart
from studio.core.body.morphology import Proportions
from studio.core.body.rest_pose import rest_pose
from studio.core.mannequin.physiques import BUNDLED_PHYSIQUES
from studio.core.mannequin.sculpt import make_mannequin
from studio.core.mesh.character import Character
from studio.core.mesh.hand_shapes import FIST_GRIP, HALF_CLOSED_GRIP, OPEN_GRIP, RELAXED_GRIP
from studio.core.mesh.skin import fit_skin, with_grip
from studio.io.project.character_file import bundled_characters, read_character, write_character

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


def test_a_mannequin_is_a_body_and_ten_fingers_none_of_them_with_a_handle(character: Character):
    vertices, triangles = len(character.skin.vertices), len(character.skin.triangles)
    edges = character.skin.triangles[:, [0, 1, 1, 2]].reshape(-1, 2)
    links = coo_array((np.ones(len(edges)), edges.T), shape=(vertices, vertices))
    surfaces, _ = connected_components(links, directed=False)
    assert surfaces == 11
    assert vertices - triangles / 2 == 2 * surfaces


def test_fingers_begin_within_the_palm_and_end_at_the_finger_tips(character: Character):
    skin, body = character.skin, character.build
    for side, part in enumerate((BodyPart.LEFT_HAND, BodyPart.RIGHT_HAND)):
        positions, rotations = rest_pose(body)
        hand = skin.vertices[(skin.segments[:, 0] == body.layout.segment_of_part(part)) & (skin.weights[:, 0] == 1.0)]
        along = (hand - positions[body.layout.wrist_point(side)]) @ rotations[body.layout.segment_of_part(part)][:, 2]
        assert along.max() == pytest.approx(np.linalg.norm(body.hand[side]), rel=0.12)


def test_finger_tips_come_to_the_palm_as_a_hand_closes(character: Character):
    body, reach = character.build, []
    wrist, hand = rest_pose(body)[0][body.layout.wrist_point(0)], body.layout.segment_of_part(BodyPart.LEFT_HAND)
    for grip in (OPEN_GRIP, RELAXED_GRIP, HALF_CLOSED_GRIP, FIST_GRIP):
        skin = with_grip(character.skin, grip)
        held = skin.vertices[(skin.segments[:, 0] == hand) & (skin.weights[:, 0] == 1.0)]
        reach.append(float(((held - wrist) @ rest_pose(body)[1][hand][:, 2]).max() / np.linalg.norm(body.hand[0])))
    assert reach == sorted(reach, reverse=True)
    assert reach[0] > 0.95
    assert reach[-1] < 0.75


def test_only_thumbs_and_fingers_change_with_the_grip(character: Character):
    fist = with_grip(character.skin, FIST_GRIP)
    moved = np.flatnonzero(np.abs(fist.vertices - character.skin.vertices).max(axis=1) > 0.0)
    hands = [character.build.layout.segment_of_part(part) for part in (BodyPart.LEFT_HAND, BodyPart.RIGHT_HAND)]
    assert np.isin(character.skin.segments[moved, 0], hands).all()
    assert np.linalg.norm(fist.normals, axis=1) == pytest.approx(1.0, abs=1e-3)
    assert with_grip(character.skin, RELAXED_GRIP) is character.skin


def test_a_fist_grows_with_its_body(character: Character):
    grown = Proportions(stature=1.3).applied_to(character.build)
    closed_then_grown = fit_skin(with_grip(character.skin, FIST_GRIP), character.build, grown)
    grown_then_closed = with_grip(fit_skin(character.skin, character.build, grown), FIST_GRIP)
    assert grown_then_closed.vertices == pytest.approx(closed_then_grown.vertices, abs=1e-5)
    assert grown_then_closed.normals == pytest.approx(closed_then_grown.normals, abs=1e-3)


def test_a_character_keeps_its_grip_in_its_file(character: Character, tmp_path: Path):
    write_character(replace(character, grip=0.5), tmp_path / "kept.json")
    again = read_character(tmp_path / "kept.json")
    assert again.grip == 0.5
    assert np.array_equal(again.shown_skin.vertices, with_grip(character.skin, 0.5).vertices)


def test_a_face_has_a_nose_and_eyes_that_lie_behind_it(character: Character):
    skin, body = character.skin, character.build
    joint, unit = rest_pose(body)[0][body.layout.head_joint], body.head / 0.088
    face = (skin.vertices - joint) / unit
    face = face[face[:, 0] > 0.03]

    def front(y: float, z: float) -> float:
        near = np.argsort(np.hypot(face[:, 1] - y, face[:, 2] - z))[:3]
        return float(face[near, 0].mean())

    nose, eye, brow = front(0.0, -0.001), front(0.0175, 0.021), front(0.0175, 0.034)
    assert nose > brow + 0.008 > eye + 0.010


def test_left_and_right_mirror_each_other(character: Character):
    vertices = np.round(character.skin.vertices.astype(float), 3)
    mirrored = vertices * [1, -1, 1]
    distance = np.array([np.abs(vertices - vertex).max(axis=1).min() for vertex in mirrored[::7]])
    assert distance.max() < 2.1e-3


def test_it_stands_on_the_ground(character: Character):
    assert character.skin.vertices[:, 2].min() == pytest.approx(0, abs=0.005)


def test_its_size_suits_a_viewport_and_every_segment_carries_some_of_it(character: Character):
    skin = character.skin
    assert len(skin.vertices) >= 4000
    assert len(skin.triangles) <= 15000
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
    again = make_mannequin(BUNDLED_PHYSIQUES[name][2])
    bundled = bundled_characters()[name]
    assert len(again.vertices) == pytest.approx(len(bundled.skin.vertices), rel=0.02)
    assert BUNDLED_PHYSIQUES[name][2].morphology() == bundled.build
