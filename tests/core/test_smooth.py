"""Smooth targets have smooth answers, wherever on the floor."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from studio.cli.bench_cases import clip_of, make_tasks
from studio.core.body.canonical import BodyPart
from studio.core.body.joint_limits import limb_limit_records
from studio.core.body.pose import PoseSequence
from studio.core.body.rest_pose import rest_pose
from studio.core.captures.capture import Capture
from studio.core.constraints.area import AreaConstraint, AreaShape
from studio.core.constraints.balance import BalanceConstraint
from studio.core.constraints.base import BodyPoint, Chain, Constraint
from studio.core.constraints.clear import ClearConstraint
from studio.core.constraints.distance import DistanceConstraint
from studio.core.constraints.follow import FollowTracked
from studio.core.constraints.look_at import EYES_POINT, LookAtConstraint
from studio.core.constraints.orientation import OrientationConstraint
from studio.core.constraints.position import PositionConstraint
from studio.core.curves.activation import ActivationCurve
from studio.core.grounds.ground import Ground
from studio.core.kernels.tasks.goals import RADIAN_LENGTH
from studio.core.kernels.time.acceleration_peaks import TOTAL_PEAK_FRACTION
from studio.core.normalized.transition import QUIET_PEAK
from studio.core.plausible import PLACE_RANGE, TURN_RANGE
from studio.core.quality.metrics import angular_acceleration, contact_quality
from studio.core.quality.report import BLOCKED_BY_SMOOTHING, report_of
from studio.core.rotations import angle_between, from_matrix
from studio.core.solver.adapt import adapt, body_point_positions, solve_constraints
from studio.core.solver.grounding.grounded_motion import GroundedMotion, ground_motion
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.core.solver.smoothing.limb_coordinates import LimbCoordinates
from studio.core.solver.smoothing.target_motion import target_accelerations
from studio.core.solver.solved_window import ALL_LIMITS, SolvedWindow
from studio.core.solver.task_assembly.contact_release import constraint_activations
from studio.core.solver.task_assembly.packing import pack_tasks
from studio.core.solver.task_assembly.tracks import Targets, Track
from studio.io.importing import GUESS_ALL, load_capture
from studio.io.project.character_file import bundled_characters
from studio.jobs.adaptation import ReadyCapture, ready_capture, ready_from_capture
from studio.resources_folder import example_captures_folder
from tests.core.motions import ALWAYS, RATE, local_rotations, random_rotations, target, walk
from tests.core.scenes import Scene
from tests.core.twins.rotation import from_vector, to_vector

# Smooth targets have smooth answers, and every finite target is answered by a body.


BODIES = tuple(character.morphology for character in bundled_characters().values())
WALK, CONTACTS = walk(90)
BEFORE = tuple(adapt(AdaptRequest(WALK, body, CONTACTS)) for body in BODIES)
ALONE = {
    "position": (250.0, 1400.0), "orientation": (30.0, 60.0), "look_at": (25.0, 50.0), "distance": (60.0, 1000.0),
    "balance": (25.0, 50.0), "area": (600.0, 6000.0), "clear": (25.0, 50.0),
}  # fmt: skip
"""Radians a second squared: the median and the worst peak of any joint of trunk and arms, one wish of a kind alone."""
TOGETHER = (1400.0, 22_000.0)
"""The same for sets of one to five wishes."""
LARGEST = PLACE_RANGE.most
"""Metres: the farthest that a place may be."""


def _peak(seed: int, *kinds: str) -> float:
    before = BEFORE[seed % len(BODIES)]
    scene = Scene(before, seed, kinds)
    asked = AdaptRequest(WALK, before.morphology, CONTACTS, scene.constraints, tracks=scene.tracks)
    legs = before.morphology.layout.spine_count + 10
    return float(angular_acceleration(local_rotations(adapt(asked))[:, :legs], RATE).max())


@pytest.mark.parametrize("kind", ALONE)
def test_one_wish_that_moves_smoothly_moves_no_joint_with_a_jerk(kind: str) -> None:
    peaks = [_peak(seed, kind) for seed in range(12)]
    median, worst = ALONE[kind]
    assert np.median(peaks) < median
    assert max(peaks) < worst


def test_sets_of_wishes_that_move_smoothly_move_no_joint_with_a_jerk() -> None:
    peaks = [_peak(seed) for seed in range(30)]
    median, worst = TOGETHER
    assert np.median(peaks) < median
    assert max(peaks) < worst


sizes = st.sampled_from([0.0, 1e-300, 1e-12, 1e-9, 1e-3, 0.3, 1.0, 7.0, 1e3, LARGEST])
numbers = st.builds(lambda size, sign: sign * size, sizes, st.sampled_from([-1.0, 1.0]))
places = st.one_of(
    st.tuples(numbers, numbers, numbers),
    st.integers(0, BEFORE[0].positions.shape[1] - 1).map(lambda joint: tuple(BEFORE[0].positions[10, joint].tolist())),
)
"""Anywhere, and exactly on a joint of the body."""
parts = st.sampled_from(list(BodyPart))
points = st.builds(BodyPoint, parts, st.one_of(st.just((0.0, 0.0, 0.0)), places), st.booleans())
weights = st.sampled_from([0.0, 1e-9, 0.5, 1.0])
chains = st.tuples(weights, weights, weights, weights, weights).filter(any).map(lambda each: Chain(*each))


def _made(kind: type[Constraint], point: BodyPoint, chain: Chain, priority: int, **own: object) -> Constraint | None:
    try:
        return kind("motion", "Wild", point, chain, priority, ALWAYS, **own)
    except ValueError:  # refused when made, as it should be
        return None


def _wild(kind: type[Constraint], **own: st.SearchStrategy[object]) -> st.SearchStrategy[Constraint | None]:
    build: Callable[..., Constraint | None] = _made
    return st.builds(build, st.just(kind), points, chains, st.integers(0, 2), **own)


positive = sizes.filter(bool)
anything = st.one_of(
    _wild(PositionConstraint, target=places),
    _wild(OrientationConstraint, target=st.tuples(numbers, numbers, numbers, numbers)),
    _wild(LookAtConstraint, target=places),
    _wild(DistanceConstraint, other=st.one_of(places, points), distance=sizes),
    _wild(ClearConstraint, margin=st.sampled_from([0.0, 1e-12, 0.1, 0.5])),
    _wild(BalanceConstraint, place=st.one_of(st.none(), places.map(lambda place: place[:2]))),
    _wild(
        AreaConstraint,
        shape=st.sampled_from(list(AreaShape)),
        centre=places,
        size=st.tuples(positive, positive, positive),
        heading=numbers.filter(lambda turn: abs(turn) <= TURN_RANGE.most),
        inside=st.booleans(),
    ),
)


def _is_a_body(adapted: AdaptedMotion, before: AdaptedMotion) -> bool:
    turns = np.swapaxes(adapted.rotations, -1, -2) @ adapted.rotations
    return bool(
        np.isfinite(adapted.positions).all()
        and np.abs(turns - np.eye(3)).max() < 1e-9
        and not np.isinf(adapted.residuals).any()
        and adapted.positions.shape == before.positions[10:12].shape
    )


@given(st.lists(anything, min_size=1, max_size=5), st.sampled_from(range(len(BODIES))), st.booleans())
def test_whatever_finite_is_asked_the_answer_is_a_body(asked: list[Constraint | None], body: int, stands: bool) -> None:
    constraints = tuple(each for each in asked if each is not None)
    request = AdaptRequest(WALK, BODIES[body], CONTACTS if stands else (), constraints)
    assert _is_a_body(adapt(request, 10, 11), BEFORE[body])


@given(anything, st.sampled_from(range(len(BODIES))))
def test_the_same_asked_twice_or_at_two_priorities_is_no_trouble(asked: Constraint | None, body: int) -> None:
    if asked is None:
        return
    again = type(asked)(**{**vars(asked), "priority": asked.priority + 1})
    request = AdaptRequest(WALK, BODIES[body], CONTACTS, (asked, asked, again))
    assert _is_a_body(adapt(request, 10, 11), BEFORE[body])


# Smooth targets have smooth answers, by METHOD's figure: three times what the source and the target bring.


STANDING = tuple(ground_motion(WALK, body, CONTACTS, Ground()) for body in BODIES)
SOLVED = tuple(solve_constraints(standing, ()) for standing in STANDING)
ARM, TRUNK, WHOLE = Chain(), Chain(trunk=1.0), Chain(trunk=1.0, root=1.0)
KINDS = "wrist", "hand", "elbow", "head", "pelvis", "balance", "look"
PARTS = {"wrist": "forearm", "hand": "hand", "elbow": "upper_arm"}
FURTHEST = {"wrist": 0.35, "hand": 0.35, "elbow": 0.35, "head": 0.14, "pelvis": 0.07}
"""Metres that targets may be from where the motion has their points."""
LEVER, SLOWEST, FASTEST = 0.3, 0.1, 0.5
"""Metres; hertz at which targets sway."""

HARD = (
    *((312, 1), (323, 2), (1202, 2), (103, 3), (158, 3), (387, 3), (538, 3)),
    *((82, 3), (127, 3), (152, 3), (33, 4), (43, 4), (219, 4), (342, 4), (522, 4), (593, 4), (1027, 4), (1303, 4)),
)
"""Seeds and counts of sets in which levels nearly jolt, arms that are held are all but straight, or are at limits."""


class Wishes:
    """Wishes drawn at random: the motion's own points shifted, and swayed by three slow sines."""

    def __init__(self, before: AdaptedMotion, seed: int, count: int) -> None:
        self.before, self.random = before, np.random.default_rng([seed, count])
        self.tracks: dict[FollowTracked, Track] = {}
        self.brings = 0.0
        """Radians a second squared."""
        kinds = self.random.choice(KINDS, size=count, replace=False)
        self.constraints = tuple(self.made(kind, number) for number, kind in enumerate(kinds))

    def made(self, kind: str, number: int) -> Constraint:
        priority, before = int(self.random.integers(3)), self.before
        if kind == "balance":
            chain = Chain(limb=0.0, clavicle=0.0, trunk=1.0, root=1.0)
            return BalanceConstraint("motion", kind, BodyPoint(BodyPart.PELVIS), chain, priority, ALWAYS)
        if kind == "look":
            ahead = body_point_positions(EYES_POINT, before) + before.rotations[:, 0] @ np.array([2.0, 0.0, 0.0])
            target = self.sway(number, ahead, 0.6, 2.0)
            return LookAtConstraint("motion", kind, EYES_POINT, Chain(0, 0, 1, 1), priority, ALWAYS, target=target)
        point, chain = self.point_and_chain(kind)
        shift = self.random.normal(size=3)
        shift *= FURTHEST[kind] * self.random.uniform(0.2, 1.0) / np.linalg.norm(shift)
        target = self.sway(number, body_point_positions(point, before) + shift, 0.4 * FURTHEST[kind], LEVER)
        return PositionConstraint("motion", f"{kind} {number}", point, chain, priority, ALWAYS, target=target)

    def point_and_chain(self, kind: str) -> tuple[BodyPoint, Chain]:
        side = ("left", "right")[self.random.integers(2)]
        if kind == "pelvis":
            return BodyPoint(BodyPart.PELVIS), Chain(0, 0, 0, 0, 1)
        if kind == "head":
            return BodyPoint(BodyPart.HEAD, at_end=True), Chain(0, 0, 1, 1, float(self.random.integers(2)))
        return BodyPoint(BodyPart(f"{side}_{PARTS[kind]}"), at_end=True), (ARM, TRUNK, WHOLE)[self.random.integers(3)]

    def sway(self, number: int, places: np.ndarray, widest: float, lever: float) -> FollowTracked:
        """Something to follow that sways about ``places`` (F, 3), seen over a lever in metres."""
        times = np.arange(len(places))[:, None] / self.before.frame_rate
        rates = 2.0 * np.pi * self.random.uniform(SLOWEST, FASTEST, size=(3, 1, 1))
        phases = rates * times + 2.0 * np.pi * self.random.uniform(size=(3, 1, 3))
        aside = widest * self.random.normal(size=(3, 1, 3)) / 3.0
        speed = np.linalg.norm((aside * rates * np.cos(phases)).sum(axis=0), axis=1)
        push = np.linalg.norm((aside * rates**2 * np.sin(phases)).sum(axis=0), axis=1)
        self.brings += float(((push + speed**2 / lever) / lever).max())
        follow = FollowTracked(f"{number}")
        self.tracks[follow] = Track(places + (aside * np.sin(phases)).sum(axis=0), np.eye(3)[None])
        return follow


