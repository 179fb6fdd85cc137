"""Grounds that are not level, and walks on them."""

import math
from dataclasses import fields

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from studio.core.captures.contacts import ContactPoint
from studio.core.grounds import GROUND_KINDS, Bumps, HeightMap, Slope, Steps, SurfaceMesh
from studio.core.grounds.ground import Ground
from studio.core.quality.metrics import acceleration_ratio, contact_quality
from studio.core.solver.adapt import adapt
from studio.core.solver.grounding.footprints import planes_under, tilts_of
from studio.core.solver.grounding.grounded_motion import ground_motion
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.io.project.character_file import bundled_characters
from tests.core.motions import walk

# Walks on ground that is not level: the same laws as on the floor, and no ground at all changes nothing.


BODIES = {name: character.morphology for name, character in bundled_characters().items()}
WALK, CONTACTS = walk(180)
TILT = math.radians(15.0)
LEVEL = {
    "slope": Slope(0.1, 0.0, 0.7),
    "steps": Steps(0.1, 0.0),
    "bumps": Bumps(0.1, 0.0),
    "map": HeightMap(0.1, np.zeros((8, 8)), 0.5, (-1.0, -2.0)),
    "mesh": SurfaceMesh(0.1, [[-9, -9, 0], [9, -9, 0], [0, 9, 0]], [[0, 1, 2]]),
    "seen from elsewhere": Slope(0.1, 0.0).seen_from((1.0, 2.0), 0.5),
}
UNEVEN = {
    "up": Slope(0.0, TILT),
    "down": Slope(0.0, -TILT),
    "across": Slope(0.0, TILT, math.pi / 2, (0.0, -3.0)),
    "askew": Slope(0.0, TILT, 0.8, (-3.0, -3.0)),
    "steps up": Steps(0.0, 0.17, 0.30, 12, 0.0, (0.4, 0.0)),
    "steps down": Steps(0.0, -0.17, 0.30, 12, 0.0, (0.4, 0.0)),
    "steps aside": Steps(0.0, 0.17, 0.30, 12, 0.9, (0.4, 0.0)),
    "bumps": Bumps(0.0, 0.08, 1.2, 1),
    "map": HeightMap(0.0, 0.1 * np.random.default_rng(1).normal(size=(20, 20)), 0.6, (-4.0, -6.0)),
}
TURNED = Steps(0.0, 0.17, 0.30, 12, 1.2, (0.4, 1.0)).seen_from((0.7, 0.4), 0.9)


def _adapted(ground: Ground, body: str = "adult_woman") -> AdaptedMotion:
    return adapt(AdaptRequest(WALK, BODIES[body], CONTACTS, (), ground))


@pytest.mark.parametrize("name", LEVEL)
def test_ground_without_rise_is_the_level_floor(name: str) -> None:
    floor, found = _adapted(Ground(0.1)), _adapted(LEVEL[name])
    assert np.allclose(found.positions, floor.positions, rtol=0.0, atol=1e-12)
    assert np.allclose(found.rotations, floor.rotations, rtol=0.0, atol=1e-12)


@pytest.mark.parametrize("body", BODIES)
@pytest.mark.parametrize("name", UNEVEN)
def test_feet_stand_without_slide_float_or_depth(name: str, body: str) -> None:
    quality = contact_quality(_adapted(UNEVEN[name], body), CONTACTS, UNEVEN[name])
    assert quality.slide < 1e-3
    assert quality.rise < 2e-3
    assert quality.penetration < 2e-3


@pytest.mark.parametrize("name", [*UNEVEN])
def test_legs_hardly_jolt_however_the_ground_is(name: str) -> None:
    """Beside the made walk in the air, whose legs turn at the pace of a sine: the slightest jolt is many times that."""
    for body in BODIES:
        free = adapt(AdaptRequest(WALK, BODIES[body], ()))
        assert acceleration_ratio(_adapted(UNEVEN[name], body), free) < 12.0


