"""Limbs: analytic placement, closed forms of reaching, stiff segments."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from studio.core.body.canonical import BodyPart
from studio.core.body.morphology import Morphology
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.constraints.distance import DistanceConstraint
from studio.core.constraints.follow import FollowTracked
from studio.core.constraints.objections import objection
from studio.core.constraints.position import PositionConstraint
from studio.core.grounds.ground import Ground
from studio.core.kernels.algebra.rotation_tuples import write_rotation
from studio.core.kernels.body.parts import limb_parts, rotate_part
from studio.core.kernels.limbs import limb as kernel
from studio.core.kernels.limbs import limb_reach as reach_kernel
from studio.core.kernels.records import LimbShape, Pose
from studio.core.normalized.realize import realize_motion
from studio.core.quality.metrics import angular_acceleration
from studio.core.solver.adapt import solve_constraints
from studio.core.solver.grounding.grounded_motion import ground_motion
from studio.core.solver.request import AdaptedMotion
from studio.core.solver.task_assembly.tracks import Track
from studio.io.project.character_file import bundled_characters
from tests.builders import make_morphology
from tests.core.motions import ALWAYS, RATE, local_rotations, random_rotations, target, walk
from tests.core.twins import body as body_twin
from tests.core.twins import limb as twin
from tests.core.twins import reach as reach_twin

# Limbs as links of variable length: laws of the analytic placement, and its twin.


seeds = st.integers(0, 2**32 - 1)


class _Limb:
    """Two bones in a random frame, stretched to a random distance that they can span."""

    def __init__(self, seed: int, distance: float | None = None, off_plane: float | None = None) -> None:
        random = np.random.default_rng(seed)
        self.root, self.frame = random.normal(size=3), random_rotations(random)
        self.bones = tuple(random.uniform(0.2, 0.5, size=2))
        near, far = abs(self.bones[0] - self.bones[1]), sum(self.bones)
        self.distance = random.uniform(near + 0.01 * far, 0.999 * far) if distance is None else distance
        self.off_plane = random.uniform(-0.2, 0.2) if off_plane is None else off_plane
        self.bend, self.twist = random.choice([-1.0, 1.0]), random.uniform(-3, 3, size=2)
        limb = LimbShape(self.bones, self.distance, self.off_plane, self.bend, tuple(self.twist))
        pose = Pose(np.stack([self.root] * 3), np.empty((2, 3, 3)))
        kernel.place_limb(0, 0, tuple(self.frame.ravel()), limb, pose)
        self.points, (self.upper, self.lower) = pose.positions[1:], pose.rotations


@given(seeds)
def test_the_kernel_agrees_with_its_twin(seed: int) -> None:
    limb = _Limb(seed)
    expected = twin.place_limb(limb.root, limb.frame, limb.distance, limb.bones, limb.off_plane, limb.bend, limb.twist)
    for result, wanted in zip((*limb.points, limb.upper, limb.lower), expected, strict=True):
        assert np.allclose(result, wanted, atol=1e-9)


@given(seeds)
def test_bones_keep_their_lengths_and_lie_along_the_z_axes_of_their_segments(seed: int) -> None:
    limb = _Limb(seed)
    middle, end = limb.points
    assert np.allclose(middle - limb.root, limb.bones[0] * limb.upper[:, 2], atol=1e-9)
    assert np.allclose(end - middle, limb.bones[1] * limb.lower[:, 2], atol=1e-9)


@given(seeds)
def test_the_extremity_lies_at_the_distance_along_z(seed: int) -> None:
    limb = _Limb(seed)
    assert np.allclose(limb.points[1], limb.root + limb.distance * limb.frame[:, 2], atol=1e-12)


@given(seeds)
def test_the_middle_joint_stands_on_the_side_of_the_bend(seed: int) -> None:
    limb = _Limb(seed, off_plane=0.0)
    x, y, _ = limb.frame.T @ (limb.points[0] - limb.root)
    assert limb.bend * y > 0.0
    assert x == pytest.approx(0.0, abs=1e-12)


@given(seeds)
def test_rotations_stay_rotations(seed: int) -> None:
    limb = _Limb(seed)
    for rotation in (limb.upper, limb.lower):
        assert np.allclose(rotation.T @ rotation, np.eye(3), atol=1e-12)
        assert np.linalg.det(rotation) == pytest.approx(1.0)


@pytest.mark.parametrize("distance", [0.0, 1e-9, 1e-3])
def test_a_folded_limb_has_no_nan(distance: float) -> None:
    limb = _Limb(0, distance)
    assert np.isfinite([*limb.points, *limb.upper, *limb.lower]).all()


def test_a_straight_limb_lies_on_the_line() -> None:
    limb = _Limb(3, distance=sum(_Limb(3).bones))
    assert np.allclose(limb.points[0], limb.root + limb.bones[0] * limb.frame[:, 2], atol=1e-7)


@given(st.floats(0, 10), st.floats(0.5, 0.999))
def test_soft_reach_is_exact_up_to_comfort_and_never_beyond_one(needed: float, comfort: float) -> None:
    reached = kernel.soft_extension(needed, comfort)
    assert reached == pytest.approx(twin.soft_reach(needed, comfort), abs=1e-12)
    assert reached <= min(needed, 1.0)
    if needed <= comfort:
        assert reached == needed


@given(st.floats(0.5, 0.999))
def test_soft_reach_rises_smoothly_at_the_comfort(comfort: float) -> None:
    step = 1e-6 * (1.0 - comfort)
    slope = (kernel.soft_extension(comfort + step, comfort) - comfort) / step
    assert slope == pytest.approx(1.0, abs=1e-5)
    samples = [kernel.soft_extension(needed, comfort) for needed in np.linspace(0.0, 1.5, 60)]
    assert (np.diff(samples) >= 0.0).all()


@given(seeds, st.floats(-12, 0))
def test_a_bone_that_nearly_points_back_is_still_a_rotation(seed: int, nearness: float) -> None:
    random = np.random.default_rng(seed)
    frame, bone, turn = random_rotations(random), 0.3 * np.array([0.0, 0.0, -1.0]), np.empty((3, 3))
    bone[:2] = 10.0**nearness * random.normal(size=2)
    write_rotation(kernel.bone_rotation(tuple(frame.ravel()), *bone, random.uniform(-3, 3)), turn)
    assert np.allclose(turn.T @ turn, np.eye(3), atol=1e-12)
    assert np.allclose(turn[:, 2] * np.linalg.norm(bone), frame @ bone, atol=1e-12)


@given(st.floats(0.0, 1.0), st.floats(0.01, 0.45))
def test_bones_of_other_lengths_fold_no_nearer_than_they_can_and_never_snap_shut(share: float, apart: float) -> None:
    bones = 0.5 + 0.5 * apart, 0.5 - 0.5 * apart
    reach, step = kernel.soft_flexion(share, bones), 1e-6
    assert reach > apart
    assert reach >= share
    assert -1e-9 <= kernel.soft_flexion(share + step, bones) - reach <= step * (1.0 + 1e-6)
    assert kernel.soft_flexion(share, (0.5, 0.5)) == share
    assert kernel.soft_flexion(-share, (0.5, 0.5)) == -share  # a channel that a spline has overshot


@given(st.floats(0.0, 1.0), st.floats(0.01, 0.45))
def test_an_ankle_that_is_brought_too_near_stops_softly_and_stays_where_a_fold_has_it(share: float, apart: float):
    bones, step = (0.5 + 0.5 * apart, 0.5 - 0.5 * apart), 1e-6
    reach = kernel.soft_minimum_reach(share, bones)
    assert reach > apart
    assert reach >= share - 1e-12
    assert -1e-9 <= kernel.soft_minimum_reach(share + step, bones) - reach <= step * (1.0 + 1e-6)
    folded = kernel.soft_flexion(share, bones)
    assert kernel.soft_minimum_reach(folded, bones) == pytest.approx(folded, abs=1e-12)


# Reaching with one limb: every closed form is the best that a fine search finds.


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
        turn = reach_kernel.bend_to_distance(
            distance, self.rotations[self.upper], self.shoulder, self.elbow, self.point
        )
        rotate_part(turn, self.upper + 1, K, self.elbow, self.positions, self.rotations)

    def assert_whole(self) -> None:
        assert np.allclose(body_twin.bone_lengths(LAYOUT, self.positions), self.lengths, atol=1e-9)


@given(seeds, limbs)
def test_bending_brings_the_point_to_the_distance_or_as_near_as_can_be(seed: int, limb: int) -> None:
    reach = _Reach(seed, limb)
    wanted = np.random.default_rng(seed + 1).uniform(0.0, 1.0)

    def miss(angles: np.ndarray) -> np.ndarray:
        there = reach_twin.turned(reach.point, reach.elbow, reach.hinge, angles)
        return np.abs(np.linalg.norm(there - reach.shoulder, axis=1) - wanted)

    [best] = miss(np.array([reach_twin.best_angle(miss)]))
    reach.bend(wanted)
    found = abs(np.linalg.norm(reach.moved - reach.shoulder) - wanted)
    assert found == pytest.approx(best, abs=1e-7)
    assert np.allclose(reach.positions[reach.root + 1], reach.elbow)
    reach.assert_whole()


@given(seeds, limbs)
def test_the_longest_reach_is_the_longest_of_all_bends(seed: int, limb: int) -> None:
    reach = _Reach(seed, limb)
    found = reach_kernel.distance_range(reach.shoulder, reach.elbow, reach.hinge, reach.point)[1]
    expected = reach_twin.greatest_distance(reach.shoulder, reach.elbow, reach.hinge, reach.point)
    assert found == pytest.approx(expected, abs=1e-9)


@given(seeds, limbs)
def test_a_bend_that_is_right_stays(seed: int, limb: int) -> None:
    reach = _Reach(seed, limb)
    _, cosine, sine = reach_kernel.distance_coefficients(reach.shoulder, reach.elbow, reach.hinge, reach.point)
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
def test_aiming_points_at_the_target_by_the_least_turn(seed: int, limb: int) -> None:
    reach = _Reach(seed, limb)
    before = reach.point - reach.shoulder
    reach_kernel.aim_at(reach.target, reach.point, reach.upper, K, reach.shoulder, reach.positions, reach.rotations)
    after, wanted = reach.moved - reach.shoulder, reach.target - reach.shoulder
    assert np.linalg.norm(after) == pytest.approx(np.linalg.norm(before))
    assert np.allclose(np.cross(after, wanted), 0.0, atol=1e-9)
    assert after @ wanted > 0.0
    cosine = before @ wanted / np.linalg.norm(before) / np.linalg.norm(wanted)
    assert reach.turned == pytest.approx(cosine, abs=1e-9)
    reach.assert_whole()


@given(seeds, limbs)
def test_reaching_is_to_bend_and_then_to_aim(seed: int, limb: int) -> None:
    both, one = _Reach(seed, limb), _Reach(seed, limb)
    distance = np.random.default_rng(seed + 1).uniform(0.0, 1.0)
    both.bend(distance)
    reach_kernel.aim_at(both.target, both.moved, both.upper, K, both.shoulder, both.positions, both.rotations)
    reach_kernel.bend_and_aim(one.target, distance, one.upper, one.root, one.point, one.positions, one.rotations)
    assert np.allclose(one.positions, both.positions, atol=1e-12)
    assert np.allclose(one.rotations, both.rotations, atol=1e-12)


@given(seeds, st.integers(0, 1))
def test_a_swivel_is_the_best_turn_that_leaves_the_held_point_alone(seed: int, limb: int) -> None:
    reach = _Reach(seed, limb)
    held = reach.positions[reach.root + 2].copy()
    axis = (held - reach.shoulder) / np.linalg.norm(held - reach.shoulder)
    reach.offset, reach.point = np.zeros(3), reach.elbow

    def miss(angles: np.ndarray) -> np.ndarray:
        return np.linalg.norm(reach_twin.turned(reach.elbow, reach.shoulder, axis, angles) - reach.target, axis=1)

    def off_axis(point: np.ndarray) -> float:
        return float(np.linalg.norm(np.cross(point - reach.shoulder, axis)))

    angle = reach_twin.best_angle(miss)
    lever, (best, start) = off_axis(reach.elbow) * off_axis(reach.target), miss(np.array([angle, 0.0]))
    reach_kernel.swivel_to(
        reach.target, reach.point, held, reach.upper, K, reach.shoulder, reach.positions, reach.rotations
    )
    found = float(np.linalg.norm(reach.moved - reach.target))
    assert np.allclose(reach.positions[reach.root + 2], held, atol=1e-9)
    assert best - 1e-9 <= found <= start + 1e-9
    if lever >= reach_kernel.SWIVEL_FADE_LEVER and np.cos(angle) >= np.cos(reach_kernel.SWIVEL_FADE_ANGLE):
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
        reach_kernel.swivel_to(
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
                reach_kernel.swivel_to(
                    target, arm.elbow.copy(), tip, arm.upper, K, arm.shoulder, arm.positions, arm.rotations
                )
                elbow = arm.positions[arm.root + 1] - arm.shoulder
                angles.append(np.arctan2(elbow @ side, elbow @ out))
            assert np.abs(np.diff(angles, 2)).max() * rate**2 < 400.0


def test_a_point_on_its_pivot_cannot_be_aimed_and_nothing_breaks() -> None:
    reach = _Reach(1, 0)
    before = reach.positions.copy()
    for aim, point in ((reach.shoulder, reach.point), (reach.target, reach.shoulder)):
        reach_kernel.aim_at(aim, point, reach.upper, K, reach.shoulder, reach.positions, reach.rotations)
    assert np.array_equal(reach.positions, before)


# Stiff segments of limbs: each takes its part of what it would do, the rest of the chain what is left.


BODIES = {name: character.morphology for name, character in bundled_characters().items()}
WALK, CONTACTS = walk(90)
STANDING = {name: ground_motion(WALK, body, CONTACTS, Ground()) for name, body in BODIES.items()}
IN_AIR = {name: ground_motion(WALK, body, (), Ground()) for name, body in BODIES.items()}
FRAME = 30
ALONE, TRUNK, ALL = Chain(clavicle=0.0), Chain(trunk=1.0), Chain(trunk=1.0, root=1.0)
ARM, LEG = ("upper_arm", "forearm"), ("thigh", "shank")
MET, LOCKED = 2e-4, 1e-9
WEIGHTS = np.linspace(0.0, 1.0, 9)
OFFSETS = ([0.1, 0.05, 0.1], [0.12, -0.04, 0.1], [0.05, 0.1, 0.15])


def _chain(chain: Chain, upper: float, lower: float, limb: str = "left_arm") -> Chain:
    bones = ("left_upper_arm", "left_forearm") if limb == "left_arm" else ("left_thigh", "left_shank")
    return replace(chain, segments=((BodyPart(bones[0]), upper), (BodyPart(bones[1]), lower)))


def _reach(name: str, chain: Chain, offset: Any = OFFSETS[0], **changes: Any) -> PositionConstraint:
    """The left wrist somewhat aside."""
    body = BODIES[name]
    wrist = STANDING[name].positions[FRAME, body.layout.wrist_point(0)]
    return target("left_forearm", wrist + np.array(offset) * body.stature / 1.7, chain, **changes)


def _step(name: str, chain: Chain) -> PositionConstraint:
    """The left ankle somewhat aside, in a walk over nothing."""
    body = BODIES[name]
    ankle = IN_AIR[name].positions[FRAME, body.layout.ankle_point(0)]
    return target("left_shank", ankle + np.array([0.03, 0.03, 0.04]) * body.stature / 1.7, chain)


def _at(standing: Any, *constraints: Any) -> AdaptedMotion:
    return solve_constraints(standing, constraints, FRAME, FRAME)


def _turns(body: Morphology, solved: AdaptedMotion, before: AdaptedMotion, first: BodyPart) -> tuple[float, float]:
    """Radians by which a limb's upper and lower segment have turned, each in what carries it."""
    segment = body.layout.segment_of_part(first)
    traces = [
        np.trace(local_rotations(before)[0, each].T @ local_rotations(solved)[0, each])
        for each in (segment, segment + 1)
    ]
    upper, lower = np.arccos(np.clip((np.array(traces) - 1.0) / 2.0, -1.0, 1.0))
    return float(upper), float(lower)


