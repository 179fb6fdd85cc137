"""A balance recruits free arms and the free leg: as far as they are free, and nothing else of them."""

import re
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from studio.core.body.canonical import BodyPart
from studio.core.body.joint_limits import limb_limit_records
from studio.core.body.morphology import Morphology
from studio.core.body.pose import PoseSequence
from studio.core.captures.contacts import ContactInterval, ContactPoint, contact_mask
from studio.core.constraints.balance import BalanceConstraint, Support
from studio.core.constraints.base import BodyPoint, Chain, Constraint
from studio.core.constraints.distance import DistanceConstraint
from studio.core.constraints.orientation import OrientationConstraint
from studio.core.constraints.position import PositionConstraint
from studio.core.curves.activation import ActivationCurve
from studio.core.grounds.ground import Ground
from studio.core.kernels.limbs.limb_reach import aim_at
from studio.core.kernels.records import HAND_CONTACT, FrameBody, FrameProblem, LegTargets, Pose
from studio.core.kernels.search.body_placement import pose_body
from studio.core.kernels.search.joints import ROOT_TRANSLATION
from studio.core.kernels.solve_clip import make_search
from studio.core.kernels.support.swing_foot_clearance import SWING_FADE_SECONDS
from studio.core.kernels.tasks.balance import (
    accumulate_masses,
    add_arm_jacobian,
    add_leg_jacobian,
    centre_of_mass,
    write_balance_jacobian,
)
from studio.core.kernels.tasks.task import TASK
from studio.core.normalized.motion import NormalizedMotion
from studio.core.normalized.normalize import normalize_capture
from studio.core.quality.metrics import acceleration_ratio, angular_acceleration, contact_quality
from studio.core.solver.adapt import solve_constraints
from studio.core.solver.grounding.grounded_motion import GroundedMotion, ground_motion
from studio.core.solver.grounding.support_polygon import mass_path
from studio.core.solver.request import AdaptedMotion
from studio.core.solver.solved_window import SolverLimits
from studio.core.solver.task_assembly.chains import joints_of_chains, point_masses, segment_masses
from studio.core.solver.task_assembly.limb_availability import (
    arm_limit_fractions,
    leg_limit_fractions,
    limb_availability,
)
from studio.io.project.character_file import bundled_characters
from tests.builders import make_capture, make_skeleton
from tests.core.motions import ALWAYS, HINGES, RATE, about, local_rotations, target, walk

BODIES = {name: character.morphology for name, character in bundled_characters().items()}
FRAMES, UP, DOWN = 90, 20, 70
"""The left foot leaves the ground and comes back."""


def _kick() -> tuple[NormalizedMotion, tuple[ContactInterval, ...]]:
    """One who stands on the right leg and raises the left one before."""
    skeleton, joint = make_skeleton(), make_skeleton().index
    raised = np.sin(np.pi * np.clip((np.arange(FRAMES) - UP) / (DOWN - UP), 0.0, 1.0)) ** 2
    rotations = np.zeros((FRAMES, skeleton.joint_count, 4))
    rotations[..., 3] = 1.0
    for side, name in enumerate(("Left", "Right")):
        lift = raised * (1 - side)
        rotations[:, joint(f"{name}UpLeg")] = about((0, 1, 0), -0.1 - 1.1 * lift)
        rotations[:, joint(f"{name}Leg")] = about((0, 1, 0), 0.2 + 0.4 * lift)
        rotations[:, joint(f"{name}Foot")] = about((0, 1, 0), -0.1 + 0.2 * lift)
        rotations[:, joint(f"{name}Arm")] = about((-1 if side == 0 else 1, 0, 0), 1.1 + 0.1 * raised)
        rotations[:, joint(f"{name}ForeArm")] = about(HINGES[f"{name}ForeArm"], 0.5 + 0.3 * raised)
    translations = np.tile(skeleton.offsets, (FRAMES, 1, 1))
    translations[:, 0, 2] -= 0.005
    capture = make_capture("kick", FRAMES, skeleton=skeleton, poses=PoseSequence(rotations, translations))
    spans = {0: [(0, UP), (DOWN, FRAMES - 1)], 1: [(0, FRAMES - 1)]}
    contacts = tuple(
        ContactInterval("kick", ContactPoint(f"{('left', 'right')[side]}_{part}"), *span)
        for side, many in spans.items()
        for span in many
        for part in ("heel", "toe")
    )
    return normalize_capture(capture)[0], contacts


