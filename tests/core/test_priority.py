"""Priorities: strict between levels, by weight within one."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from studio.core.body.canonical import BodyPart
from studio.core.body.morphology import Morphology
from studio.core.body.pose import PoseSequence
from studio.core.constraints.balance import BalanceConstraint
from studio.core.constraints.base import WEIGHTED_PARTS, BodyPoint, Chain, Constraint
from studio.core.constraints.position import PositionConstraint
from studio.core.curves.activation import ActivationCurve
from studio.core.grounds.ground import Ground
from studio.core.kernels.records import Pose
from studio.core.kernels.search.backtracking import (
    BACKTRACKING,
    BACKTRACKING_STEPS,
    BACKTRACKING_TARGET,
    BACKTRACKING_TOLERANCE,
    next_step_length,
    start_backtracking,
    update_bracket,
)
from studio.core.kernels.search.joints import (
    ROOT_TRANSLATION,
    add_point_jacobian,
    pose_arm,
    pose_trunk,
    update_joint_damping,
)
from studio.core.kernels.search.null_space_step import eliminate, move_joints, null_space_step
from studio.core.kernels.solve_clip import make_search
from studio.core.kernels.tasks.second_order import EQUALITY_ROW, OBJECTIVE_ROW
from studio.core.normalized.normalize import normalize_capture
from studio.core.normalized.realize import realize_motion
from studio.core.quality.metrics import contact_quality
from studio.core.rotations import angle_between, from_matrix
from studio.core.solver.adapt import body_point_positions, solve_constraints
from studio.core.solver.grounding.grounded_motion import ground_motion
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.core.solver.task_assembly.chains import CLAVICLE_LIMIT, VERTEBRA_LIMIT, joints_of_chains
from studio.io.project.character_file import bundled_characters
from tests.builders import make_capture, make_morphology, make_skeleton
from tests.core.grounding import adapt_again
from tests.core.motions import ALWAYS, local_rotations, target, walk
from tests.core.reachable import reachable_target
from tests.core.scenes import KINDS, Scene
from tests.core.twins import body as body_twin
from tests.core.twins.levers import lever

# Priorities are strict: what stands lower changes nothing of what stands higher, for better or worse.


BODIES = {name: character.morphology for name, character in bundled_characters().items()}
WALK, CONTACTS = walk()
LIMB, ARM, BACK, ALL = Chain(clavicle=0.0), Chain(), Chain(trunk=1.0), Chain(trunk=1.0, root=1.0)
WRIST = BodyPoint(BodyPart.LEFT_FOREARM, at_end=True)
LEAK = 2e-4
"""Metres or radians by which a miss may change."""
BENT = 0.114
"""Metres from an elbow to the line from shoulder to wrist from which on a swivel is exact."""


def _solved(body: Morphology, *constraints: Constraint) -> AdaptedMotion:
    return adapt_again(AdaptRequest(WALK, body, CONTACTS, constraints), 30, 30)


def _higher(body: Morphology, chain: Chain, random: np.random.Generator) -> PositionConstraint:
    """The left wrist at a place within reach or, as often, somewhat beyond."""
    place = reachable_target(_solved(body), 0, WRIST, chain, random)
    beyond = random.choice([0.0, 0.15]) * body.stature * np.array([0.9, 0.4, 0.0])
    return target(BodyPart.LEFT_FOREARM, place + beyond, chain, 0)


@pytest.mark.parametrize("chain", [LIMB, ARM, BACK, ALL], ids=["limb", "arm", "back", "all"])
@pytest.mark.parametrize("lower", ["left_upper_arm", "right_forearm", "head", "thorax"])
@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
def test_a_lower_constraint_does_not_change_what_a_higher_misses(body: Morphology, lower: str, chain: Chain) -> None:
    random = np.random.default_rng(3)
    part = BodyPart(lower)
    own = Chain(0.0, 0.0, 0.0, 1.0, chain.root) if part is BodyPart.THORAX else chain
    for _ in range(4):
        higher = _higher(body, chain, random)
        before = body_point_positions(BodyPoint(part, at_end=True), _solved(body))[0]
        wish = target(part, before + random.normal(size=3) * random.choice([0.05, 0.4]), own, 1)
        alone, both = _solved(body, higher), _solved(body, higher, wish)
        assert abs(both.residuals[0, 0] - alone.residuals[0, 0]) <= LEAK


@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
def test_a_wrist_before_its_elbow_meets_both_where_the_elbow_before_it_does(body: Morphology) -> None:
    """Frames in which the arm is bent enough for its swivel to be exact, METHOD (17)."""
    before, tried = _solved(body), 0
    elbow, wrist = (
        body_point_positions(point, before)[0] for point in (BodyPoint(BodyPart.LEFT_UPPER_ARM, at_end=True), WRIST)
    )
    for seed in range(24):
        random, chain = np.random.default_rng(seed), (ARM, BACK, ALL)[seed % 3]
        way = (wrist - elbow) / np.linalg.norm(wrist - elbow) + random.uniform(0.5, 1.5) * np.array([0.9, 0.0, 0.5])
        first = elbow + 0.04 * random.normal(size=3)
        second = first + np.linalg.norm(wrist - elbow) * way / np.linalg.norm(way)
        parts = (BodyPart.LEFT_UPPER_ARM, first), (BodyPart.LEFT_FOREARM, second)
        swapped, ordered = (
            _solved(body, *(target(part, place, chain, priority) for priority, (part, place) in enumerate(wishes)))
            for wishes in (parts, parts[::-1])
        )
        shoulder = swapped.positions[0, body.layout.collar_point(0) + 1]
        aside = np.linalg.norm(np.cross(first - shoulder, second - shoulder)) / np.linalg.norm(second - shoulder)
        if swapped.residuals.max() < LEAK and aside > BENT:
            tried += 1
            assert ordered.residuals.max() < LEAK, seed
    assert tried > 5


@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
def test_priorities_count_and_not_the_order_in_which_constraints_stand(body: Morphology) -> None:
    random = np.random.default_rng(4)
    for chain in (LIMB, ARM, ALL):
        wrist = _higher(body, chain, random)
        elbow = target(BodyPart.LEFT_UPPER_ARM, wrist.target + random.normal(size=3) * 0.2, chain, 1)
        head = target(BodyPart.HEAD, (1.0, 0.2, 1.2), Chain(1.0, 1.0, 0.0, 1.0, 0.0), 2)
        in_order, mixed = _solved(body, wrist, elbow, head), _solved(body, head, wrist, elbow)
        assert np.allclose(mixed.positions, in_order.positions, atol=1e-9)
        assert np.allclose(mixed.residuals[[1, 2, 0]], in_order.residuals, atol=1e-9)


@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
def test_only_the_order_of_priorities_counts_and_not_their_numbers(body: Morphology) -> None:
    random = np.random.default_rng(5)
    wrist = _higher(body, ALL, random)
    found = [
        _solved(
            body,
            target(BodyPart.LEFT_FOREARM, wrist.target, ALL, first),
            target(BodyPart.HEAD, (1.0, 0.2, 1.2), Chain(1.0, 1.0, 0.0, 1.0, 0.0), second),
        ).positions
        for first, second in ((0, 1), (3, 40))
    ]
    assert np.array_equal(*found)


TRUNKS = Chain(trunk=1.0), ALL, LIMB, Chain(trunk=0.5, clavicle=1.0)
PARTS = (
    BodyPart.LEFT_FOREARM,
    BodyPart.RIGHT_FOREARM,
    BodyPart.LEFT_UPPER_ARM,
    BodyPart.RIGHT_UPPER_ARM,
    BodyPart.HEAD,
    BodyPart.THORAX,
    BodyPart.PELVIS,
)


def _random_set(body: Morphology, away: float, random: np.random.Generator) -> list[Constraint]:
    """Two to eight wishes in order of priority: places ``away`` metres from where things are, a balance perhaps."""
    before, wishes = _solved(body), list[Constraint]()
    for rank in range(random.integers(2, 9)):
        if random.random() < 0.2 and not any(isinstance(each, BalanceConstraint) for each in wishes):
            pelvis = BodyPoint(BodyPart.PELVIS)
            wishes.append(BalanceConstraint("walk", f"{rank}", pelvis, Chain(0.0, 0.0, 0.0, 1.0, 1.0), rank, ALWAYS))
            continue
        part = PARTS[random.integers(len(PARTS))]
        point = BodyPoint(part, at_end=part is not BodyPart.PELVIS)
        chain = Chain(root=1.0) if part is BodyPart.PELVIS else TRUNKS[random.integers(len(TRUNKS))]
        place = tuple((body_point_positions(point, before)[0] + away * random.normal(size=3)).tolist())
        wishes.append(PositionConstraint("walk", f"{rank}", point, chain, rank, ALWAYS, target=place))
    return wishes


def _seeds_for(body: Morphology, count: int) -> range:
    """Every fifth seed: each body has others."""
    return range([*BODIES.values()].index(body), count, len(BODIES))


@pytest.mark.parametrize("away", [0.02, 0.05, 0.1, 0.2, 0.4])
@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
def test_whatever_is_added_below_changes_nothing_of_sets_of_wishes_in_any_order(body: Morphology, away: float) -> None:
    standing = ground_motion(WALK, body, CONTACTS, Ground())
    for seed in _seeds_for(body, 40):
        random = np.random.default_rng(seed)
        wishes = _random_set(body, away, random)
        before = np.zeros(0)
        for count in range(1, len(wishes) + 1):
            order = random.permutation(count)
            after = np.empty(count)
            after[order] = solve_constraints(standing, [wishes[place] for place in order], 30, 30).residuals[:, 0]
            assert (abs(after[:-1] - before) <= LEAK).all(), (seed, count)
            before = after


@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
def test_whatever_is_added_below_changes_nothing_of_wishes_of_any_kind(body: Morphology) -> None:
    motion, contacts = walk(60)
    standing = ground_motion(motion, body, contacts, Ground())
    before = solve_constraints(standing, ())
    for seed in _seeds_for(body, 150):
        random = np.random.default_rng(seed)
        scene = Scene(before, seed, random.choice([*KINDS, "clear", "position"], size=random.integers(2, 9)).tolist())
        levels = np.cumsum(random.random(len(scene.constraints)) < 0.7)
        wishes = [replace(each, priority=int(level)) for each, level in zip(scene.constraints, levels, strict=True)]
        above = np.zeros(0)
        for level in np.unique(levels):
            order = random.permutation(np.sum(levels <= level))
            after = np.empty(len(order))
            after[order] = solve_constraints(
                standing, [wishes[place] for place in order], 40, 40, scene.tracks
            ).residuals[:, 0]
            assert (abs(after[: len(above)] - above) <= LEAK).all(), (seed, level)
            above = after


@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
@pytest.mark.parametrize("eased", [False, True])
def test_what_does_not_act_changes_nothing(eased: bool, body: Morphology) -> None:
    """Any constraint, of any chain, weight and priority, be it over or, eased, still to come."""
    motion, contacts = walk(60)
    standing = ground_motion(motion, body, contacts, Ground())
    past = ActivationCurve(5.0, 5.0, 6.0, 6.0) if eased else ActivationCurve(0.0, 0.0, 0.1, 0.2)
    before = solve_constraints(standing, ())
    for seed in _seeds_for(body, 20):
        random = np.random.default_rng(seed)
        scene = Scene(before, seed, random.choice([*KINDS, "position"], size=random.integers(1, 5)).tolist())
        idle: Constraint = target(PARTS[random.integers(len(PARTS))], (2.0, 1.0, 2.0), Chain(1.0, 1.0, 1.0, 1.0, 1.0))
        if seed % 2:
            chain = Chain(0.0, 0.0, 0.0, 1.0, 1.0, free_arms=1.0, free_legs=1.0)
            idle = BalanceConstraint("walk", "idle", BodyPoint(BodyPart.PELVIS), chain, 0, past)
        idle = replace(idle, priority=int(random.integers(4)), activation=past, weight=20.0)
        window = (40, 59) if eased else (40, 40)
        alone = solve_constraints(standing, scene.constraints, *window, scene.tracks, eased=eased)
        beside = solve_constraints(standing, (*scene.constraints, idle), *window, scene.tracks, eased=eased)
        assert abs(beside.positions - alone.positions).max() < 1e-7, seed


# One step of all joints: levers against brute force, elimination in order, limits.


seeds = st.integers(0, 2**32 - 1)
BODY = make_morphology(spine_count=4)
LAYOUT, K = BODY.layout, BODY.layout.spine_count
POSITIONS, ROTATIONS = (array[11] for array in realize_motion(walk(20)[0], BODY))
ENDS = {2: 3, K - 1: K, K: K + 1, K + 1: K + 2, K + 2: LAYOUT.collar_point(0) + 1, K + 6: LAYOUT.collar_point(1) + 1}
"""Segments of the trunk, each with a point that goes with it."""


@given(seeds, st.integers(1, 8), st.integers(1, 4))
def test_elimination_solves_what_can_be_solved(seed: int, count: int, sides: int) -> None:
    random = np.random.default_rng(seed)
    factor = random.normal(size=(count, count))
    matrix, right = factor @ factor.T + count * np.eye(count), random.normal(size=(count, sides))
    work = np.column_stack([matrix, right, np.diag(matrix)])
    eliminate(work, count, count + sides)
    assert np.allclose(work[:, count:-1], np.linalg.solve(matrix, right), atol=1e-3)


def test_a_held_row_that_says_what_a_higher_one_has_settled_gives_in() -> None:
    work = np.array([[1.0, 1.0, 0.5, 1.0], [1.0, 1.0, -0.3, 1.0]])
    eliminate(work, 2, 3)
    assert np.allclose([1.0, 1.0] @ work[:, 2], 0.5, atol=1e-4)
    assert np.isfinite(work).all()


@pytest.mark.parametrize("segment", ENDS)
def test_levers_are_what_small_turns_show(segment: int) -> None:
    free = joints_of_chains((Chain(1.0, 1.0, 1.0, 1.0, 1.0),), (0,), LAYOUT)
    direction = np.array([0.36, -0.48, 0.8])
    row, point = np.zeros((len(free.joints), 3)), ENDS[segment]
    add_point_jacobian(POSITIONS[point], *direction, segment, free.joints, POSITIONS, row)
    for joint, found in zip(free.joints, row, strict=True):
        if joint[0] == ROOT_TRANSLATION:
            assert found == pytest.approx(direction)
        else:
            expected = lever(LAYOUT, int(joint[0]), point, direction, POSITIONS, ROTATIONS)
            assert found == pytest.approx(expected, abs=1e-5)


class _Search:
    """Points of random segments of the trunk that are to go a little way, each along its direction; no feet."""

    def __init__(self, seed: int, count: int = 2, held: int = 0, chain: Chain | None = None) -> None:
        random = np.random.default_rng(seed)
        chain = chain or Chain(1.0, 1.0, 1.0, 1.0, 0.5)
        self.held, self.count = held, count + held
        self.free = joints_of_chains((chain,) * self.count, (0,) * self.count, LAYOUT)
        segments = random.choice(np.array(list(ENDS)), size=self.count, replace=False)
        self.segments = [int(segment) for segment in segments]
        self.points = [ENDS[segment] for segment in self.segments]
        directions = random.normal(size=(self.count, 3))
        self.directions = directions / np.linalg.norm(directions, axis=1, keepdims=True)
        self.goals = np.where(np.arange(self.count) < held, 0.0, random.uniform(-0.01, 0.01, self.count))
        self.pose = Pose(POSITIONS.copy(), ROTATIONS.copy())
        self.search = make_search(self.count, len(self.free.joints), len(POSITIONS))

    def step(self) -> float:
        """Ask for what is left of the goals; how far anything moves."""
        search, chain, rows = self.search, self.free.kernel_weights, self.search.rows
        rows.jacobian[:], rows.errors[: self.count] = 0.0, self.goals - self.gained
        for row, (segment, point) in enumerate(zip(self.segments, self.points, strict=True)):
            rows.weight_rows[row], rows.roles[row], rows.point_errors["segment"][row] = (
                row,
                EQUALITY_ROW if row < self.held else OBJECTIVE_ROW,
                -1,
            )
            place, jacobian = self.pose.positions[point], rows.jacobian[row]
            add_point_jacobian(place, *self.directions[row], segment, chain.joints, self.pose.positions, jacobian)
        update_joint_damping(search.state, chain.joints, chain.limits, search.segment_rotations, rows.damping)
        null_space_step(self.held, self.count, 1.0, rows, chain, search.equations, self.pose.positions)
        steps, start = search.equations.directions, Pose(POSITIONS, ROTATIONS)
        moved = move_joints(0.0, chain, search.segment_rotations, steps[-2] + steps[-1], search.state)
        pose_trunk(search.state, chain.joint_of_segment, start, search.segment_rotations, self.pose)
        for side in range(2):
            pose_arm(side, search.state, chain.joint_of_segment, start, search.segment_rotations, self.pose)
        return float(moved)

    @property
    def gained(self) -> np.ndarray:
        """Displacement of each point along its direction."""
        return np.sum((self.pose.positions[self.points] - POSITIONS[self.points]) * self.directions, axis=1)


@given(seeds)
def test_steps_for_one_constraint_close_a_small_error(seed: int) -> None:
    search = _Search(seed, count=1)
    for _ in range(5):
        search.step()
    assert search.gained == pytest.approx(search.goals, abs=1e-4)


@given(seeds)
def test_what_is_held_stays_while_others_ask(seed: int) -> None:
    search = _Search(seed, count=2, held=1)
    for _ in range(8):
        search.step()
    assert abs(search.gained[0]) < 2e-4


@given(seeds)
def test_a_step_keeps_every_bone_of_the_trunk_and_the_arms(seed: int) -> None:
    search = _Search(seed)
    search.step()
    lengths = [body_twin.bone_lengths(LAYOUT, points)[: K + 10] for points in (search.pose.positions, POSITIONS)]
    assert np.allclose(*lengths, atol=1e-12)


@given(seeds)
def test_joints_never_turn_beyond_their_limits(seed: int) -> None:
    search = _Search(seed)
    search.goals *= 50
    for _ in range(20):
        search.step()
    turned = 2.0 * np.arctan(np.linalg.norm(search.search.state, axis=1))
    segments = search.free.joints["segment"]
    assert turned[(segments > 0) & (segments < K)].max() <= VERTEBRA_LIMIT + 1e-9
    assert turned[(segments == K + 2) | (segments == K + 6)].max() <= CLAVICLE_LIMIT + 1e-9


def test_only_the_root_moves_where_only_the_root_is_free() -> None:
    search = _Search(4, chain=Chain(0.0, 0.0, 0.0, 0.0, 1.0))
    assert search.step() > 0.0
    assert np.allclose(search.pose.rotations[: K + 10], ROTATIONS[: K + 10], atol=1e-12)
    assert not np.allclose(search.pose.positions[: K + 3], POSITIONS[: K + 3], atol=1e-6)


# The one retreat: back along a step until what it disturbs is allowed.


ALLOWED = 8e-5


def _retreated(disturbs: Callable[[float], float], at_start: float = 0.0) -> tuple[float, float, int]:
    """Share and disturbance where a retreat ends, and how often it looked."""
    retreat, looks = np.zeros(1, BACKTRACKING)[0], 0
    start_backtracking(at_start, disturbs(1.0), ALLOWED, retreat)
    while next_step_length(retreat):
        update_bracket(disturbs(float(retreat["step_length"])), retreat)
        looks += 1
    return float(retreat["step_length"]), float(retreat["violation"]), looks


@pytest.mark.parametrize("power", [0.5, 1.0, 2.0, 5.0])
@pytest.mark.parametrize("whole", [1e-4, 1e-3, 0.1, 10.0])
def test_it_ends_where_most_of_what_is_allowed_is_disturbed(power: float, whole: float) -> None:
    share, disturbs, looks = _retreated(lambda share: whole * share**power)
    assert disturbs == whole * share**power < ALLOWED
    assert looks <= BACKTRACKING_STEPS + 1
    if power >= 1.0 and whole <= 0.1:
        assert abs(disturbs - BACKTRACKING_TARGET * ALLOWED) < BACKTRACKING_TOLERANCE * ALLOWED


@pytest.mark.parametrize("edge", [0.05, 0.1, 0.5, 0.9])
def test_where_it_disturbs_all_at_once_it_stays_before_that(edge: float) -> None:
    share, disturbs, _ = _retreated(lambda share: 1.0 if share > edge else 0.0)
    assert disturbs == 0.0
    assert 0.4 * edge < share <= edge


def test_where_every_share_disturbs_it_ends_at_the_start_and_says_so() -> None:
    assert _retreated(lambda _: 1.0)[:2] == (0.0, 1.0)


def test_steps_that_differ_little_go_back_to_poses_that_differ_little() -> None:
    shares = [_retreated(lambda share, whole=whole: whole * share)[0] for whole in np.geomspace(1e-4, 0.1, 400)]
    wanted = BACKTRACKING_TARGET * ALLOWED / np.geomspace(1e-4, 0.1, 400)
    assert np.abs(np.divide(shares, wanted) - 1.0).max() < 1.5 * BACKTRACKING_TOLERANCE / BACKTRACKING_TARGET


# Weights: equals share by theirs, and each segment of a chain moves as freely as its own says, on every body.


TRUNK, WHOLE = Chain(trunk=1.0), Chain(trunk=1.0, root=1.0)
MET = 2e-4


def _still() -> Any:
    """A body with its arms held out, its left the mirror of its right."""
    skeleton = make_skeleton()
    turns = np.tile([0.0, 0.0, 0.0, 1.0], (2, skeleton.joint_count, 1))
    poses = PoseSequence(turns, np.tile(skeleton.offsets, (2, 1, 1)))
    return normalize_capture(make_capture("still", 2, skeleton=skeleton, poses=poses))[0]


STILL = _still()


def _walking(body: Morphology, *constraints: PositionConstraint) -> AdaptedMotion:
    return adapt_again(AdaptRequest(WALK, body, CONTACTS, constraints), 30, 30)


def _reach(body: Morphology, chain: Chain, **changes: Any) -> PositionConstraint:
    """The left wrist on a place that it can reach with the help of the trunk."""
    wrist = _walking(body).positions[0, body.layout.wrist_point(0)]
    return target("left_forearm", wrist + np.array([0.2, 0.14, 0.2]) * body.stature, chain, **changes)


def _angle(first: np.ndarray, second: np.ndarray) -> float:
    return float(angle_between(from_matrix(first), from_matrix(second)))


def _misses(body: Morphology, chain: Chain, left: float, right: float, apart: float = 0.3) -> np.ndarray:
    """(2,) metres by which both wrists, pulled apart by ``apart`` beyond their reach, are missed."""
    wrists = adapt_again(AdaptRequest(STILL, body), 0, 0).positions[
        0, [body.layout.wrist_point(0), body.layout.wrist_point(1)]
    ]
    wishes = [
        target(f"{side}_forearm", wrist + np.array([0.3, sign * apart, -0.1]), chain, weight=weight)
        for side, wrist, sign, weight in zip(("left", "right"), wrists, (1.0, -1.0), (left, right), strict=True)
    ]
    return adapt_again(AdaptRequest(STILL, body, (), tuple(wishes)), 0, 0).residuals[:, 0]


@pytest.mark.parametrize("chain", [TRUNK, WHOLE], ids=["trunk", "all"])
@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
@given(weight=st.floats(0.1, 10.0), ratio=st.floats(1.05, 20.0), apart=st.floats(0.2, 0.5))
@settings(max_examples=15)
def test_of_two_equals_that_cannot_both_be_met_the_heavier_is_missed_less_and_swapped_weights_swap_the_misses(
    body: Morphology, chain: Chain, weight: float, ratio: float, apart: float
) -> None:
    heavy, light = _misses(body, chain, weight * ratio, weight, apart)
    even = _misses(body, chain, weight, weight, apart)
    assert heavy < even[0] < light
    # Joints are eliminated left before right, and a search that far out of reach ends after six steps.
    assert even[0] == pytest.approx(even[1], abs=1e-3)
    assert _misses(body, chain, weight, weight * ratio, apart) == pytest.approx([light, heavy], abs=2e-3)


@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
def test_the_heavier_the_less_it_is_missed_and_only_the_ratio_counts(body: Morphology) -> None:
    heavier = [_misses(body, WHOLE, weight, 1.0) for weight in (1.0, 1.5, 2.0, 3.0)]
    assert (np.diff([left for left, _ in heavier]) < 0.0).all()
    assert (np.diff([right for _, right in heavier]) > 0.0).all()
    assert np.array_equal(_misses(body, WHOLE, 2.0, 1.0), _misses(body, WHOLE, 1.0, 0.5))


@pytest.mark.parametrize("weight", [1e-300, 0.01, 7.0, 1e6])
def test_the_weight_of_one_alone_changes_nothing_and_none_is_too_large(weight: float) -> None:
    body = BODIES["adult_woman"]
    asked = _reach(body, WHOLE)
    assert np.array_equal(_walking(body, replace(asked, weight=weight)).positions, _walking(body, asked).positions)
    assert np.isfinite(_misses(body, WHOLE, weight, 1.0)).all()


@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
def test_equals_that_can_both_be_met_are_met_whatever_their_weights(body: Morphology) -> None:
    wrists = _walking(body).positions[0, [body.layout.wrist_point(0), body.layout.wrist_point(1)]]
    wishes = [
        target(f"{side}_forearm", wrist + np.array([0.1, 0.0, 0.1]), WHOLE, weight=weight)
        for side, wrist, weight in zip(("left", "right"), wrists, (1.0, 30.0), strict=True)
    ]
    assert _walking(body, *wishes).residuals.max() < MET


@pytest.mark.parametrize("locked", [BodyPart.ABDOMEN, BodyPart.THORAX, BodyPart.LEFT_CLAVICLE], ids=str)
@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
def test_a_locked_segment_keeps_its_rotation_in_the_one_that_carries_it(body: Morphology, locked: BodyPart) -> None:
    segments = [
        segment for segment in range(body.layout.segment_count) if body.layout.part_of_segment(segment) == locked
    ]
    free, kept = _reach(body, WHOLE), _reach(body, replace(WHOLE, segments=((locked, 0.0),)))
    before = local_rotations(_walking(body))[0, segments]
    assert np.abs(local_rotations(_walking(body, free))[0, segments] - before).max() > 1e-3
    assert np.abs(local_rotations(_walking(body, kept))[0, segments] - before).max() < 1e-6
    assert _walking(body, kept).residuals.max() < MET


@pytest.mark.parametrize("stiff", [Chain(trunk=0.2, root=1.0), replace(WHOLE, segments=((BodyPart.ABDOMEN, 0.2),))])
@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
def test_a_stiffer_trunk_turns_less_for_the_same_target(body: Morphology, stiff: Chain) -> None:
    abdomen = body.layout.segment_of_part(BodyPart.ABDOMEN)
    before = local_rotations(_walking(body))[0, abdomen]
    turns = [
        _angle(local_rotations(_walking(body, _reach(body, chain)))[0, abdomen], before) for chain in (WHOLE, stiff)
    ]
    assert turns[1] < 0.6 * turns[0]


@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
def test_a_pelvis_with_a_weight_turns_and_the_feet_stay(body: Morphology) -> None:
    freed = replace(WHOLE, segments=((BodyPart.PELVIS, 1.0),))
    before, usual, turned = _walking(body), _walking(body, _reach(body, WHOLE)), _walking(body, _reach(body, freed))
    assert usual.rotations[0, 0] == pytest.approx(before.rotations[0, 0], abs=1e-12)
    assert _angle(turned.rotations[0, 0], before.rotations[0, 0]) > 0.02
    assert turned.residuals.max() < MET
    for chain in (freed, replace(freed, root=0.0)):
        walked = adapt_again(AdaptRequest(WALK, body, CONTACTS, (_reach(body, chain),)))
        assert contact_quality(walked, CONTACTS, Ground()).slide < 1.2e-3


@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
def test_segments_with_the_weights_of_their_groups_are_as_none_to_the_bit(body: Morphology) -> None:
    chain = Chain(clavicle=0.5, trunk=0.7, root=1.0)
    asked = _reach(body, chain)
    same = replace(asked, chain=replace(chain, segments=tuple((part, chain.weight(part)) for part in WEIGHTED_PARTS)))
    assert np.array_equal(_walking(body, same).rotations, _walking(body, asked).rotations)