@pytest.mark.parametrize("chain", [ALONE, TRUNK, ALL], ids=["alone", "trunk", "all"])
@pytest.mark.parametrize("name", BODIES)
def test_a_locked_segment_of_an_arm_keeps_its_rotation_in_what_carries_it(name: str, chain: Chain) -> None:
    layout = BODIES[name].layout
    before = local_rotations(_at(STANDING[name]))[0]
    for offset in OFFSETS:
        for upper, lower in ((0.0, 1.0), (1.0, 0.0), (0.0, 0.4)):
            after = local_rotations(_at(STANDING[name], _reach(name, _chain(chain, upper, lower), offset)))[0]
            moved = [np.abs(after - before)[layout.segment_of_part(BodyPart(f"left_{bone}"))].max() for bone in ARM]
            assert (moved[0] < LOCKED) == (upper == 0.0)
            assert (moved[1] < LOCKED) == (lower == 0.0)


@pytest.mark.parametrize("name", BODIES)
def test_a_locked_segment_of_a_leg_keeps_its_rotation_and_the_root_brings_the_foot(name: str) -> None:
    layout, standing = BODIES[name].layout, IN_AIR[name]
    before = local_rotations(_at(standing))[0]
    for weights in ((0.0, 1.0), (1.0, 0.0), (0.5, 0.0)):
        solved = _at(standing, _step(name, _chain(Chain(clavicle=0.0, root=1.0), *weights, "left_leg")))
        after = local_rotations(solved)[0]
        for weight, bone in zip(weights, LEG, strict=True):
            moved = np.abs(after - before)[layout.segment_of_part(BodyPart(f"left_{bone}"))].max()
            assert (moved < LOCKED) == (weight == 0.0)
        assert solved.residuals[0, 0] < MET


