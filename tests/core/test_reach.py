"""Reaching with one limb: every closed form is the best that a fine search finds."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from studio.core.kernels.body.parts import limb_parts, rotate_part
from studio.core.kernels.limbs import reach as kernel
from studio.core.normalized.realize import realize_motion
from tests.builders import make_morphology
from tests.core.motions import walk
from tests.core.twins import body as body_twin
from tests.core.twins import reach as twin

seeds = st.integers(0, 2**32 - 1)
limbs = st.integers(0, 3)
BODY = make_morphology()
LAYOUT, K = BODY.layout, BODY.layout.spine_count
POSES = realize_motion(walk(60)[0], BODY)


class _Reach:
    """A limb of some pose of the walk, a point fixed to its lower segment and a target somewhere near."""

    def __init__(self, seed: int, limb: int) -> None:
        random = np.random.default_rng(seed)
        frame = random.integers(60)
        self.positions, self.rotations = POSES[0][frame].copy(), POSES[1][frame].copy()
        _, self.upper, self.root = limb_parts(limb, K)
        self.shoulder, self.elbow = self.positions[self.root].copy(), self.positions[self.root + 1].copy()
        self.hinge = self.rotations[self.upper, :, 0].copy()
        self.offset = random.uniform(-0.1, 0.3, 3)
        self.point = self.elbow + self.rotations[self.upper + 1] @ self.offset
        self.target = self.shoulder + random.normal(size=3) * 0.3
        self.before = self.rotations[self.upper].copy()
        self.lengths = body_twin.bone_lengths(LAYOUT, self.positions)

    @property
    def turned(self) -> float:
        """Cosine of the angle by which the limb has turned."""
        return float((np.trace(self.rotations[self.upper] @ self.before.T) - 1.0) / 2.0)

    @property
    def moved(self) -> np.ndarray:
        """Present place of the point."""
        return self.positions[self.root + 1] + self.rotations[self.upper + 1] @ self.offset

    def bend(self, distance: float) -> None:
        turn = kernel.bend_to_distance(distance, self.rotations[self.upper], self.shoulder, self.elbow, self.point)
        rotate_part(turn, self.upper + 1, K, self.elbow, self.positions, self.rotations)

    def assert_whole(self) -> None:
        assert np.allclose(body_twin.bone_lengths(LAYOUT, self.positions), self.lengths, atol=1e-9)


@given(seeds, limbs)
@settings(max_examples=40)
def test_bending_brings_the_point_to_the_distance_or_as_near_as_can_be(seed: int, limb: int) -> None:
    reach = _Reach(seed, limb)
    wanted = np.random.default_rng(seed + 1).uniform(0.0, 1.0)

    def miss(angles: np.ndarray) -> np.ndarray:
        there = twin.turned(reach.point, reach.elbow, reach.hinge, angles)
        return np.abs(np.linalg.norm(there - reach.shoulder, axis=1) - wanted)

    [best] = miss(np.array([twin.best_angle(miss)]))
    reach.bend(wanted)
    found = abs(np.linalg.norm(reach.moved - reach.shoulder) - wanted)
    assert found == pytest.approx(best, abs=1e-7)
    assert np.allclose(reach.positions[reach.root + 1], reach.elbow)
    reach.assert_whole()


@given(seeds, limbs)
@settings(max_examples=40)
def test_the_longest_reach_is_the_longest_of_all_bends(seed: int, limb: int) -> None:
    reach = _Reach(seed, limb)
    found = kernel.distance_range(reach.shoulder, reach.elbow, reach.hinge, reach.point)[1]
    expected = twin.greatest_distance(reach.shoulder, reach.elbow, reach.hinge, reach.point)
    assert found == pytest.approx(expected, abs=1e-9)


@given(seeds, limbs)
def test_a_bend_that_is_right_stays(seed: int, limb: int) -> None:
    reach = _Reach(seed, limb)
    _, cosine, sine = kernel.distance_coefficients(reach.shoulder, reach.elbow, reach.hinge, reach.point)
    # Beyond it a limb counts as stretched too far, and is bent the right way.
    assume(np.arctan2(sine, cosine) > -0.85 * np.pi)
    reach.bend(float(np.linalg.norm(reach.point - reach.shoulder)))
    assert np.allclose(reach.moved, reach.point, atol=1e-6)


@given(seeds, limbs)
def test_elbows_and_knees_do_not_bend_backwards(seed: int, limb: int) -> None:
    """The extremity stays on its side of the hinge whatever the distance."""
    reach = _Reach(seed, limb)
    end = reach.positions[reach.root + 2].copy()
    reach.offset = reach.rotations[reach.upper + 1].T @ (end - reach.elbow)
    reach.point = end
    reach.bend(np.random.default_rng(seed).uniform(0.1, 0.9) * BODY.leg_length)
    upper, lower = reach.elbow - reach.shoulder, reach.positions[reach.root + 2] - reach.elbow
    assert np.cross(upper, lower) @ reach.hinge >= -1e-9


@given(seeds, limbs)
@settings(max_examples=40)
def test_aiming_points_at_the_target_by_the_least_turn(seed: int, limb: int) -> None:
    reach = _Reach(seed, limb)
    before = reach.point - reach.shoulder
    kernel.aim_at(reach.target, reach.point, reach.upper, K, reach.shoulder, reach.positions, reach.rotations)
    after, wanted = reach.moved - reach.shoulder, reach.target - reach.shoulder
    assert np.linalg.norm(after) == pytest.approx(np.linalg.norm(before))
    assert np.allclose(np.cross(after, wanted), 0.0, atol=1e-9)
    assert after @ wanted > 0.0
    cosine = before @ wanted / np.linalg.norm(before) / np.linalg.norm(wanted)
    assert reach.turned == pytest.approx(cosine, abs=1e-9)
    reach.assert_whole()


@given(seeds, limbs)
@settings(max_examples=40)
def test_reaching_is_to_bend_and_then_to_aim(seed: int, limb: int) -> None:
    both, one = _Reach(seed, limb), _Reach(seed, limb)
    distance = np.random.default_rng(seed + 1).uniform(0.0, 1.0)
    both.bend(distance)
    kernel.aim_at(both.target, both.moved, both.upper, K, both.shoulder, both.positions, both.rotations)
    kernel.bend_and_aim(one.target, distance, one.upper, one.root, one.point, one.positions, one.rotations)
    assert np.allclose(one.positions, both.positions, atol=1e-12)
    assert np.allclose(one.rotations, both.rotations, atol=1e-12)


@given(seeds, st.integers(0, 1))
@settings(max_examples=40)
def test_a_swivel_is_the_best_turn_that_leaves_the_held_point_alone(seed: int, limb: int) -> None:
    reach = _Reach(seed, limb)
    held = reach.positions[reach.root + 2].copy()
    axis = (held - reach.shoulder) / np.linalg.norm(held - reach.shoulder)
    reach.offset, reach.point = np.zeros(3), reach.elbow

    def miss(angles: np.ndarray) -> np.ndarray:
        return np.linalg.norm(twin.turned(reach.elbow, reach.shoulder, axis, angles) - reach.target, axis=1)

    def off_axis(point: np.ndarray) -> float:
        return float(np.linalg.norm(np.cross(point - reach.shoulder, axis)))

    angle = twin.best_angle(miss)
    lever, (best, start) = off_axis(reach.elbow) * off_axis(reach.target), miss(np.array([angle, 0.0]))
    kernel.swivel_to(reach.target, reach.point, held, reach.upper, K, reach.shoulder, reach.positions, reach.rotations)
    found = float(np.linalg.norm(reach.moved - reach.target))
    assert np.allclose(reach.positions[reach.root + 2], held, atol=1e-9)
    assert best - 1e-9 <= found <= start + 1e-9
    if lever >= kernel.SWIVEL_LEVER and np.cos(angle) >= np.cos(kernel.SWIVEL_ANGLE):
        assert found == pytest.approx(best, abs=1e-7)
    reach.assert_whole()


def test_a_swivel_fades_where_the_target_nears_the_axis() -> None:
    """A quarter turn is asked; the nearer the axis, the less of it is done."""
    angles = []
    for apart in (0.2, 0.05, 0.01, 0.0):
        reach = _Reach(5, 0)
        held = reach.positions[reach.root + 2].copy()
        axis = (held - reach.shoulder) / np.linalg.norm(held - reach.shoulder)
        lever = reach.elbow - reach.shoulder
        away = np.cross(axis, lever)
        reach.target = reach.shoulder + apart * away / np.linalg.norm(away)
        kernel.swivel_to(
            reach.target, reach.elbow.copy(), held, reach.upper, K, reach.shoulder, reach.positions,
            reach.rotations,
        )  # fmt: skip
        angles.append(np.arccos(np.clip(reach.turned, -1, 1)))
    assert (np.diff(angles) < 0.0).all()
    assert angles[-1] < 0.05


def test_a_target_that_crosses_the_axis_whirls_no_limb() -> None:
    """At half a metre a second, on any line at most 12 cm from the axis; the plain angle reaches 90,000 rad/s^2."""
    reach = _Reach(5, 0)
    tip = reach.positions[reach.root + 2].copy()
    axis = (tip - reach.shoulder) / np.linalg.norm(tip - reach.shoulder)
    out = reach.elbow - reach.shoulder
    out = out - out @ axis * axis
    out /= np.linalg.norm(out)
    side, rate = np.cross(axis, out), 60.0
    for direction in np.linspace(0.0, np.pi, 7):
        way = np.cos(direction) * out + np.sin(direction) * side
        for off in np.linspace(-0.12, 0.12, 7):
            angles = []
            for along in np.arange(-0.4, 0.4, 0.5 / rate):
                arm = _Reach(5, 0)
                target = arm.shoulder + along * way + off * np.cross(axis, way)
                kernel.swivel_to(
                    target, arm.elbow.copy(), tip, arm.upper, K, arm.shoulder, arm.positions, arm.rotations
                )
                elbow = arm.positions[arm.root + 1] - arm.shoulder
                angles.append(np.arctan2(elbow @ side, elbow @ out))
            assert np.abs(np.diff(angles, 2)).max() * rate**2 < 400.0


def test_a_point_on_its_pivot_cannot_be_aimed_and_nothing_breaks() -> None:
    reach = _Reach(1, 0)
    before = reach.positions.copy()
    for target, point in ((reach.shoulder, reach.point), (reach.target, reach.shoulder)):
        kernel.aim_at(target, point, reach.upper, K, reach.shoulder, reach.positions, reach.rotations)
    assert np.array_equal(reach.positions, before)
