"""Measures of quality, and the report on constraints."""

import gc
import weakref
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.scenes import scene
from studio.core.body.canonical import BodyPart
from studio.core.body.morphology import Morphology
from studio.core.body.rest_pose import rest_pose
from studio.core.captures.contacts import FOOT_POINTS, ContactInterval, ContactPoint, Touch
from studio.core.constraints.balance import BalanceConstraint
from studio.core.constraints.base import BodyPoint, Chain, Constraint
from studio.core.constraints.orientation import OrientationConstraint
from studio.core.constraints.position import PositionConstraint
from studio.core.curves.activation import ActivationCurve
from studio.core.grounds.ground import Ground
from studio.core.grounds.slope import Slope
from studio.core.grounds.steps import Steps
from studio.core.mesh.volume import BodyVolume, usual_volume
from studio.core.normalized.realize import realize_motion
from studio.core.quality import metrics
from studio.core.quality.contact_tracks import contact_tracks
from studio.core.quality.metrics import (
    acceleration_ratio,
    angular_acceleration,
    body_heights,
    contact_quality,
    skate_distances,
    turning_peaks,
)
from studio.core.quality.motion_quality import motion_quality
from studio.core.quality.report import (
    BLOCKED_BY_CLEARANCE,
    BLOCKED_BY_CONTACTS,
    BLOCKED_BY_LIMITS,
    BLOCKED_BY_NOTHING,
    BLOCKED_BY_REACH,
    BLOCKED_BY_SMOOTHING,
    MET_TOLERANCE_BY_UNIT,
    QualityReport,
    blocking_constraints,
    fully_active,
    report_of,
    sampled_frames,
)
from studio.core.rotations import to_matrix
from studio.core.solver.adapt import adapt, body_point_positions, solve_constraints
from studio.core.solver.grounding.grounded_motion import grounded_motion_of
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.core.solver.solved_window import SolverLimits
from studio.core.solver.task_assembly.clearance import arm_distances
from studio.io.project.character_file import bundled_characters
from tests.builders import make_morphology
from tests.core.motions import RATE, about, walk
from tests.core.test_constraint_kinds import ALL, BODIES, LEFT, RIGHT, ask
from tests.core.test_targets import CONTACTS as STANDS
from tests.core.test_targets import WALK, every_body
from tests.core.test_touching import guard

# The measures of quality, on motions whose faults are known.


BODY = make_morphology()


def _standing(frames: int = 20, first_frame: int = 0) -> AdaptedMotion:
    """A body with level feet, their soles on the ground z = 0, that does not move."""
    layout = BODY.layout
    positions = np.zeros((frames, layout.point_count, 3))
    for side in range(2):
        positions[:, layout.ankle_point(side)] = [0.0, 0.1, BODY.ankle_height[side]]
        positions[:, layout.toe_point(side)] = positions[:, layout.ankle_point(side)] + BODY.foot[side]
    rotations = np.tile(np.eye(3), (frames, layout.segment_count, 1, 1))
    return AdaptedMotion(BODY, RATE, first_frame, positions, rotations, np.zeros((0, frames)))


def _moved(motion: AdaptedMotion, shift: object, frames: slice) -> AdaptedMotion:
    positions = motion.positions.copy()
    positions[frames] += shift
    return replace(motion, positions=positions)


def _contacts(first: int, last: int) -> tuple[ContactInterval, ...]:
    return tuple(ContactInterval("walk", point, first, last) for point in FOOT_POINTS)


def test_a_foot_that_stands_has_no_fault() -> None:
    quality = contact_quality(_standing(), _contacts(0, 19), Ground())
    assert (quality.slide, quality.rise, quality.penetration) == pytest.approx((0.0, 0.0, 0.0), abs=1e-15)


@pytest.mark.parametrize(
    ("shift", "expected"),
    [((0.03, 0.04, 0.0), (0.05, 0.0, 0.0)), ((0, 0, 0.02), (0.0, 0.02, 0.0)), ((0, 0, -0.01), (0.0, 0.0, 0.01))],
)
def test_each_fault_is_told_in_metres(shift: tuple, expected: tuple) -> None:
    quality = contact_quality(_moved(_standing(), shift, slice(10, 12)), _contacts(0, 19), Ground())
    assert (quality.slide, quality.rise, quality.penetration) == pytest.approx(expected, abs=1e-12)