@pytest.mark.parametrize("offset", OFFSETS, ids=str)
@pytest.mark.parametrize("name", BODIES)
def test_stiffer_turns_less_and_alone_takes_just_its_part(name: str, offset: list[float]) -> None:
    body, before = BODIES[name], _at(STANDING[name])
    arm = BodyPart.LEFT_UPPER_ARM
    full = _turns(body, _at(STANDING[name], _reach(name, ALONE, offset)), before, arm)
    for chain in (ALONE, ALL):
        upper, lower = [], []
        for weight in WEIGHTS:
            stiff = _at(STANDING[name], _reach(name, _chain(chain, weight, 1.0), offset))
            upper.append(_turns(body, stiff, before, arm)[0])
            stiff = _at(STANDING[name], _reach(name, _chain(chain, 1.0, weight), offset))
            lower.append(_turns(body, stiff, before, arm)[1])
        assert (np.diff(upper) > -1e-6).all()
        assert (np.diff(lower) > -1e-6).all()
        assert upper[4] == pytest.approx(0.5 * full[0], abs=1e-3)


@given(
    st.sampled_from(sorted(BODIES)), st.sampled_from(OFFSETS), st.floats(0.0, 1.0), st.floats(0.0, 1.0)
)  # fmt: skip
def test_what_a_stiff_arm_leaves_the_rest_of_the_chain_does(
    name: str, offset: list[float], upper: float, lower: float
) -> None:
    if upper == lower == 0.0:
        upper = 0.1
    assert _at(STANDING[name], _reach(name, _chain(ALL, upper, lower), offset)).residuals[0, 0] < MET


