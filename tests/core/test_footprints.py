"""Walks on ground that is not level: the same laws as on the floor, and no ground at all changes nothing."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from studio.core.captures.contacts import ContactPoint
from studio.core.grounds import Bumps, HeightMap, Slope, Steps, SurfaceMesh
from studio.core.grounds.ground import Ground
from studio.core.quality.metrics import acceleration_ratio, contact_quality
from studio.core.solver.adapt import adapt
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.core.solver.standing.footprints import planes_under, tilts_of
from studio.core.solver.standing.stand import stand
from studio.io.project.character_file import bundled_characters
from tests.core.motions import walk

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
        standing = stand(WALK, BODIES["adult_woman"], (), ground)
        assert np.isfinite(standing.positions).all()
    apart = stand(WALK, BODIES["adult_woman"], (), Slope(0.0, TILT)).positions[:, 0, 2]
    assert apart[-1] - apart[0] > 0.3


soles = st.integers(0, 2**32 - 1)


@given(soles)
@settings(max_examples=40)
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