def test_flat_feet_lie_along_the_slope_and_level_on_steps() -> None:
    for ground, normal in ((UNEVEN["askew"], UNEVEN["askew"].normal_at([0.0, 0.0])), (TURNED, [0.0, 0.0, 1.0])):
        adapted = _adapted(ground)
        layout = adapted.morphology.layout
        for contact in CONTACTS:
            if contact.point in (ContactPoint.LEFT_TOE, ContactPoint.RIGHT_TOE):
                toe = adapted.rotations[
                    contact.first : contact.last + 1, layout.spine_count + 13 + 4 * contact.point.side
                ]
                assert np.allclose(toe[:, :, 2], normal, atol=1e-6)


def test_a_performer_meets_the_same_ground_wherever_its_motion_stands() -> None:
    """Feet of a body that stands elsewhere on the stage are on the stage's ground there."""
    assert contact_quality(_adapted(TURNED), CONTACTS, TURNED).rise < 2e-3
    other = Slope(0.0, TILT, 0.4, (-2.0, 0.0))
    moved = _adapted(other.seen_from((0.0, 1.5), 0.4))
    plain = _adapted(
        Slope(0.0, TILT, 0.0, tuple(np.array([[0.921061, 0.389418], [-0.389418, 0.921061]]) @ [-2.0, -1.5]))
    )
    assert np.allclose(moved.positions, plain.positions, atol=1e-5)


def test_a_raised_ground_of_any_kind_raises_everything() -> None:
    low, high = _adapted(Bumps(0.0, 0.05, 1.3, 3)), _adapted(Bumps(0.5, 0.05, 1.3, 3))
    assert np.allclose(high.positions - low.positions, [0.0, 0.0, 0.5], atol=1e-9)


def test_a_little_more_rise_moves_a_little() -> None:
    for one, other in ((Slope(0, 0.2, 0.5), Slope(0, 0.2001, 0.5)), (Bumps(0, 0.06), Bumps(0, 0.0601))):
        assert np.abs(_adapted(one).positions - _adapted(other).positions).max() < 0.005


def test_the_body_climbs_with_the_steps() -> None:
    up, floor = _adapted(UNEVEN["steps up"]), _adapted(Ground())
    risen = (up.positions - floor.positions)[:, 0, 2]
    under = UNEVEN["steps up"].height_at(up.positions[:, 0])
    assert np.abs(risen - under)[10:-10].max() < 0.35
    assert risen[-20] > 0.5


def test_a_clip_without_contacts_floats_over_the_ground_and_breaks_nothing() -> None:
    for ground in UNEVEN.values():
        standing = ground_motion(WALK, BODIES["adult_woman"], (), ground)
        assert np.isfinite(standing.positions).all()
    apart = ground_motion(WALK, BODIES["adult_woman"], (), Slope(0.0, TILT)).positions[:, 0, 2]
    assert apart[-1] - apart[0] > 0.3


soles = st.integers(0, 2**32 - 1)


@given(soles)
def test_heel_and_ball_lie_on_smooth_ground_under_their_plane(seed: int) -> None:
    random = np.random.default_rng(seed)
    ground = Bumps(0.1, random.uniform(0.0, 0.08), 1.2, seed % 1000)
    heel, way = random.uniform(-3, 3, 2), random.uniform(-math.pi, math.pi)
    sole = heel + np.outer([0.0, 0.17, 0.23], [math.cos(way), math.sin(way)])
    planes = planes_under(ground, sole[None])
    for place in sole[:2]:
        rise = (place - sole[1]) @ (-planes.normals[0, :2] / planes.normals[0, 2])
        assert planes.heights[0] + rise == pytest.approx(ground.height_at(place), abs=1e-9)
    assert not planes.overhangs.any()


@given(st.floats(-15.0, 15.0))
def test_toes_bend_with_a_slope_that_begins_under_the_ball(degrees: float) -> None:
    ground = Slope(0.0, math.radians(degrees), 0.0, (0.16, 0.0))
    planes = planes_under(ground, np.array([[[0.0, 0.0], [0.16, 0.0], [0.24, 0.0]]]))
    assert planes.bends[0] == pytest.approx(math.radians(degrees), abs=1e-9)