@pytest.mark.parametrize("name", BODIES)
def test_alone_what_is_left_is_a_miss_and_told(name: str) -> None:
    body, asked = BODIES[name], _reach(name, _chain(ALONE, 0.5, 1.0))
    solved = _at(STANDING[name], asked)
    apart = np.linalg.norm(solved.positions[0, body.layout.wrist_point(0)] - asked.target)
    assert solved.residuals[0, 0] == pytest.approx(apart)
    assert apart > 0.01


@pytest.mark.parametrize("chain", [ALONE, ALL], ids=["alone", "all"])
@pytest.mark.parametrize("name", BODIES)
def test_a_little_more_weight_is_a_little_more_movement(name: str, chain: Chain) -> None:
    for place in (0, 1):
        poses = []
        for weight in (0.0, 1e-4, 0.5, 0.5001, 0.9999, 1.0):
            weights = (weight, 1.0) if place == 0 else (1.0, weight)
            poses.append(_at(STANDING[name], _reach(name, _chain(chain, *weights))).positions)
        for first in (0, 2, 4):
            assert np.abs(poses[first] - poses[first + 1]).max() < 1e-3


@pytest.mark.parametrize("weights", [(0.5, 1.0), (1.0, 0.3), (0.4, 0.4), (0.0, 1.0)], ids=str)
@pytest.mark.parametrize("name", BODIES)
def test_stiff_arms_follow_what_moves_smoothly_without_pops(name: str, weights: tuple[float, float]) -> None:
    standing, layout = STANDING[name], BODIES[name].layout
    times = np.linspace(0.0, 1.0, 90)[:, None]
    aside = np.hstack([0.08 + 0.05 * np.sin(4 * times), 0.04 * np.cos(5 * times), 0.1 + 0.05 * np.sin(3 * times)])
    track = Track(standing.positions[:, layout.wrist_point(0)] + aside, np.eye(3)[None])
    wrist, follow = BodyPoint(BodyPart.LEFT_FOREARM, at_end=True), FollowTracked("hand")
    for chain in (ALONE, ALL):
        asked = PositionConstraint("motion", "Wrist", wrist, _chain(chain, *weights), 0, ALWAYS, target=follow)
        solved = solve_constraints(standing, (asked,), tracks={follow: track})
        assert chain is ALONE or np.nanmax(solved.residuals) < MET
        arms_and_trunk = local_rotations(solved)[:, : layout.spine_count + 10]
        assert angular_acceleration(arms_and_trunk, RATE).max() < 300.0  # half of what a walking leg has