KICK, CONTACTS = _kick()
STANDING = {name: ground_motion(KICK, body, CONTACTS, Ground()) for name, body in BODIES.items()}
WALK, STEPS = walk(FRAMES)
ARMS, LEGS = Chain(0.0, 0.0, 0.0, 0.0, 0.0, free_arms=1.0), Chain(0.0, 0.0, 0.0, 0.0, 0.0, free_legs=1.0)
TRUNK = Chain(limb=0.0, clavicle=0.0, trunk=1.0, root=1.0)
WHOLE = replace(TRUNK, free_arms=1.0, free_legs=1.0)
MET, KEPT = 1e-3, 2e-4
MIDDLE = 45


def _balance(
    standing: GroundedMotion, frame: int, chain: Chain, aside: np.ndarray, priority: int = 0
) -> BalanceConstraint:
    """The centre of mass ``aside`` (2,) of where the motion has it at a frame."""
    place = mass_path(standing.positions[frame : frame + 1], standing.morphology)[0, :2] + aside
    return BalanceConstraint(
        "motion", "Balance", BodyPoint(BodyPart.PELVIS), chain, priority, ALWAYS, place=tuple(place)
    )


def _support(chain: Chain) -> BalanceConstraint:
    return BalanceConstraint("motion", "Balance", BodyPoint(BodyPart.PELVIS), chain, 0, ALWAYS, place=Support())


def _ankles(body: Morphology) -> list[int]:
    return [body.layout.ankle_point(side) for side in range(2)]


def _legs(body: Morphology, side: int) -> slice:
    return slice(body.layout.hip_point(side), body.layout.hip_point(side) + 5)


def _turned(solved: AdaptedMotion, standing: GroundedMotion) -> np.ndarray:
    """(F, S) radians by which segments have turned from the motion, each in what carries it."""
    before = local_rotations(replace(solved, positions=standing.positions, rotations=standing.rotations))
    trace = np.einsum("fsij,fsij->fs", before[solved.first_frame :][: len(solved.rotations)], local_rotations(solved))
    return np.arccos(np.clip((trace - 1.0) / 2.0, -1.0, 1.0))


@given(st.sampled_from(sorted(BODIES)), st.integers(0, 89), st.floats(-np.pi, np.pi), st.floats(0.0, 0.003))
def test_free_arms_alone_meet_a_small_shift_and_nothing_else_moves(
    name: str, frame: int, heading: float, shift: float
) -> None:
    standing, layout = STANDING[name], BODIES[name].layout
    aside = shift * BODIES[name].stature * np.array([np.cos(heading), np.sin(heading)])
    solved = solve_constraints(standing, (_balance(standing, frame, ARMS, aside),), frame, frame)
    assert solved.residuals[0, 0] < MET
    arms = {
        *range(layout.collar_point(0) + 2, layout.collar_point(0) + 5),
        *range(layout.collar_point(1) + 2, layout.collar_point(1) + 5),
    }
    others = [point for point in range(layout.point_count) if point not in arms]
    assert np.allclose(solved.positions[0, others], standing.positions[frame, others], rtol=0.0, atol=1e-14)


@pytest.mark.parametrize("chain", [LEGS, WHOLE], ids=["legs", "whole"])
@pytest.mark.parametrize("name", BODIES)
def test_planted_feet_never_move_and_a_swinging_leg_does(name: str, chain: Chain) -> None:
    standing, body = STANDING[name], BODIES[name]
    solved = solve_constraints(standing, (_balance(standing, MIDDLE, chain, np.array([0.02, 0.01])),))
    assert contact_quality(solved, CONTACTS, Ground()).slide < 1e-9
    away = [
        np.linalg.norm(solved.positions[:, ankle] - standing.positions[:, ankle], axis=1) for ankle in _ankles(body)
    ]
    assert away[0][[*range(UP + 1), *range(DOWN, FRAMES)]].max() < 1e-9
    assert away[0][MIDDLE] > 0.005
    assert away[1].max() < 1e-9


@pytest.mark.parametrize("chain", [LEGS, WHOLE], ids=["legs", "whole"])
@pytest.mark.parametrize("name", BODIES)
def test_a_leg_that_fades_does_not_pop(name: str, chain: Chain) -> None:
    for standing in (STANDING[name], ground_motion(WALK, BODIES[name], STEPS, Ground())):
        solved = solve_constraints(standing, (_support(chain),), eased=True)
        assert acceleration_ratio(solved, solve_constraints(standing, ())) < 3.0


