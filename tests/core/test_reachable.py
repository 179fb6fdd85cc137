"""Reachable targets are met, and limbs do not leave their limits for others."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray

from studio.core.body.canonical import BodyPart
from studio.core.body.morphology import Morphology
from studio.core.constraints.base import BodyPoint, Chain, Constraint
from studio.core.constraints.follow import FollowTracked
from studio.core.constraints.position import PositionConstraint
from studio.core.curves.activation import ActivationCurve
from studio.core.grounds.ground import Ground
from studio.core.quality.metrics import contact_quality, point_heights
from studio.core.quality.report import BLOCKED_BY_GROUND, report_of
from studio.core.solver.adapt import body_point_positions, solve_constraints
from studio.core.solver.grounding.grounded_motion import GroundedMotion, ground_motion
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.core.solver.task_assembly.contact_release import constraint_activations, contact_release, ramped_target
from studio.core.solver.task_assembly.ground_limit import target_above_ground
from studio.core.solver.task_assembly.tracks import Track
from studio.io.project.character_file import bundled_characters
from tests.core.grounding import adapt_again
from tests.core.motions import target, walk
from tests.core.reachable import reachable_target

# A reachable target is met within 0.2 mm, on every character.


BODIES = {name: character.morphology for name, character in bundled_characters().items()}
WALK, CONTACTS = walk()
FRAME = 30
MET = 2e-4

LIMB, ARM, BACK, ALL = Chain(clavicle=0.0), Chain(), Chain(trunk=1.0), Chain(trunk=1.0, root=1.0)
CLAVICLE, HEAD = Chain(0.0, 0.0, 1.0, 0.0, 0.0), Chain(1.0, 1.0, 1.0, 1.0, 1.0)
CASES = [
    *(
        (BodyPart(f"{side}_{part}"), chain, ends)
        for side in ("left", "right")
        for part, chain, ends in (
            ("hand", LIMB, (False, True)), ("hand", ARM, (False, True)), ("hand", BACK, (False, True)),
            ("hand", ALL, (False, True)), ("forearm", LIMB, (False, True)), ("forearm", ARM, (True,)),
            ("forearm", BACK, (True,)), ("forearm", ALL, (True,)), ("upper_arm", LIMB, (True,)),
            ("upper_arm", ARM, (True,)), ("upper_arm", ALL, (True,)),
            ("clavicle", CLAVICLE, (True,)), ("clavicle", Chain(0.0, 0.0, 1.0, 1.0, 1.0), (True,)),
            ("thigh", LIMB, (True,)), ("shank", LIMB, (False, True)), ("foot", LIMB, (False, True)),
            ("toe", LIMB, (False, True)),
        )
    ),
    (BodyPart.PELVIS, Chain(0.0, 0.0, 0.0, 0.0, 1.0), (False, True)),
    (BodyPart.ABDOMEN, Chain(0.0, 0.0, 0.0, 1.0, 1.0), (False, True)),
    (BodyPart.THORAX, Chain(0.0, 0.0, 0.0, 1.0, 1.0), (False, True)),
    (BodyPart.NECK, HEAD, (False, True)),
    (BodyPart.HEAD, HEAD, (False, True)),
]  # fmt: skip
"""Part, what may move for it, whether its point counts from the near end or the far one."""


def _name(value: object) -> str:
    if isinstance(value, Chain):
        weights = (value.limb, value.end_segment, value.clavicle, value.trunk, value.root)
        return "".join("LECTR"[k] if weight else "-" for k, weight in enumerate(weights))
    return str(value)


@pytest.mark.parametrize(("part", "chain", "ends"), CASES, ids=_name)
def test_it_is_met(part: BodyPart, chain: Chain, ends: tuple[bool, ...]) -> None:
    random = np.random.default_rng(1)
    for body in BODIES.values():
        free = not part.endswith(("thigh", "shank", "foot", "toe"))
        contacts = tuple(one for one in CONTACTS if free or one.point.side != (0 if part.startswith("left") else 1))
        before = adapt_again(AdaptRequest(WALK, body, contacts), FRAME, FRAME)
        for at_end in ends:
            for offset in ((0.0, 0.0, 0.0), (0.02, 0.03, -0.04)):
                for _ in range(4):
                    place = reachable_target(before, 0, BodyPoint(part, offset, at_end), chain, random)
                    asked = target(part, place, chain, offset=offset, at_end=at_end)
                    after = adapt_again(AdaptRequest(WALK, body, contacts, (asked,), limited=free), FRAME, FRAME)
                    assert after.residuals[0, 0] < MET
                    assert contact_quality(after, contacts, Ground()).penetration < 2e-3


@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
def test_both_hands_meet_their_targets_at_once(body: Morphology) -> None:
    random = np.random.default_rng(2)
    before = adapt_again(AdaptRequest(WALK, body, CONTACTS), FRAME, FRAME)
    for chain in (ARM, ALL):
        for _ in range(5):
            asked = tuple(
                target(part, reachable_target(before, 0, BodyPoint(part, at_end=True), chain, random), chain)
                for part in (BodyPart.LEFT_FOREARM, BodyPart.RIGHT_FOREARM)
            )
            after = adapt_again(AdaptRequest(WALK, body, CONTACTS, asked), FRAME, FRAME)
            assert after.residuals.max() < MET


@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
def test_a_hand_is_met_over_the_whole_clip(body: Morphology) -> None:
    """The body walks past its target: it is met in every frame in which the arm is long enough."""
    layout = body.layout
    before = adapt_again(AdaptRequest(WALK, body, CONTACTS))
    place = before.positions[60, layout.collar_point(1) + 1] + 0.75 * body.arm[1].sum() * np.array([0.6, -0.3, -0.74])
    near = np.linalg.norm(before.positions[:, layout.collar_point(1) + 1] - place, axis=1) < 0.95 * body.arm[1].sum()
    after = adapt_again(AdaptRequest(WALK, body, CONTACTS, (target("right_forearm", place, ARM),)))
    assert near.sum() > 20
    assert after.residuals[0, near].max() < MET


# A limb that its contact lets go is led to its place, from where it stands round its root, whatever is asked below.


SHORT_WALK, SHORT_CONTACTS = walk(120)
STANDING = ground_motion(SHORT_WALK, bundled_characters()["tall_man"].morphology, SHORT_CONTACTS, Ground())
BEFORE, EVERY_FRAME = solve_constraints(STANDING, ()), slice(0, SHORT_WALK.frame_count)
ANKLE = BodyPoint(BodyPart.LEFT_SHANK, at_end=True)
PLACE = body_point_positions(ANKLE, BEFORE)[60] + [0.1, 0.2, 0.3]
WANTED = target("left_shank", PLACE, Chain(), 0)
SHARES = contact_release((WANTED,), STANDING)[0]
LETS_GO = (SHARES > 0.0) & (SHARES < 1.0)


def test_it_begins_where_the_limb_stands_and_ends_at_the_target() -> None:
    begun, done = (
        ramped_target(WANTED, PLACE[None], np.full(SHORT_WALK.frame_count, s), STANDING, EVERY_FRAME)
        for s in (0.0, 1.0)
    )
    assert begun == pytest.approx(body_point_positions(ANKLE, BEFORE), abs=1e-12)
    assert np.array_equal(np.broadcast_to(done, begun.shape), np.broadcast_to(PLACE, begun.shape))


def test_on_its_way_it_is_as_far_from_the_root_as_lies_between_and_never_below_its_contact() -> None:
    hip = BEFORE.positions[:, BEFORE.morphology.layout.hip_point(0)]
    far = [np.linalg.norm(place - hip, axis=1) for place in (body_point_positions(ANKLE, BEFORE), PLACE)]
    led = ramped_target(WANTED, PLACE[None], SHARES, STANDING, EVERY_FRAME)
    over = led[:, 2] - body_point_positions(ANKLE, BEFORE)[:, 2]
    assert over[LETS_GO].min() > -1e-12
    round_root = LETS_GO & (over > 1e-9)
    assert round_root.any()
    between = (1.0 - SHARES) * far[0] + SHARES * far[1]
    assert np.linalg.norm(led - hip, axis=1)[round_root] == pytest.approx(between[round_root], abs=1e-9)


def test_it_is_met_on_its_way_whatever_moves_the_body_below() -> None:
    head = target(
        "head",
        body_point_positions(BodyPoint(BodyPart.HEAD, at_end=True), BEFORE)[60] - [0.2, 0.0, 0.2],
        Chain(trunk=1.0, root=1.0),
        1,
    )
    alone, both = (
        body_point_positions(ANKLE, solve_constraints(STANDING, asked)) for asked in ((WANTED,), (WANTED, head))
    )
    assert np.abs(alone - both)[LETS_GO].max() < 2e-4


def test_a_target_that_nobody_knows_while_it_is_not_asked_stops_nothing() -> None:
    follow = FollowTracked("thing")
    places = np.broadcast_to(PLACE, (SHORT_WALK.frame_count, 3)).copy()
    wanted = replace(WANTED, target=follow)
    places[constraint_activations((wanted,), STANDING)[0] == 0.0] = np.nan
    adapted = solve_constraints(STANDING, (wanted,), tracks={follow: Track(places, np.eye(3)[None])})
    assert np.isfinite(adapted.positions).all()


# The ground stands above constraints: limbs are not led into it, and targets below it are missed.


WHOLE_CHAIN = Chain(clavicle=1.0, trunk=0.4, root=0.5)
PULLED = tuple(
    BodyPart(f"{side}_{part}")
    for side in ("left", "right")
    for part in ("forearm", "hand", "upper_arm", "thigh", "shank", "foot")
)
DEEPEST = 0.005


@cache
def standing_on(body: str) -> GroundedMotion:
    return ground_motion(SHORT_WALK, bundled_characters()[body].morphology, SHORT_CONTACTS, Ground())


def depths(solved: AdaptedMotion, standing: GroundedMotion) -> NDArray[np.float64]:
    """(F, N) metres of each point below the ground, or below where it was without constraints."""
    before = point_heights(solve_constraints(standing, ()), standing.ground)
    return np.minimum(before, 0.0) - point_heights(solved, standing.ground)


@pytest.mark.parametrize("eased", [False, True])
@pytest.mark.parametrize("part", [BodyPart.LEFT_THIGH, BodyPart.RIGHT_SHANK, BodyPart.LEFT_FOREARM])
def test_a_limb_pulled_far_below_the_ground_stays_above_it(part: BodyPart, eased: bool) -> None:
    standing, frame = standing_on("giant"), 60
    now = frame / SHORT_WALK.frame_rate
    place = body_point_positions(BodyPoint(part, at_end=True), solve_constraints(standing, ()))[frame] + [
        0.2,
        0.1,
        -2.0,
    ]
    times = ActivationCurve(now - 0.5, now - 0.2, now + 0.2, now + 0.5)
    solved = solve_constraints(standing, (target(part, place, Chain(root=0.6), activation=times),), eased=eased)
    assert depths(solved, standing).max() < DEEPEST


@pytest.mark.parametrize("body", ["child", "tall_man", "giant"])
def test_a_target_below_the_ground_is_missed_by_what_it_is_below(body: str) -> None:
    standing = standing_on(body)
    point = BodyPoint(BodyPart.RIGHT_SHANK, at_end=True)
    path, asked = (
        body_point_positions(point, solve_constraints(standing, ())),
        target("right_shank", (0.0, 0.0, 0.0), Chain()),
    )
    frame = int(np.where(contact_release((asked,), standing)[0] == 1.0, path[:, 2], 0.0).argmax())
    place = path[frame] * [1.0, 1.0, 0.0] - [0.0, 0.0, 0.05]
    asked = replace(asked, target=tuple(place))
    solved = solve_constraints(standing, (asked,))
    assert depths(solved, standing)[frame].max() < DEEPEST
    left = np.linalg.norm(body_point_positions(point, solved)[frame] - raised_place(asked, standing))
    assert solved.residuals[0, frame] == pytest.approx(
        np.hypot(left, raised_place(asked, standing)[2] - place[2]), abs=1e-6
    )
    named = report_of(standing, request_of(standing, asked), solved).winners[0]
    assert named[frame] == BLOCKED_BY_GROUND


def test_an_elbow_leaves_the_ground_and_the_wrist_still_meets_its_target() -> None:
    standing = standing_on("giant")
    wrist = BodyPoint(BodyPart.RIGHT_FOREARM, at_end=True)
    elbow = standing.morphology.layout.wrist_point(1) - 1
    below = body_point_positions(wrist, solve_constraints(standing, ()))[60] * [1.0, 1.0, 0.0] + [0.0, 0.0, 0.04]
    pelvis = body_point_positions(BodyPoint(BodyPart.PELVIS), solve_constraints(standing, ()))[60]
    low = target("pelvis", pelvis * [1.0, 1.0, 0.0] + [0, 0, 0.3], Chain(limb=0.0, root=1.0), 0, at_end=False)
    solved = solve_constraints(standing, (low, target("right_forearm", below, Chain(), 1)))
    assert depths(solved, standing)[:, elbow].max() < DEEPEST
    missed = np.linalg.norm(body_point_positions(wrist, solved) - below, axis=1)
    assert missed == pytest.approx(solved.residuals[1], abs=DEEPEST)


def raised_place(asked: PositionConstraint, standing: GroundedMotion) -> NDArray[np.float64]:
    """Target (3,) on the ground, from where the point is highest."""
    raised = target_above_ground(asked, np.array([asked.target]), standing, slice(None))
    return raised[int(body_point_positions(asked.point, solve_constraints(standing, ()))[:, 2].argmax())]


def request_of(standing: GroundedMotion, *constraints: Constraint) -> AdaptRequest:
    return AdaptRequest(SHORT_WALK, standing.morphology, SHORT_CONTACTS, constraints, standing.ground)