def test_what_happens_outside_contacts_is_no_fault() -> None:
    wild = _moved(_standing(), (1.0, 1.0, 1.0), slice(10, None))
    assert contact_quality(wild, _contacts(0, 9), Ground()).slide == 0.0
    assert contact_quality(wild, (), Ground()).rise == 0.0


def test_a_lifted_ground_makes_feet_sink() -> None:
    quality = contact_quality(_standing(), _contacts(0, 19), Ground(0.05))
    assert (quality.rise, quality.penetration) == pytest.approx((0.0, 0.05))


def test_a_tilted_foot_lifts_its_heel_by_the_heels_lever() -> None:
    motion = _standing()
    motion.rotations[:, BODY.layout.spine_count + 12] = to_matrix(about((0, 1, 0), np.array(0.2)))
    heel = (ContactInterval("walk", ContactPoint.LEFT_HEEL, 0, 19),)
    lever, height = BODY.heel_length[0], BODY.ankle_height[0]
    lifted = height + lever * np.sin(0.2) - height * np.cos(0.2)
    assert contact_quality(motion, heel, Ground()).rise == pytest.approx(lifted)


@pytest.mark.parametrize("ground", [Ground(0.01), Slope(angle=0.3), Steps(rise=0.05, tread=0.1)])
def test_every_contact_is_measured_by_itself(ground: Ground) -> None:
    motion = adapt(AdaptRequest(walk()[0], BODY))
    spans = {ContactPoint.LEFT_TOE: [(3, 9), (10, 14), (20, 29)], ContactPoint.RIGHT_HEEL: [(0, 5), (16, 30)]}
    spans |= {ContactPoint.LEFT_KNEE: [(2, 4), (8, 12)]}
    contacts = [ContactInterval("walk", point, *span) for point, both in spans.items() for span in both]
    together = np.array(contact_tracks(motion, contacts, ground))
    alone = np.array([contact_tracks(motion, [each], ground) for each in contacts])
    assert (np.isfinite(alone).sum(axis=0) == np.isfinite(together)).all()
    assert np.nansum(alone, axis=0) == pytest.approx(np.nan_to_num(together), abs=1e-12)


def test_a_windows_frames_are_counted_in_the_whole_motion() -> None:
    window = _moved(_standing(first_frame=100), (0.1, 0.0, 0.0), slice(5, None))
    assert contact_quality(window, _contacts(90, 104), Ground()).slide == 0.0
    assert contact_quality(window, _contacts(90, 105), Ground()).slide == pytest.approx(0.1)
    assert contact_quality(window, _contacts(0, 99), Ground()).slide == 0.0
    assert contact_quality(window, _contacts(120, 130), Ground()).slide == 0.0


def test_a_steady_turn_has_no_angular_acceleration_and_a_growing_one_has() -> None:
    times = np.arange(30) / RATE
    steady = to_matrix(about((0, 0, 1), 3.0 * times))
    growing = to_matrix(about((0, 0, 1), 4.0 * times**2))
    assert angular_acceleration(steady, RATE) == pytest.approx(np.zeros(28), abs=1e-8)
    assert angular_acceleration(growing, RATE) == pytest.approx(np.full(28, 8.0))


def _walking() -> AdaptedMotion:
    motion, _ = walk()
    return AdaptedMotion(BODY, motion.frame_rate, 0, *realize_motion(motion, BODY), np.zeros((0, motion.frame_count)))


def test_a_motion_is_as_smooth_as_itself() -> None:
    assert acceleration_ratio(_walking(), _walking()) == 1.0


def test_a_popping_knee_shows() -> None:
    popped = _walking()
    shank = BODY.layout.spine_count + 11
    popped.rotations[70, shank] = popped.rotations[70, shank] @ to_matrix(about((1, 0, 0), np.array(0.3)))
    assert acceleration_ratio(popped, _walking()) > 5.0


def test_a_window_is_beside_the_same_frames_of_its_source() -> None:
    whole = _walking()
    window = replace(whole, first_frame=40, positions=whole.positions[40:80], rotations=whole.rotations[40:80])
    assert acceleration_ratio(window, whole) == 1.0
    short = replace(window, rotations=window.rotations[:2], positions=window.positions[:2])
    assert acceleration_ratio(short, whole) == 1.0