def _peak_of_set(seed: int, count: int) -> float:
    """The peak beside what source and wishes bring together."""
    standing, before = STANDING[seed % len(BODIES)], SOLVED[seed % len(BODIES)]
    wishes, upper = Wishes(before, seed, count), before.morphology.layout.spine_count + 10
    solved = solve_constraints(standing, wishes.constraints, tracks=wishes.tracks, eased=True)
    source, peak = (
        angular_acceleration(local_rotations(each)[:, :upper], each.frame_rate).max() for each in (before, solved)
    )
    return float(peak / (max(source, QUIET_PEAK) + wishes.brings))


@pytest.mark.parametrize("count", [1, 2, 3, 4])
def test_wishes_that_move_smoothly_move_few_joints_with_a_jerk(count: int) -> None:
    """Of 680 sets, 170 of each count, 16 break the law of three times, all of several wishes; the worst has 7.9."""
    hard = [seed for seed, number in HARD if number == count]
    peaks = [_peak_of_set(seed, count) for seed in (*range(40), *hard)]
    assert np.quantile(peaks, 0.95) < 3.0


# Targets that jolt from frame to frame are smoothed in time, and no others: a walk past swaying and steady ones.


WOMAN = bundled_characters()["adult_woman"].morphology
LONG, LONG_CONTACTS = walk(600)
WRIST = BodyPoint(BodyPart.RIGHT_FOREARM, at_end=True)
KINDS_THAT_JOLT = (25, 1), (14, 2), (27, 2), (24, 3)
"""Seeds and counts of wishes whose frames, solved alone, jolt."""