@pytest.mark.parametrize("name", BODIES)
def test_a_recruited_leg_does_not_enter_the_ground(name: str) -> None:
    standing, body = STANDING[name], BODIES[name]
    for aside in ([0.05, 0.0], [-0.05, 0.0], [0.0, 0.05], [0.0, -0.05]):
        solved = solve_constraints(standing, (_balance(standing, MIDDLE, LEGS, np.array(aside)),))
        for side in range(2):
            lowest = (each[:, _legs(body, side), 2].min() for each in (standing.positions, solved.positions))
            assert next(lowest) < next(lowest) + 2e-3


@pytest.mark.parametrize("name", BODIES)
def test_an_arm_with_a_wish_above_is_left_to_it_and_the_other_helps(name: str) -> None:
    standing, layout = STANDING[name], BODIES[name].layout
    for frame in (10, MIDDLE, 70):
        reach, balance = _reach(standing, frame, 0), _balance(standing, frame, ARMS, np.array([0.003, -0.002]), 1)
        both, alone = (solve_constraints(standing, wishes, frame, frame) for wishes in ((reach, balance), (reach,)))
        assert both.residuals[0, 0] < KEPT
        arm = slice(layout.collar_point(0), layout.collar_point(0) + 5)
        assert both.positions[0, arm] == pytest.approx(alone.positions[0, arm], abs=KEPT)
        assert _turned(both, standing)[0, layout.segment_of_part(BodyPart.RIGHT_UPPER_ARM)] > 0.05


@pytest.mark.parametrize("name", BODIES)
def test_an_arm_with_a_wish_below_costs_the_balance_nothing(name: str) -> None:
    standing = STANDING[name]
    for frame in (10, MIDDLE, 70):
        for shift in (0.003, 0.005, 0.02):  # the last is out of reach
            balance = _balance(standing, frame, ARMS, shift * np.array([1.0, -0.7]), 0)
            alone = solve_constraints(standing, (balance,), frame, frame)
            both = solve_constraints(standing, (_reach(standing, frame, 1), balance), frame, frame)
            assert both.residuals[1, 0] == pytest.approx(alone.residuals[0, 0], abs=KEPT)
            assert both.residuals[0, 0] < KEPT or shift > 0.005


def _reach(standing: GroundedMotion, frame: int, priority: int) -> PositionConstraint:
    """The left wrist a little forward and up."""
    wrist = standing.positions[frame, standing.morphology.layout.wrist_point(0)]
    return target("left_forearm", wrist + np.array([0.05, 0.0, 0.04]), Chain(clavicle=0.0), priority)


def test_an_arm_is_back_in_the_motion_before_a_wish_above_begins_and_helps_again_after() -> None:
    standing, body = STANDING["adult_woman"], BODIES["adult_woman"]
    balance = _balance(standing, MIDDLE, ARMS, np.array([0.004, 0.004]), 1)
    wrist = BodyPoint(BodyPart.LEFT_FOREARM, at_end=True)
    times = ActivationCurve(0.6, 0.8, 0.9, 1.1)
    asked = PositionConstraint("motion", "Wrist", wrist, Chain(clavicle=0.0), 0, times, target=(1.0, 0.4, 1.2))
    solved = solve_constraints(standing, (balance, asked))
    turned = _turned(solved, standing)[:, body.layout.segment_of_part(BodyPart.LEFT_UPPER_ARM)]
    begin, end = round(times.start * RATE), round(times.end * RATE)
    soon = round(SWING_FADE_SECONDS * RATE) + 2
    assert turned[[begin, end]].max() < 0.02
    assert turned[[begin - soon, end + soon]].min() > 0.1
    peak = angular_acceleration(local_rotations(solved), RATE).max(axis=-1)
    assert peak[np.r_[0 : begin - 2, end + 1 : len(peak)]].max() < 250.0  # half of what a walking leg has