def test_a_still_source_counts_as_quiet_and_not_as_nothing() -> None:
    assert acceleration_ratio(_standing(), _standing()) == 0.0


def test_nothing_of_a_source_is_kept_once_it_was_compared() -> None:
    """The last four sources of reports stayed in memory, 0.3 GB each for a quarter of an hour."""
    source = _walking()
    ghost = weakref.ref(source)
    assert acceleration_ratio(_walking(), source) == 1.0
    del source
    gc.collect()
    assert ghost() is None


def test_peaks_of_a_long_motion_are_found_in_runs_of_frames() -> None:
    motion = _walking()
    whole = turning_peaks(motion)
    for length in (3, 7):
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(metrics, "PEAK_CHUNK_FRAMES", length)
            assert np.array_equal(turning_peaks(motion), whole)


def test_the_ground_is_level_and_its_height_a_number() -> None:
    assert Ground(0.3).height_at(np.zeros((4, 5, 3))).tolist() == np.full((4, 5), 0.3).tolist()
    with pytest.raises(ValueError, match="finite number of metres"):
        Ground(np.nan)


def test_a_body_of_other_proportions_that_does_the_same_does_not_jump() -> None:
    """Hands of arms three times as long beside the legs go three times as far in the same posture."""
    motion, contacts = walk()
    chibi = replace(
        BODY, arm=3.0 * BODY.arm, hand=3.0 * BODY.hand, spine=3.0 * BODY.spine, collar_base=3.0 * BODY.collar_base
    )
    shown = []
    for body in (BODY, chibi):
        positions, rotations = realize_motion(motion, body)
        shown.append(AdaptedMotion(body, RATE, 0, positions, rotations, np.zeros((0, len(positions)))))
    assert motion_quality(shown[1], shown[0], contacts, Ground()).jump < 1.2


def _rotated(motion: AdaptedMotion, segments: list[int], axis: int, degrees: float) -> AdaptedMotion:
    """The motion with segments rotated about an axis of their own; the joints stay."""
    quaternion = np.eye(4)[axis] * np.sin(np.radians(degrees) / 2) + np.eye(4)[3] * np.cos(np.radians(degrees) / 2)
    rotations = np.array(motion.rotations)
    rotations[:, segments] = rotations[:, segments] @ to_matrix(quaternion)
    return replace(motion, rotations=rotations)


def test_faces_palms_and_toes_that_look_elsewhere_are_seen_to_the_degree() -> None:
    motion, contacts = walk()
    positions, rotations = realize_motion(motion, BODY)
    layout = BODY.layout
    feet, toes = ([at(side) for side in (0, 1)] for at in (layout.foot_segment, layout.toe_segment))
    rotations[:, toes] = rotations[:, feet]
    source = AdaptedMotion(BODY, RATE, 0, positions, rotations, np.zeros((0, len(positions))))
    same = motion_quality(source, source, contacts, Ground())
    assert (same.face, same.palms, same.toes, same.swing_knee) == pytest.approx((0.0, 0.0, 0.0, 0.0), abs=1e-7)
    for segments, name, degrees in (
        ([layout.head_joint], "face", 35.0),
        ([layout.hand_segment(1)], "palms", 50.0),
        (toes, "toes", 40.0),
    ):
        found = motion_quality(_rotated(source, segments, 1, degrees), source, contacts, Ground())
        assert np.degrees(getattr(found, name)) == pytest.approx(degrees)


def test_a_knee_that_is_straighter_in_the_air_is_seen() -> None:
    motion, contacts = walk()
    positions, rotations = realize_motion(motion, BODY)
    source = AdaptedMotion(BODY, RATE, 0, positions, rotations, np.zeros((0, len(positions))))
    straight, hip = positions.copy(), BODY.layout.hip_point(0)
    straight[:, hip + 1] = (straight[:, hip] + straight[:, hip + 2]) / 2.0
    found = motion_quality(replace(source, positions=straight), source, contacts, Ground())
    assert found.swing_knee > np.radians(20.0)
    assert motion_quality(source, replace(source, positions=straight), contacts, Ground()).swing_knee <= 0.0