def _greatest_peak(adapted: AdaptedMotion) -> float:
    arms = adapted.morphology.layout.spine_count + 10
    return float(angular_acceleration(local_rotations(adapted)[:, :arms], adapted.frame_rate).max())


def _past(standing: GroundedMotion, *changes: object) -> Constraint:
    """A wrist that is to stay where it is in the middle of the walk: before and after it is far out of reach."""
    middle = standing.motion.frame_count // 2
    place = body_point_positions(WRIST, solve_constraints(standing, ()))[middle] + [0.0, -0.1, 0.2]
    return target("right_forearm", place, Chain(trunk=1.0, root=1.0), **dict(changes))


def test_what_does_not_jolt_is_as_if_nothing_could_be_eased() -> None:
    same = []
    for seed in range(10):
        wishes = Wishes(SOLVED[seed % 5], seed, 1)
        asked = (STANDING[seed % 5], wishes.constraints)
        plain, eased = (solve_constraints(*asked, tracks=wishes.tracks, eased=e) for e in (False, True))
        same.append(np.array_equal(plain.rotations, eased.rotations))
    assert sum(same) >= 5


@pytest.mark.parametrize(("seed", "count"), KINDS_THAT_JOLT)
def test_feet_that_stand_stay_where_they_are_and_joints_do_not_jolt(seed: int, count: int) -> None:
    wishes = Wishes(SOLVED[seed % 5], seed, count)
    plain, eased = (
        solve_constraints(STANDING[seed % 5], wishes.constraints, tracks=wishes.tracks, eased=e) for e in (False, True)
    )
    allowed = 3.0 * (max(QUIET_PEAK, _greatest_peak(SOLVED[seed % 5])) + wishes.brings)
    assert _greatest_peak(plain) > allowed > _greatest_peak(eased)
    assert contact_quality(eased, CONTACTS, Ground()).slide < 2e-4