@pytest.mark.parametrize("name", BODIES)
def test_a_lower_wish_does_not_take_from_a_stiff_higher_one(name: str) -> None:
    higher = _reach(name, _chain(ALL, 0.4, 0.6))
    right = STANDING[name].positions[FRAME, BODIES[name].layout.wrist_point(1)] + np.array([0.5, -0.3, 0.2])
    lower = target("right_forearm", right, ALL, 1)
    alone, both = _at(STANDING[name], higher), _at(STANDING[name], higher, lower)
    assert both.residuals[0, 0] <= alone.residuals[0, 0] + MET


@pytest.mark.parametrize("name", BODIES)
def test_the_swivel_for_a_second_wish_is_as_stiff_as_its_chain(name: str) -> None:
    body = BODIES[name]
    wrist = _reach(name, ALONE)
    before = _at(STANDING[name], wrist)
    elbow = before.positions[0, body.layout.wrist_point(0) - 1] + np.array([0.0, 0.1, 0.05])
    turned = []
    for weight in (0.0, 0.5, 1.0):
        second = target("left_upper_arm", elbow, _chain(ALONE, max(weight, 0.0), 1.0), 1)
        turned.append(_turns(body, _at(STANDING[name], wrist, second), before, BodyPart.LEFT_UPPER_ARM)[0])
    assert turned[0] < 1e-6
    assert turned[1] == pytest.approx(0.5 * turned[2], rel=0.05)