def test_what_is_inside_its_body_at_rest_may_be_so_in_motion() -> None:
    thin, thick = (
        BodyVolume(v.segments, v.places, v.radii, g * v.girths) for v in [usual_volume(BODY)] for g in (1, 15)
    )
    positions, rotations = (np.tile(each, (10, *[1] * each.ndim)) for each in rest_pose(BODY))
    still = [AdaptedMotion(BODY, RATE, 0, positions, rotations, np.zeros((0, 10)), volume=v) for v in (thin, thick)]
    assert arm_distances(still[1]).min() < -0.1
    assert motion_quality(still[1], still[0], (), Ground()).inside == 0.0


def test_a_foot_in_the_floor_is_seen_without_a_contact() -> None:
    """A released foot 116 mm under the floor was reported as 0."""
    sunk = _moved(_standing(), (0.0, 0.0, -0.116), slice(10, 12))
    assert contact_quality(sunk, (), Ground()).penetration == 0.0
    assert body_heights(sunk, Ground()).min() == pytest.approx(-0.116)
    assert body_heights(_standing(), Ground()).min() == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("depth", [0.0, 0.03, 0.116])
@pytest.mark.parametrize("ground", [Ground(0.2), Slope(0.1, 0.3), Steps(0.0, 0.15, 0.3)])
def test_depth_is_that_of_the_lowest_point_under_level_sloped_and_stepped_ground(ground: Ground, depth: float) -> None:
    motion, contacts = walk()
    adapted = adapt(AdaptRequest(motion, BODY, contacts, ground=ground))
    slope = np.cos(0.3) if isinstance(ground, Slope) else 1.0
    before = body_heights(adapted, ground)
    sunk = body_heights(_moved(adapted, (0.0, 0.0, -depth), slice(20, 40)), ground)
    assert before.min() > -0.02
    np.testing.assert_allclose(sunk[20:40], before[20:40] - depth * slope, atol=1e-9)
    np.testing.assert_array_equal(sunk[:20], before[:20])


def test_a_foot_that_glides_along_the_ground_skates_whatever_its_contacts_say() -> None:
    still = _standing(61)
    glide = np.linspace(0.0, 1.0, 61)[:, None, None]
    for speed, expected in ((0.3, 0.3), (5.0, 0.0)):
        moved = replace(still, positions=still.positions + speed * 60.0 / RATE * glide * [1.0, 0.0, 0.0])
        assert skate_distances(moved, Ground()).max() == pytest.approx(expected * 60.0 / RATE, abs=1e-9)
    assert contact_quality(still, (), Ground()).slide == 0.0
    assert skate_distances(still, Ground()).max() == 0.0
    lifted = _moved(still, (0.0, 0.0, 0.02), slice(0, 61))
    drifting = replace(lifted, positions=lifted.positions + 0.3 * glide * [1.0, 0.0, 0.0])
    assert skate_distances(drifting, Ground()).max() == 0.0


# A report says by how much each constraint is missed in every frame, and who kept it from being met.


FIRST, LAST = 25, 40
PELVIS = BodyPoint(BodyPart.PELVIS)
ALWAYS = ActivationCurve(-1.0, -1.0, 100.0, 100.0)


def reported(body: Morphology, *constraints: Constraint) -> tuple[AdaptedMotion, QualityReport]:
    request = AdaptRequest(WALK, body, STANDS, constraints)
    adapted = adapt(request, FIRST, LAST)
    return adapted, report_of(grounded_motion_of(request), request, adapted)


def beside(body: Morphology, point: BodyPoint, *way: float) -> tuple[float, ...]:
    return tuple(body_point_positions(point, adapt(AdaptRequest(WALK, body, STANDS)))[30] + np.array(way))


@every_body
def test_what_is_met_was_kept_by_nobody_and_what_is_too_far_by_the_bodys_reach(body: Morphology) -> None:
    near = ask(PositionConstraint, RIGHT, ALL, target=beside(body, RIGHT, 0.05, 0.0, 0.05))
    far = ask(PositionConstraint, LEFT, Chain(), 1, target=beside(body, LEFT, 0.0, 3.0, 0.0))
    adapted, report = reported(body, near, far)
    assert report.residuals is adapted.residuals
    assert (report.winners[0] == BLOCKED_BY_NOTHING).all()
    assert (report.winners[1] == BLOCKED_BY_REACH).all()