@pytest.mark.parametrize("seed", range(12))
def test_what_is_eased_below_takes_nothing_from_what_stands_above(seed: int) -> None:
    """By more than 0.2 mm or mrad."""
    standing, before = STANDING[seed % 5], SOLVED[seed % 5]
    wishes = Wishes(before, seed, 3)
    ordered = tuple(replace(each, priority=k) for k, each in enumerate(wishes.constraints))
    residuals = [
        solve_constraints(standing, ordered[: 1 + k], tracks=wishes.tracks, eased=True).residuals for k in range(3)
    ]
    for k in range(2):
        worse = residuals[k + 1][: k + 1] - residuals[k]
        assert worse.max() < 2.5e-4


def test_any_window_is_as_the_whole_clip() -> None:
    standing = ground_motion(LONG, WOMAN, LONG_CONTACTS, Ground())
    wish = _past(standing)
    plain, whole = (solve_constraints(standing, (wish,), eased=e) for e in (False, True))
    eased = np.flatnonzero(np.abs(whole.positions - plain.positions).max(axis=(1, 2)) > 1e-4)
    assert len(eased) > 20
    for first, last in (
        (int(eased[3]), int(eased[3])),
        (max(int(eased[0]) - 5, 0), int(eased[0]) + 30),
        (0, 4),
        (590, 599),
    ):
        window = solve_constraints(standing, (wish,), first, last, eased=True)
        assert window.rotations == pytest.approx(whole.rotations[first : last + 1], abs=1e-12)
        assert window.residuals == pytest.approx(whole.residuals[:, first : last + 1], abs=1e-12, nan_ok=True)


