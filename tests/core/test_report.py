"""A report says by how much each constraint is missed in every frame, and who kept it from being met."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.scenes import scene
from studio.core.body.canonical import BodyPart
from studio.core.body.morphology import Morphology
from studio.core.captures.contacts import ContactInterval, ContactPoint, Touch
from studio.core.constraints.balance import BalanceConstraint
from studio.core.constraints.base import BodyPoint, Chain, Constraint
from studio.core.constraints.orientation import OrientationConstraint
from studio.core.constraints.position import PositionConstraint
from studio.core.curves.activation import ActivationCurve
from studio.core.grounds.ground import Ground
from studio.core.quality.metrics import contact_quality
from studio.core.quality.report import (
    BLOCKED_BY_CLEARANCE,
    BLOCKED_BY_CONTACTS,
    BLOCKED_BY_LIMITS,
    BLOCKED_BY_NOTHING,
    BLOCKED_BY_REACH,
    BLOCKED_BY_SMOOTHING,
    MET_BY_UNIT,
    QualityReport,
    blocking_constraints,
    fully_active,
    report_of,
    sampled_frames,
)
from studio.core.solver.adapt import adapt, body_point_positions, solve_constraints
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.core.solver.solved_window import SolverLimits
from studio.core.solver.standing.stand import grounded_motion_of
from studio.io.project.character_file import bundled_characters
from tests.core.test_constraint_kinds import ALL, BODIES, LEFT, RIGHT, ask
from tests.core.test_targets import CONTACTS as STANDS
from tests.core.test_targets import WALK, every_body
from tests.core.test_touching import guard

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
    limits = [[MET_BY_UNIT[each.unit]] for each in request.constraints]
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
            assert np.count_nonzero(missed > MET_BY_UNIT[constraint.unit]) >= 0.9 * len(missed)


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