@every_body
def test_a_higher_constraint_on_the_same_wrist_is_named(body: Morphology) -> None:
    first = ask(PositionConstraint, RIGHT, ALL, 0, target=beside(body, RIGHT, 0.05, 0.0, 0.05))
    bystander = ask(PositionConstraint, LEFT, ALL, 0, target=beside(body, LEFT, 0.02, 0.0, 0.02))
    second = ask(PositionConstraint, RIGHT, ALL, 1, target=beside(body, RIGHT, -0.05, 0.0, 0.1))
    _, report = reported(body, first, bystander, second)
    assert (report.winners[:2] == BLOCKED_BY_NOTHING).all()
    assert (report.winners[2] == 0).all()


@every_body
def test_feet_that_stand_are_named_where_they_hold_the_pelvis_and_where_a_foot_is_to_leave(body: Morphology) -> None:
    up = ask(PositionConstraint, PELVIS, Chain(0, 0, 0, 0, 1), target=beside(body, PELVIS, 0.0, 0.0, 0.3))
    foot = BodyPoint(BodyPart.LEFT_SHANK, at_end=True)
    kick = ask(PositionConstraint, foot, Chain(1, 0, 0, 0, 0.5), 1, target=beside(body, foot, 0.3, 0.0, 0.3))
    adapted, report = reported(body, up, kick)
    missed = adapted.residuals[0] > 2e-4
    assert missed.any()
    assert (report.winners[0][missed] == BLOCKED_BY_CONTACTS).all()
    standing = np.isfinite(report.slides[:2]).any(axis=0)
    assert standing.any()
    assert (report.winners[1][standing] == BLOCKED_BY_CONTACTS).all()


def test_joints_that_turn_no_further_are_named() -> None:
    back = ask(OrientationConstraint, BodyPoint(BodyPart.THORAX), Chain(0, 0, 0, 1, 0), target=(0, 0, 1, 0))
    _, report = reported(BODIES["tall_man"], back)
    assert (report.winners == BLOCKED_BY_LIMITS).all()


@every_body
def test_the_arrays_have_a_number_a_frame_and_say_what_the_worst_values_say(body: Morphology) -> None:
    balance = ask(BalanceConstraint, PELVIS, Chain(0, 0, 0, 1, 1))
    adapted, report = reported(body, balance)
    frames = adapted.frame_count
    assert report.slides.shape == report.heights.shape == (len(ContactPoint), frames)
    assert report.knee_speeds.shape == (2, frames)
    assert report.mass_margins.shape == (frames,)
    quality = contact_quality(adapted, STANDS, Ground())
    assert np.nanmax(report.slides) == pytest.approx(quality.slide)
    assert max(np.nanmax(-report.heights), 0.0) == pytest.approx(quality.penetration)
    assert report.knee_speeds.max() < 20.0
    assert (np.isfinite(report.mass_margins) == np.isfinite(report.slides).any(axis=0)).all()
    assert np.nanmax(report.mass_margins) < 0.3


def test_who_does_not_act_keeps_nobody_from_anything() -> None:
    """A constraint that frees the root now and then is not named where it is inactive."""
    standing = grounded_motion_of(AdaptRequest(WALK, BODIES["child"], STANDS))
    for seed in range(4):
        asked = scene(standing, solve_constraints(standing, ()), seed)
        adapted = solve_constraints(standing, asked)
        named = blocking_constraints(standing, asked, {}, adapted)
        acts = np.isfinite(adapted.residuals)
        assert all(acts[named[row, frame], frame] for row, frame in zip(*np.nonzero(named >= 0), strict=True))


def punch(body: str, *constraints: Constraint, touch: bool = False, clears: bool = False) -> AdaptRequest:
    motion, actor, contacts = guard()
    character = bundled_characters()[body]
    feet = tuple(each for each in contacts if isinstance(each.point, ContactPoint))
    touches = (ContactInterval("motion", Touch.HANDS_TOGETHER, 20, 60),) if touch else ()
    known = motion, character.morphology, (*feet, *touches), constraints
    return AdaptRequest(*known, volume=character.volume, actor=actor, clears=clears)


def blockers(request: AdaptRequest) -> set[int]:
    """Blockers of what the poses miss where it is asked for fully, in some frames of a punch; none without a name."""
    standing = grounded_motion_of(request)
    adapted = solve_constraints(standing, request.constraints, 20, 60, eased=request.eased)
    report = report_of(standing, request, adapted)
    limits = [[MET_TOLERANCE_BY_UNIT[each.unit]] for each in request.constraints]
    missed = (report.misses > limits) & fully_active(request.constraints, request.motion.times[20:61])
    return set(report.winners[missed].tolist())