def test_hands_apart_are_brought_together_by_the_arm_that_is_not_stiff() -> None:
    standing, body = STANDING["adult_woman"], BODIES["adult_woman"]
    hands = BodyPoint(BodyPart.LEFT_HAND), BodyPoint(BodyPart.RIGHT_HAND)
    apart = float(
        np.linalg.norm(
            np.diff(standing.positions[FRAME, [body.layout.wrist_point(0), body.layout.wrist_point(1)]], axis=0)
        )
    )
    chain = _chain(ALONE, 0.0, 0.0)
    asked = DistanceConstraint("motion", "Hands", hands[0], chain, 0, ALWAYS, other=hands[1], distance=0.9 * apart)
    solved = _at(standing, asked)
    assert solved.residuals[0, 0] < MET
    assert solved.positions[0, body.layout.wrist_point(0)] == pytest.approx(
        standing.positions[FRAME, body.layout.wrist_point(0)], abs=1e-9
    )


def test_what_its_own_weights_free_can_move_a_point_and_nothing_else() -> None:
    bend = Chain(0.0, 0.0, 0.0, 0.0, 0.0, ((BodyPart.LEFT_FOREARM, 1.0),))
    assert objection(target("left_forearm", (1, 0, 1), bend), ()) is None
    for part in ("left_upper_arm", "right_forearm"):
        assert "no free segment of the IK chain" in str(objection(target(part, (1, 0, 1), bend), ()))