@pytest.mark.parametrize("length", [0.15, 0.25, 0.4])
def test_a_foot_lies_over_where_a_slope_begins_however_long_it_is(length: float) -> None:
    ground = Slope(0.0, TILT, 0.0, (0.5 * length, 0.0))
    sole = np.array([[0.0, 0.0], [length, 0.0], [1.5 * length, 0.0]])
    planes = planes_under(ground, sole[None])
    assert planes.heights[0] == pytest.approx(ground.height_at(sole[1]))
    assert planes.normals[0, 0] == pytest.approx(-math.sin(math.atan(0.5 * math.tan(TILT))))
    assert planes.bends[0] == pytest.approx(math.atan(0.5 * math.tan(TILT)))
    assert not planes.overhangs.any()


def test_a_sole_over_an_edge_lies_level_on_the_higher_step() -> None:
    steps = Steps(0.0, 0.17, 0.30, 5)
    sole = np.array([[[-0.05, 0.0], [0.12, 0.0], [0.18, 0.0]]])
    planes = planes_under(steps, sole)
    assert planes.heights[0] == pytest.approx(0.17)
    assert planes.normals[0].tolist() == [0.0, 0.0, 1.0]
    assert planes.overhangs.tolist() == [[True, False]]


@given(soles)
def test_a_tilt_turns_upright_to_the_normal_and_nothing_about_it(seed: int) -> None:
    normals = np.random.default_rng(seed).normal((0.0, 0.0, 3.0), size=(5, 3))
    normals[:, 2] = np.abs(normals[:, 2])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    tilts = tilts_of(normals)
    assert np.allclose(Rotation.from_rotvec(tilts).apply([0.0, 0.0, 1.0]), normals, atol=1e-12)
    assert (tilts[:, 2] == 0.0).all()


# Kinds of ground: heights, normals, the same seen from elsewhere; what is no ground is refused.


seeds = st.integers(0, 2**32 - 1)
RANDOM = np.random.default_rng(4)
CORNERS = np.array([[x, y, 0.2 * np.sin(x + y)] for x in np.linspace(-2, 2, 9) for y in np.linspace(-2, 2, 9)])
CELLS = [9 * i + j for i in range(8) for j in range(8)]
TRIANGLES = [[a, a + 9, a + 1] for a in CELLS] + [[a + 1, a + 9, a + 10] for a in CELLS]
GROUNDS = {
    "flat": Ground(0.2),
    "slope": Slope(0.1, 0.3, 0.7, (0.2, -0.1)),
    "down": Slope(0.1, -0.3, -2.0),
    "steps": Steps(0.1, 0.17, 0.3, 5, 0.4, (0.1, 0.3)),
    "bumps": Bumps(-0.1, 0.1, 1.1, 7),
    "map": HeightMap(0.1, RANDOM.normal(size=(9, 7)) / 10, 0.4, (-1.5, -1.0)),
    "small map": HeightMap(0.0, np.array([[0.0, 0.1], [0.2, 0.3]])),
    "mesh": SurfaceMesh(0.1, CORNERS, TRIANGLES),
}
SMOOTH = ("flat", "bumps")


def places(seed: int, count: int = 40) -> np.ndarray:
    return np.random.default_rng(seed).uniform(-2.5, 2.5, (count, 2))


def test_whole_numbers_of_metres_are_kept_as_floats_for_which_kernels_are_compiled() -> None:
    for ground in (
        Ground(1),
        Slope(1, 1, 2),
        Steps(1, 1, 1, 5),
        Bumps(1, 1, 1, 3),
        HeightMap(1),
        SurfaceMesh(1, CORNERS, TRIANGLES),
    ):
        of_floats = [field.name for field in fields(ground) if field.type is float]
        assert "height" in of_floats
        assert {type(getattr(ground, name)) for name in of_floats} == {float}
    assert type(Steps(1, 1, 1, 5).count) is int