@pytest.mark.parametrize("body", ["child", "giant"])
def test_hands_that_touch_keep_no_balance_from_being_met(body: str) -> None:
    """A hand that follows another one moves the mass; the balance counts it."""
    wrist = BodyPoint(BodyPart.LEFT_FOREARM, at_end=True)
    away = body_point_positions(wrist, adapt(punch(body), 40, 40))[0] + [0.1, 0.2, 0.25]
    lift = PositionConstraint("motion", "Lift", wrist, Chain(trunk=1.0), 0, ALWAYS, target=tuple(away.tolist()))
    balance = BalanceConstraint("motion", "Balance", PELVIS, Chain(trunk=1.0, root=1.0), 1, ALWAYS)
    assert not blockers(punch(body, lift, balance, touch=True))
    assert not blockers(punch(body, lift, balance))


@pytest.mark.parametrize("body", ["child", "giant"])
def test_arms_that_stay_out_of_the_body_are_named_where_nobody_misses_without_them(body: str) -> None:
    standing = grounded_motion_of(punch(body))
    asked = scene(standing, solve_constraints(standing, ()), 1)
    named = []
    for clears in (True, False):
        request = punch(body, *asked, clears=clears)
        posed = grounded_motion_of(request)
        named.append(report_of(posed, request, solve_constraints(posed, asked)).winners)
    assert (named[0] == BLOCKED_BY_CLEARANCE).any()
    assert not (named[1] == BLOCKED_BY_CLEARANCE).any()


def test_smoothing_is_named_only_where_the_frame_solved_by_itself_misses_less() -> None:
    for seed in range(3):
        standing = grounded_motion_of(punch("child"))
        request = replace(punch("child", *scene(standing, solve_constraints(standing, ()), seed)), eased=True)
        eased, exact = (solve_constraints(standing, request.constraints, eased=eased) for eased in (True, False))
        found = report_of(standing, request, eased).winners == BLOCKED_BY_SMOOTHING
        assert (eased.residuals[found] > exact.residuals[found]).all()
        plain = replace(request, eased=False)
        assert not (report_of(standing, plain, exact).winners == BLOCKED_BY_SMOOTHING).any()


def test_reach_is_named_only_where_a_body_that_is_free_of_all_else_misses_as_well() -> None:
    """Feet that stand and limits of the spine may each suffice to keep a body off: neither is its reach."""
    standing = grounded_motion_of(AdaptRequest(WALK, BODIES["tall_man"], STANDS))
    free = SolverLimits(uses_contacts=False, uses_joint_limits=False)
    for seed in range(4):
        asked = scene(standing, solve_constraints(standing, ()), seed)
        found = blocking_constraints(standing, asked, {}, solve_constraints(standing, asked)) == BLOCKED_BY_REACH
        for row, constraint in enumerate(asked):
            alone = solve_constraints(standing, [constraint], bound=free).residuals[0]
            missed = alone[found[row]]
            assert np.count_nonzero(missed > MET_TOLERANCE_BY_UNIT[constraint.unit]) >= 0.9 * len(missed)


def test_a_sample_stands_for_frames_around_it_in_which_the_same_is_active_and_missed() -> None:
    random = np.random.default_rng(0)
    active = np.repeat(random.uniform(size=(3, 20)) < 0.7, 13, axis=1)
    residuals = np.where(active, np.repeat(random.uniform(size=(3, 52)), 5, axis=1), np.nan)
    limits = np.full((3, 1), 0.5)
    frames, stands_for = sampled_frames(np.concatenate([active, residuals > limits]), 8)
    assert (np.abs(frames[stands_for] - np.arange(260)) <= 8).all()
    assert (np.isfinite(residuals[:, frames[stands_for]]) == active).all()
    assert ((residuals > limits) == (residuals[:, frames[stands_for]] > limits)).all()


def test_a_motion_without_constraints_or_contacts_is_reported_too() -> None:
    request = AdaptRequest(WALK, BODIES["child"])
    report = report_of(grounded_motion_of(request), request, adapt(request, FIRST, LAST))
    assert report.winners.shape == (0, LAST - FIRST + 1)
    assert np.isnan(report.mass_margins).all()