def test_frames_jolt_as_much_when_they_are_solved_as_when_they_are_eased() -> None:
    wishes = Wishes(SOLVED[4], 24, 3)
    activations = constraint_activations(wishes.constraints, STANDING[4])
    window = SolvedWindow(STANDING[4], wishes.constraints, activations, wishes.tracks, ALL_LIMITS, slice(0, 90))
    window.solve()
    assert window.may_exceed_peaks
    solve, layout = window.whole, SOLVED[4].morphology.layout
    turns = LimbCoordinates(layout, STANDING[4].rotations, limb_limit_records(BODIES[4])).joint_rotations(
        window.solution(slice(0, 90))[1]
    )
    measured = solve.peaks_of(solve.states, turns)
    looked = solve.sharp[:, -1] > 0.0  # others turn so little that nobody looked
    assert 3 < looked.sum() < 88
    assert solve.sharp[:, :-1] == pytest.approx(measured[:, :-1])
    assert solve.sharp[looked, -1] == pytest.approx(measured[looked, -1])
    assert measured[~looked, -1].max() < TOTAL_PEAK_FRACTION * STANDING[4].peak_angular_accelerations.max()


def test_nothing_is_eased_where_nothing_acts() -> None:
    standing = ground_motion(LONG, WOMAN, LONG_CONTACTS, Ground())
    acts = ActivationCurve(3.0, 3.3, 8.0, 8.3)
    solved, before = (
        solve_constraints(standing, (_past(standing, ("activation", acts)),), eased=True),
        solve_constraints(standing, ()),
    )
    times = np.arange(LONG.frame_count) / LONG.frame_rate
    beyond = (times <= 3.0) | (times >= 8.3)
    assert np.array_equal(solved.rotations[beyond], before.rotations[beyond])


def test_joints_stay_within_their_limits_while_they_are_eased() -> None:
    for seed, count in KINDS_THAT_JOLT:
        wishes, before = Wishes(SOLVED[seed % 5], seed, count), SOLVED[seed % 5]
        eased = solve_constraints(STANDING[seed % 5], wishes.constraints, tracks=wishes.tracks, eased=True)
        charts = LimbCoordinates(before.morphology.layout, before.rotations, limb_limit_records(before.morphology))
        turns = charts.joint_rotations(eased.rotations)
        kept = charts.rotations(charts.clamped_to_limits(charts.coordinates(turns)))
        arms = np.r_[0:3, 4:7]
        assert angle_between(from_matrix(turns), from_matrix(kept))[:, arms].max() < 0.02


def test_a_body_with_free_joints_and_one_that_keeps_clear_of_itself_are_eased_too() -> None:
    wishes = Wishes(SOLVED[4], 14, 2)
    allowed = 3.0 * (max(QUIET_PEAK, _greatest_peak(SOLVED[4])) + wishes.brings)
    free = replace(STANDING[4], limited=False)
    assert _greatest_peak(solve_constraints(free, wishes.constraints, tracks=wishes.tracks, eased=True)) < allowed
    clear = ClearConstraint("motion", "Clear", BodyPoint(BodyPart.THORAX), Chain(), 3, ActivationCurve(0, 0, 9, 9))
    solved = solve_constraints(STANDING[4], (*wishes.constraints, clear), tracks=wishes.tracks, eased=True)
    assert np.isfinite(solved.positions).all()
    assert len(solved.residuals) == 3