@pytest.mark.parametrize("kind", ["position", "orientation", "distance"])
@pytest.mark.parametrize("name", BODIES)
def test_a_wish_below_takes_an_arm_from_a_balance_that_does_without_and_nothing_pops(name: str, kind: str) -> None:
    standing, layout = STANDING[name], BODIES[name].layout
    balance = _balance(standing, MIDDLE, WHOLE, np.array([0.01, 0.01]))
    common = "motion", kind, BodyPoint(BodyPart.LEFT_FOREARM, at_end=True), Chain(clavicle=0.0), 1
    times = ActivationCurve(0.4, 0.6, 0.9, 1.1)
    place = standing.positions[MIDDLE, layout.wrist_point(0)] + np.array([0.1, 0.05, 0.1])
    asked: Constraint = PositionConstraint(*common, times, target=tuple(place))
    if kind == "orientation":
        asked = OrientationConstraint(*common, times, target=(0.0, 0.6, 0.0, 0.8))
    elif kind == "distance":
        asked = DistanceConstraint(*common, times, other=BodyPoint(BodyPart.HEAD), distance=0.3 * BODIES[name].stature)
    alone, both = solve_constraints(standing, (balance,)), solve_constraints(standing, (balance, asked))
    assert both.residuals[0] == pytest.approx(alone.residuals[0], abs=KEPT)
    assert both.residuals[1, MIDDLE - 5 : MIDDLE + 5].max() < KEPT
    assert angular_acceleration(local_rotations(both), RATE).max() < 300.0  # 150 for a radian in 0.2 s by (6)


def test_freedom_is_nought_in_contact_and_while_asked_and_all_of_it_soon_after() -> None:
    limbs, activations = np.array([[0, -1], [-1, 3]]), np.zeros((2, 90))
    activations[0, 30:40], activations[1] = 1e-9, 0.0
    above, free = limb_availability(limbs, np.array([1, 1]), activations, CONTACTS, RATE)
    assert free.shape == (4, 90)
    assert (above[:2] == 1.0).all()  # what is asked with less priority takes no limb
    assert (free[0, 30:40] == 0.0).all()
    assert (free[0, [0, 20, 49, 89]] == 1.0).all()
    assert (np.diff(free[0, 20:31]) <= 0.0).all()
    assert (free[1] == 1.0).all()
    for side in range(2):
        planted = contact_mask([(c.first, c.last) for c in CONTACTS if c.point.side == side], FRAMES)
        assert (free[2 + side, planted] == 0.0).all()
    assert free[2, MIDDLE] == 1.0


def test_a_leg_may_turn_as_far_as_its_foot_is_high() -> None:
    body = BODIES["adult_woman"]
    positions = STANDING["adult_woman"].positions[:1].repeat(4, axis=0)
    for side in range(2):
        positions[:, _legs(body, side), 2] += np.array([0.0, 0.02, 0.2, 1.0])[:, None]
    room = leg_limit_fractions(body, Ground(), positions)
    assert (np.diff(room, axis=1) > 0.0).all()
    assert room[:, 0].min() < 0.3
    assert room[:, 3].max() > 0.9


def test_an_arm_that_lies_level_is_not_turned_and_one_that_hangs_is() -> None:
    body = BODIES["adult_woman"]
    positions = STANDING["adult_woman"].positions[:1].repeat(3, axis=0)
    for side in range(2):
        arm = slice(body.layout.collar_point(side) + 1, body.layout.collar_point(side) + 5)
        shoulder = positions[:, arm.start : arm.start + 1]
        lengths = np.arange(4)[None, :, None] * 0.25
        ways = np.array([[0.0, 0.0, -1.0], [np.sqrt(0.5), 0.0, np.sqrt(0.5)], [0.6, 0.8, 0.0]])
        positions[:, arm] = shoulder + lengths * ways[:, None]
    assert arm_limit_fractions(body, positions) == pytest.approx(np.array([[1.0, 0.5, 0.0]] * 2))


@pytest.mark.parametrize("name", BODIES)
def test_without_free_limbs_nothing_is_otherwise_to_the_bit(name: str) -> None:
    standing = STANDING[name]
    wish = _balance(standing, MIDDLE, TRUNK, np.array([0.02, 0.01]))
    none = replace(wish, chain=replace(TRUNK, segments=((BodyPart.THORAX, 1.0),)))
    assert np.array_equal(
        solve_constraints(standing, (wish,)).positions, solve_constraints(standing, (none,)).positions
    )
    assert len(joints_of_chains((TRUNK,), (0,), BODIES[name].layout).joints) + 4 == len(
        joints_of_chains((WHOLE,), (0,), BODIES[name].layout).joints
    )