@pytest.mark.parametrize("name", GROUNDS)
@given(seed=seeds)
def test_normals_are_unit_point_up_and_match_finite_differences(name: str, seed: int) -> None:
    ground, xy, step = GROUNDS[name], places(seed), 1e-6
    normals = ground.normal_at(xy)
    assert np.allclose(np.linalg.norm(normals, axis=-1), 1.0, atol=1e-12)
    assert (normals[:, 2] > 0.0).all()
    slopes = [(ground.height_at(xy + d) - ground.height_at(xy - d)) / (2 * step) for d in np.eye(2) * step]
    wrong = np.abs(-normals[:, :2] / normals[:, 2:] - np.stack(slopes, axis=-1)).max(axis=1) > 1e-6
    assert wrong.sum() <= (0 if name in SMOOTH else 1)  # a place may lie on a corner or an edge


@pytest.mark.parametrize("name", [name for name in GROUNDS if name != "steps"])
@given(seed=seeds)
def test_heights_are_continuous(name: str, seed: int) -> None:
    ground, begin = GROUNDS[name], places(seed, 2)
    line = begin[0] + np.linspace(0, 1, 2001)[:, None] * (begin[1] - begin[0])
    inside = np.abs(line).max(axis=1) < 1.99 if name == "mesh" else np.ones(len(line), dtype=bool)
    jumps = np.abs(np.diff(ground.height_at(line)))[inside[1:] & inside[:-1]]
    assert jumps.max(initial=0.0) < 0.01


@pytest.mark.parametrize("name", GROUNDS)
def test_places_of_any_shape_are_answered_each(name: str) -> None:
    ground, xy = GROUNDS[name], places(0, 24)
    as_points = np.column_stack([xy, np.zeros(24)]).reshape(2, 3, 4, 3)
    assert ground.height_at(as_points).shape == (2, 3, 4)
    assert ground.normal_at(as_points).shape == (2, 3, 4, 3)
    assert np.allclose(ground.height_at(as_points).ravel(), ground.height_at(xy), atol=1e-12)
    assert ground.height_at(xy[0]) == pytest.approx(ground.height_at(xy)[0], abs=1e-12)


@pytest.mark.parametrize("name", GROUNDS)
@given(seeds, st.floats(-3, 3), st.floats(-2, 2))
def test_seen_from_elsewhere_it_is_the_same_ground(name: str, seed: int, heading: float, x: float) -> None:
    ground, own = GROUNDS[name], places(seed)
    c, s = math.cos(heading), math.sin(heading)
    turn = np.array([[c, -s], [s, c]])
    stage = own @ turn.T + [x, 0.5]
    seen = ground.seen_from((x, 0.5), heading)
    assert np.allclose(seen.height_at(own), ground.height_at(stage), atol=1e-12)
    assert np.allclose(seen.normal_at(own)[:, :2] @ turn.T, ground.normal_at(stage)[:, :2], atol=1e-9)
    assert seen == ground.seen_from((x, 0.5), heading)


def test_a_slope_rises_from_its_foot_on() -> None:
    slope = Slope(1.0, math.radians(15), math.pi / 2, (5.0, 2.0))
    assert slope.height_at([[0, 1], [9, 2], [0, 3]]) == pytest.approx([1.0, 1.0, 1.0 + math.tan(math.radians(15))])


def test_steps_are_level_and_counted() -> None:
    for rise in (0.17, -0.17):
        steps = Steps(0.5, rise, 0.3, 3)
        heights = steps.height_at([[x, 9.0] for x in (-1.0, 0.01, 0.29, 0.31, 0.61, 5.0)])
        assert heights == pytest.approx(0.5 + rise * np.array([0, 1, 1, 2, 3, 3]))
        assert (steps.normal_at(places(0))[:, 2] == 1.0).all()


@given(seeds)
def test_bumps_stay_within_their_amplitude_and_repeat_by_seed(seed: int) -> None:
    xy = 50 * places(seed)
    heights = Bumps(0.3, 0.08, 1.2, seed).height_at(xy)
    assert (np.abs(heights - 0.3) <= 0.08).all()
    assert np.array_equal(heights, Bumps(0.3, 0.08, 1.2, seed).height_at(xy))
    assert not np.array_equal(heights, Bumps(0.3, 0.08, 1.2, seed + 1).height_at(xy))