def test_a_report_says_what_was_missed_for_easing() -> None:
    request = AdaptRequest(
        LONG, WOMAN, LONG_CONTACTS, (_past(ground_motion(LONG, WOMAN, LONG_CONTACTS, Ground())),), eased=True
    )
    standing = ground_motion(LONG, WOMAN, LONG_CONTACTS, Ground())
    adapted = solve_constraints(standing, request.constraints, eased=True)
    assert (report_of(standing, request, adapted).winners == BLOCKED_BY_SMOOTHING).any()


@given(seed=st.integers(0, 2**32 - 1), limited=st.booleans())
def test_charts_of_limbs_give_back_what_they_were_given(seed: int, limited: bool) -> None:
    random = np.random.default_rng(seed)
    layout = WOMAN.layout
    rotations = random_rotations(random, 3, layout.segment_count)
    charts = LimbCoordinates(layout, rotations, limb_limit_records(WOMAN)[: 4 * limited])
    turns = charts.joint_rotations(rotations)
    assert charts.rotations(charts.coordinates(turns)) == pytest.approx(turns, abs=1e-7)


@given(hertz=st.floats(0.2, 2.0), metres=st.floats(0.01, 0.08))
def test_a_wish_that_sways_brings_what_a_lever_needs_to_follow_it(hertz: float, metres: float) -> None:
    rate, count = 120.0, 600
    times, still = np.arange(count) / rate, rest_pose(WOMAN)
    positions, rotations = (np.broadcast_to(each, (count, *each.shape)) for each in still)
    way = metres * np.sin(2.0 * np.pi * hertz * times)[:, None] * [1.0, 0.0, 0.0]
    follow = FollowTracked("sway")
    targets = Targets(
        times,
        {follow: Track(positions[:, WOMAN.layout.wrist_point(1)] + way, np.eye(3)[None])},
        lambda: way,
        WOMAN.leg_length,
    )
    rows = pack_tasks([replace(target("right_forearm", (0, 0, 0)), target=follow)], WOMAN.layout, targets)
    brings = target_accelerations(rows, 0, np.ones((1, count)), positions, rotations, WOMAN, rate)
    push, speed = metres * (2.0 * np.pi * hertz) ** 2, metres * 2.0 * np.pi * hertz
    angles = np.linspace(0.0, 2.0 * np.pi, 1000)
    highest = np.max(push * np.abs(np.sin(angles)) + speed**2 * np.cos(angles) ** 2 / RADIAN_LENGTH) / RADIAN_LENGTH
    assert brings[0, 0, 60:-60].max() == pytest.approx(highest, rel=0.02)
    assert not brings[1].any()


@pytest.mark.parametrize("metres", [0.01, 0.1, 2.0])
def test_a_ramp_brings_as_much_as_the_angle_that_it_fades_in(metres: float) -> None:
    """A ramp of 0.3 s was allowed 64 rad/s2 for a target 1 cm off: a new constraint on a calm neck jolted."""
    rate, count = 120.0, 240
    times, still = np.arange(count) / rate, rest_pose(WOMAN)
    positions, rotations = (np.broadcast_to(each, (count, *each.shape)) for each in still)
    place = still[0][WOMAN.layout.wrist_point(1)] + [metres, 0.0, 0.0]
    targets = Targets(times, {}, lambda: positions[:, 0], WOMAN.leg_length)
    rows = pack_tasks([target("right_forearm", tuple(place))], WOMAN.layout, targets)
    ramp = ActivationCurve(0.5, 0.8, 1.2, 1.5).at(times)
    brings = target_accelerations(rows, 0, ramp[None], positions, rotations, WOMAN, rate)[1, 0].max()
    sharpest = np.abs(np.diff(ramp, 2)).max() * rate**2
    assert brings == pytest.approx(min(metres / RADIAN_LENGTH, 1.0) * sharpest, rel=0.1)


@pytest.mark.parametrize("name", ["adult_woman", "child"])
def test_a_calm_walk_keeps_its_reach_beside_a_balance(name: str) -> None:
    """Smoothing misses no target by over 25 mm more than the exact answer, however calm its source is: 0.8 m before."""
    ready = ready_capture(example_captures_folder() / "walk_turn.bvh", GUESS_ALL)
    for task in make_tasks(*clip_of(ready), bundled_characters()[name].morphology)[-3:]:
        exact, smooth = (adapt(replace(task.request, eased=eased)) for eased in (False, True))
        assert np.nanmax(np.nan_to_num(smooth.residuals) - np.nan_to_num(exact.residuals)) < 0.025