@pytest.mark.parametrize("name", BODIES)
def test_the_whole_body_moves_its_root_less_when_limbs_help(name: str) -> None:
    standing = STANDING[name]
    for frame in (35, MIDDLE):
        moved = []
        for chain in (TRUNK, WHOLE):
            solved = solve_constraints(
                standing, (_balance(standing, frame, chain, np.array([0.03, 0.0])),), frame, frame
            )
            assert solved.residuals[0, 0] < MET
            moved.append(np.linalg.norm(solved.positions[0, 0] - standing.positions[frame, 0]))
        assert moved[1] < 0.97 * moved[0]


def test_any_window_of_frames_gives_the_poses_of_the_whole_clip_and_no_limits_give_a_body_too() -> None:
    standing = STANDING["child"]
    whole, part = (
        solve_constraints(standing, (_support(WHOLE),)),
        solve_constraints(standing, (_support(WHOLE),), 25, 50),
    )
    assert part.positions == pytest.approx(whole.positions[25:51], abs=1e-12)
    for chain in (WHOLE, ARMS):
        assert np.isfinite(
            solve_constraints(standing, (_support(chain),), bound=SolverLimits(uses_joint_limits=False)).positions
        ).all()


@pytest.mark.parametrize("link", ["free_arms", "free_legs"])
def test_free_limbs_are_for_a_balance_alone(link: str) -> None:
    sentence = (
        "'Left forearm': only a balance constraint can use the other arms and legs. Set free_arms and free_legs to 0."
    )
    with pytest.raises(ValueError, match=re.escape(sentence)):
        target("left_forearm", (0.4, 0.2, 1.0), Chain(**{link: 0.5}))


class _PosedBody:
    """One standing frame with every joint free, as the kernels have it."""

    def __init__(self, standing: GroundedMotion, frame: int) -> None:
        body, footing = standing.morphology, standing.footing
        chain = replace(WHOLE, segments=tuple((part, 1.0) for part in (BodyPart.PELVIS, BodyPart.NECK, BodyPart.HEAD)))
        chain = replace(chain, clavicle=1.0)
        self.chain = joints_of_chains((chain,), (0,), body.layout).kernel_weights
        self.start = Pose(standing.positions[frame], standing.rotations[frame])
        parts = footing.soft_thresholds, footing.ankles, footing.feet, footing.toes
        legs = LegTargets(KICK.channels[frame], *(np.ascontiguousarray(part[:, frame]) for part in parts))
        self.masses, self.shares = segment_masses(body.layout), point_masses(body.layout)
        free, none = np.full(2, np.inf), np.zeros(2, HAND_CONTACT)
        ground = np.zeros((4, 3))
        self.body = FrameBody(
            body.rows[0], self.masses, free, legs, limb_limit_records(body)[:0], self.shares, none, ground
        )
        self.search = make_search(1, len(self.chain.joints), len(self.start.positions))

    def pose(self, joint: int, turn: np.ndarray) -> Pose:
        """The pose with a joint turned by a rotation vector, or the root moved."""
        state = self.search.state
        state[:] = 0.0
        state[joint] = turn if self.chain.joints["segment"][joint] == ROOT_TRANSLATION else np.tan(0.5 * turn)
        pose = Pose(self.start.positions.copy(), self.start.rotations.copy())
        nothing = np.zeros(0, dtype=TASK), np.zeros((0, 10))
        pose_body(FrameProblem(*nothing, self.chain, self.body, self.search, self.start, pose))
        return pose

    def mass(self, joint: int, turn: np.ndarray) -> np.ndarray:
        """(3,) the centre of mass then."""
        sums = np.empty((len(self.masses) + 1, 4))
        accumulate_masses(self.masses, self.pose(joint, turn).positions, sums)
        return sums[-1, :3]

    def rows(self) -> np.ndarray:
        sums, rows = np.empty((len(self.masses) + 1, 4)), np.empty((3, len(self.chain.joints), 3))
        accumulate_masses(self.masses, self.start.positions, sums)
        write_balance_jacobian(3, self.masses, sums, self.chain.joints, self.start.positions, rows)
        return rows