def test_a_height_map_runs_through_its_heights_and_goes_on_as_at_its_edge() -> None:
    ground = GROUNDS["map"]
    rows, columns = np.indices(ground.heights.shape)
    points = np.stack([rows * 0.4 - 1.5, columns * 0.4 - 1.0], axis=-1)
    assert np.allclose(ground.height_at(points), 0.1 + ground.heights, atol=1e-12)
    assert ground.height_at([-9.0, -9.0]) == pytest.approx(0.1 + ground.heights[0, 0])


def test_the_highest_triangle_over_a_place_carries() -> None:
    floor, table = [[0, 0, 0], [4, 0, 0], [0, 4, 0.4]], [[1, 1, 0.7], [2, 1, 0.7], [1, 2, 0.7]]
    mesh = SurfaceMesh(0.1, [*table, *floor], [[0, 1, 2], [3, 4, 5]])
    assert mesh.height_at([[1.1, 1.1], [0.5, 1.0], [-1.0, 0.0]]) == pytest.approx([0.8, 0.2, 0.1])
    assert SurfaceMesh(0.3).height_at([1.0, 2.0]) == 0.3


@given(seeds)
def test_a_meshs_index_finds_what_a_search_of_all_triangles_finds(seed: int) -> None:
    random = np.random.default_rng(seed)
    mesh = SurfaceMesh(0.0, random.uniform(-1, 1, (30, 3)), random.integers(0, 30, (25, 3)))
    for xy in places(seed, 10):
        found = []
        for a, b, c in mesh.vertices[mesh.triangles]:
            plane = np.array([b - a, c - a])[:, :2].T
            if abs(np.linalg.det(plane)) > 1e-12:
                s, t = np.linalg.solve(plane, xy - a[:2])
                if min(s, t, 1 - s - t) >= 0:
                    found.append(a[2] + s * (b - a)[2] + t * (c - a)[2])
        assert mesh.height_at(xy) == pytest.approx(max(found, default=0.0), abs=1e-9)


@given(seeds, st.sampled_from([0.17, -0.17]))
def test_a_sole_is_nudged_on_to_one_tread_wherever_6_cm_suffice(seed: int, rise: float) -> None:
    steps, tries = Steps(0.0, rise, 0.3, 9), np.linspace(-0.06, 0.06, 121)
    heel = np.random.default_rng(seed).uniform([-0.5, -1.0], [3.0, 1.0], (30, 2))
    soles = heel[:, None] + np.array([[0.0, 0.0], [0.17, 0.0], [0.24, 0.0]])
    shifts = steps.foothold_offsets(soles)
    assert (np.abs(shifts[:, 0]) <= 0.06 + 1e-12).all()
    assert (shifts[:, 1] == 0.0).all()
    ends = np.array([-0.006, 0.246])  # with the room that a sole keeps from a riser
    for sole, shift in zip(soles, shifts, strict=True):
        along = (sole[0, 0] + ends + tries[:, None]).ravel()
        heights = steps.height_at(np.column_stack([along, np.zeros_like(along)])).reshape(-1, 2)
        if (np.ptp(heights, axis=1) == 0.0).any():
            assert np.ptp(steps.height_at(sole + shift)) == 0.0


def test_steps_without_rise_nudge_nobody() -> None:
    assert not Steps(0.0, 0.0).foothold_offsets(np.random.default_rng(0).uniform(-1, 1, (9, 3, 2))).any()


def test_kinds_are_named_apart_and_differ_by_value() -> None:
    assert list(GROUND_KINDS) == ["flat", "slope", "steps", "bumps", "height_map", "mesh"]
    grounds = [*GROUNDS.values(), HeightMap(), SurfaceMesh()]
    for i, one in enumerate(grounds):
        for j, other in enumerate(grounds):
            assert (one == other) is (i == j)
    assert HeightMap() == HeightMap()
    assert hash(HeightMap()) == hash(HeightMap())
    assert SurfaceMesh(0.0, CORNERS, TRIANGLES) == SurfaceMesh(0.0, CORNERS, TRIANGLES)