# Edges of constraints, at which what is solved is blended: every joint is on its way, and what holds, holds.


EDGES = ActivationCurve(0.4, 0.6, 0.9, 1.1)
EARLIER = ActivationCurve(0.2, 0.55, 0.8, 1.15)
LATER = ActivationCurve(0.5, 0.7, 1.0, 1.2)
UPPER = WOMAN.layout.spine_count + 10
"""Segments of trunk, neck, head and arms; legs are on their ankles."""


def _solved(*constraints: Constraint) -> AdaptedMotion:
    return adapt(AdaptRequest(WALK, WOMAN, CONTACTS, constraints, limited=False))


BEFORE_EDGES = _solved()
SHOULDER = np.median(BEFORE_EDGES.positions[30:60, WOMAN.layout.collar_point(1) + 1], axis=0)
BEHIND, FAR = SHOULDER + np.array([-0.2, 0.1, 0.3]), SHOULDER + np.array([1.5, -0.3, 0.2])


def _along(first: AdaptedMotion, second: AdaptedMotion, shares: np.ndarray) -> np.ndarray:
    """Local rotations that are ``shares`` of the way from the first to the second, (F, S, 3, 3)."""
    begin, end = local_rotations(first)[:, :UPPER], local_rotations(second)[:, :UPPER]
    ways = np.array(
        [[to_vector(b.T @ e) for b, e in zip(*frame, strict=True)] for frame in zip(begin, end, strict=True)]
    )
    turns = [[from_vector(share * way) for way in frame] for share, frame in zip(shares, ways, strict=True)]
    return begin @ np.array(turns)


@pytest.mark.parametrize("chain", [Chain(), TRUNK], ids=["arm and clavicle", "and trunk"])
@pytest.mark.parametrize("place", [BEHIND, FAR], ids=["past the shoulder", "out of reach"])
def test_every_joint_goes_the_part_of_its_way_that_its_activation_says(place: np.ndarray, chain: Chain) -> None:
    wish = target(BodyPart.RIGHT_FOREARM, place, chain)
    eased = local_rotations(_solved(replace(wish, activation=EDGES)))[:, :UPPER]
    on_the_way = _along(BEFORE_EDGES, _solved(wish), EDGES.at(np.arange(WALK.frame_count) / RATE))
    limbs = [WOMAN.layout.spine_count + 3 + bone for bone in (0, 1, 4, 5)]  # what turns twice goes nearly so
    assert np.abs(eased - on_the_way)[:, limbs].max() < 1e-6
    assert np.abs(eased - on_the_way).max() < 0.02


@pytest.mark.parametrize("priority", [1, 2], ids=["beside", "below"])
def test_what_is_wholly_active_holds_while_others_come_and_go(priority: int) -> None:
    wrist = np.median(body_point_positions(BodyPoint(BodyPart.LEFT_FOREARM, at_end=True), BEFORE_EDGES)[20:70], axis=0)
    balance = BalanceConstraint("motion", "Balance", BodyPoint(BodyPart.PELVIS), Chain(0, 0, 0, 1, 1), 0, ALWAYS)
    near = target(BodyPart.LEFT_FOREARM, wrist + np.array([0.0, 0.0, 0.1]), WHOLE, 1)
    far = target(BodyPart.RIGHT_FOREARM, FAR, WHOLE, priority, activation=EDGES)
    elbow = target(BodyPart.LEFT_UPPER_ARM, wrist + np.array([0.1, 0.3, 0.3]), Chain(), 2, activation=LATER)
    held = _solved(balance, near).residuals[:, 33:63]
    both = _solved(balance, near, far, elbow).residuals[:, 33:63]
    assert np.all(both[0] < held[0] + 2e-4)
    if priority > 1:
        assert np.all(both[1] < held[1] + 2e-4)