@pytest.mark.parametrize("frame", [5, 30, MIDDLE], ids="frame {}".format)
@pytest.mark.parametrize("name", BODIES)
def test_balance_rows_are_the_derivatives_of_the_posed_body_with_legs_free_and_planted(name: str, frame: int) -> None:
    posed, step = _PosedBody(STANDING[name], frame), 1e-5
    rows = posed.rows()
    for joint, segment in enumerate(posed.chain.joints["segment"]):
        for axis in range(3):
            turn = step * np.eye(3)[axis]
            slope = (posed.mass(joint, turn) - posed.mass(joint, -turn)) / (2.0 * step)
            if segment == ROOT_TRANSLATION:
                if axis < 2:  # what is lowered bends its knees, which are taken to be a little bent
                    assert slope[:2] == pytest.approx(rows[:2, joint, axis], abs=0.1)
            elif segment == 0:  # the hips, too, take the legs along a little
                assert slope == pytest.approx(rows[:, joint, axis], abs=0.05 * BODIES[name].stature)
            else:
                assert slope == pytest.approx(rows[:, joint, axis], abs=1e-6)


@pytest.mark.parametrize("name", BODIES)
def test_a_leg_answers_the_root_as_its_knee_does_while_its_ankle_stays(name: str) -> None:
    posed, step = _PosedBody(STANDING[name], 30), 1e-6
    root = int(np.flatnonzero(posed.chain.joints["segment"] == ROOT_TRANSLATION)[0])
    posed.masses = posed.masses.copy()
    posed.masses[: STANDING[name].morphology.layout.segment_of_part(BodyPart.RIGHT_THIGH), 0] = 0.0
    levers = np.zeros((3, 3))
    add_leg_jacobian(1, 3, 0.0, posed.masses, posed.start.positions, levers)
    for axis, way in enumerate(np.eye(3)):
        slope = (posed.mass(root, step * way) - posed.mass(root, -step * way)) / (2.0 * step)
        assert slope == pytest.approx(levers[:, axis], abs=1e-3 * np.abs(levers).max())


@pytest.mark.parametrize("name", BODIES)
def test_the_centre_of_mass_is_the_same_by_segments_and_by_points(name: str) -> None:
    posed = _PosedBody(STANDING[name], MIDDLE)
    sums = np.empty((len(posed.masses) + 1, 4))
    point = centre_of_mass(posed.shares, posed.start.positions)
    accumulate_masses(posed.masses, posed.start.positions, sums)
    assert sums[-1] == pytest.approx([*point, 1.0], abs=1e-3)
    assert sums[-1, :3] == pytest.approx(point, abs=1e-12)


@pytest.mark.parametrize("side", [0, 1])
def test_an_arm_that_points_at_a_far_place_answers_the_trunk_as_it_does(side: int) -> None:
    posed, step, goal = _PosedBody(STANDING["adult_woman"], 30), 1e-6, np.array([2.0, 0.6 - 1.2 * side, 1.5])
    layout, (joints, masses) = STANDING["adult_woman"].morphology.layout, (posed.chain.joints, posed.masses)
    upper, root = (
        layout.segment_of_part(BodyPart.LEFT_UPPER_ARM if side == 0 else BodyPart.RIGHT_UPPER_ARM),
        layout.collar_point(side) + 1,
    )

    def aimed(joint: int, turn: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        positions, rotations = posed.pose(joint, turn)
        aim_at(
            goal, positions[root + 2].copy(), upper, layout.spine_count, positions[root].copy(), positions, rotations
        )
        return np.array(centre_of_mass(posed.shares, positions)), positions

    first = aimed(0, np.zeros(3))[1]
    sums, rows = np.empty((len(masses) + 1, 4)), np.empty((2, len(joints), 3))
    accumulate_masses(masses, first, sums)
    write_balance_jacobian(2, masses, sums, joints, first, rows)
    reach = float(np.linalg.norm(first[root + 2] - first[root]))
    add_arm_jacobian(side, 2, goal, reach, sums, joints, first, rows)
    for joint, segment in enumerate(joints["segment"]):
        if segment in (0, ROOT_TRANSLATION) or (segment >= layout.spine_count + 2 and segment != upper - 1):
            continue
        for axis in range(3):
            turn = step * np.eye(3)[axis]
            slope = (aimed(joint, turn)[0] - aimed(joint, -turn)[0]) / (2.0 * step)
            assert slope[:2] == pytest.approx(rows[:, joint, axis], abs=2e-3)  # its elbow is hardly bent