@pytest.mark.parametrize("limited", [True, False])
@pytest.mark.parametrize("acts", ["while it acts", "while what is above it comes and goes"])
def test_what_is_out_of_reach_stays_as_far_off_whatever_acts_below(acts: str, limited: bool) -> None:
    """By the pose itself, of points that are wanted up to half a metre from where they were."""
    times = np.arange(90) / RATE
    first_acts, most = (ALWAYS, 3e-4) if acts == "while it acts" else (EARLIER, 4e-4)

    def solved(*constraints: Constraint) -> AdaptedMotion:
        return adapt(AdaptRequest(WALK, WOMAN, CONTACTS, constraints, limited=limited))

    for seed in range(12):
        random, wishes = np.random.default_rng(seed), list[Constraint]()
        for priority, number in enumerate(random.permutation(4).tolist()):
            part = (BodyPart.RIGHT_FOREARM, BodyPart.LEFT_FOREARM, BodyPart.HEAD, BodyPart.RIGHT_UPPER_ARM)[number]
            way = random.normal(size=3)
            place = body_point_positions(BodyPoint(part, at_end=True), BEFORE_EDGES)[45] + 0.5 * way / np.linalg.norm(
                way
            )
            wishes.append(target(part, place, (Chain(), TRUNK, WHOLE)[random.integers(3)], priority))
            wishes[-1] = replace(wishes[-1], activation=(first_acts, ALWAYS, EDGES, LATER)[priority])
        above = solved(*wishes[:2])
        for count in (3, 4):
            for wish in wishes[:2]:
                first, second = (
                    np.linalg.norm(body_point_positions(wish.point, each) - np.array(wish.target), axis=1)
                    for each in (above, solved(*wishes[:count]))
                )
                whole = wish.activation.at(times) >= 1.0
                assert np.abs(second - first)[whole].max() < most, (seed, count, wish.name)


def test_a_moment_more_of_an_edge_changes_little() -> None:
    """Frames in which an edge begins or ends, and in which two change places as to which acts more."""
    left = target(BodyPart.LEFT_FOREARM, FAR + np.array([0.0, 0.6, 0.0]), WHOLE, 1, activation=EDGES)
    for begin in (EDGES, LATER):
        right = target(BodyPart.RIGHT_FOREARM, FAR, WHOLE, 0, activation=begin)
        moved = replace(right, activation=begin.moved(1e-6))
        first, second = _solved(left, right), _solved(left, moved)
        assert np.abs(first.positions - second.positions).max() < 1e-3


def test_a_miss_grows_with_the_activation() -> None:
    wish = target(BodyPart.RIGHT_FOREARM, FAR, Chain())
    always, eased = (_solved(each).residuals[0] for each in (wish, replace(wish, activation=EDGES)))
    shares = EDGES.at(np.arange(WALK.frame_count) / RATE)
    assert np.array_equal(np.isnan(eased), shares == 0.0)
    assert np.allclose(eased[shares > 0.0], (shares * always)[shares > 0.0], atol=1e-9)


# A motion is adapted the same wherever on the floor it is and whichever way it heads.


CHARACTERS = bundled_characters()


def _elsewhere(capture: Capture, turn: Rotation, way: np.ndarray) -> Capture:
    rotations, places = capture.poses.local_rotations.copy(), capture.poses.local_translations.copy()
    rotations[:, 0] = (turn * Rotation.from_quat(rotations[:, 0])).as_quat()
    places[:, 0] = turn.apply(places[:, 0]) + way
    return replace(capture, poses=PoseSequence(rotations, places))


def _adapted(ready: ReadyCapture, name: str) -> np.ndarray:
    body = CHARACTERS[name]
    actor = ready.actor.morphology
    asked = AdaptRequest(ready.motion, body.morphology, ready.contacts, actor=actor, eased=True, clears=True)
    return np.asarray(adapt(asked).positions, dtype=np.float64)


@pytest.mark.parametrize("stem", ["walk_turn", "straight_punch", "cartwheel", "handstand"])
@pytest.mark.parametrize("name", ["child", "giant"])
def test_who_heads_elsewhere_does_the_same(stem: str, name: str) -> None:
    capture = load_capture(example_captures_folder() / f"{stem}.bvh")
    turn = Rotation.from_euler("z", 2.4)
    here, there = (
        _adapted(ready_from_capture(each), name)
        for each in (capture, _elsewhere(capture, turn, np.array([30.0, -20.0, 0.0])))
    )
    back = turn.inv().apply((there - there[0, 0]).reshape(-1, 3)).reshape(there.shape)
    assert np.abs(back - (here - here[0, 0])).max() < 1e-4
