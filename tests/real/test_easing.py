"""On real captures whatever is asked jolts no joint beyond three times the source and what wishes bring, nor moves a
foot that stands.
"""

import numpy as np
import pytest

from studio.core.body.canonical import BodyPart
from studio.core.constraints.base import BodyPoint, Chain, Constraint
from studio.core.constraints.follow import FollowTracked
from studio.core.constraints.position import PositionConstraint
from studio.core.grounds.ground import Ground
from studio.core.normalized.transition import QUIET_PEAK
from studio.core.quality.metrics import angular_acceleration, contact_quality
from studio.core.solver.adapt import body_point_positions, solve_constraints
from studio.core.solver.grounding.grounded_motion import GroundedMotion, ground_motion
from studio.core.solver.request import AdaptedMotion
from studio.core.solver.task_assembly.tracks import Track, Tracks
from studio.io.project.character_file import bundled_characters
from tests.captures import outside
from tests.core.motions import ALWAYS, local_rotations
from tests.real.taken import contacts_of, named, taken

BODIES = {name: character.morphology for name, character in bundled_characters().items()}
CAPTURED = (
    "accad_female1_B03_Walk1",
    "accad_male2_A6_BoxLift",
    "accad_male2_E1_JabLeft",
    "accad_female1_D3_ConversationGestures",
)
TRUNK, WHOLE = Chain(trunk=1.0), Chain(trunk=1.0, root=1.0)
WRISTS = BodyPart.LEFT_FOREARM, BodyPart.RIGHT_FOREARM
LEVER = 0.3
LONGEST = 600
"""Frames of a capture that are tried."""


def _sets(standing: GroundedMotion, before: AdaptedMotion) -> dict[str, tuple[tuple[Constraint, ...], Tracks]]:
    """Places that a body goes past, that are far out of reach, and that wander about its shoulders."""
    layout, frame, rate = before.morphology.layout, before.frame_count // 2, before.frame_rate
    forward, arm = before.rotations[frame, 0], before.morphology.arm[1].sum()
    points = [BodyPoint(part, at_end=True) for part in WRISTS]

    def wish(side: int, target: object, chain: Chain, priority: int) -> Constraint:
        return PositionConstraint("motion", f"{side}", points[side], chain, priority, ALWAYS, target=target)

    found: dict[str, tuple[tuple[Constraint, ...], Tracks]] = {}
    for name, chain in (("trunk", TRUNK), ("root", WHOLE)):
        near = [body_point_positions(point, before)[frame] + forward @ [0.1, 0.0, 0.2] for point in points]
        far = [
            before.positions[frame, layout.collar_point(side) + 1] + forward @ [1.6 * arm, 0.0, 0.0]
            for side in range(2)
        ]
        found[f"past, {name}"] = (wish(1, tuple(near[1]), chain, 0),), {}
        found[f"two past, {name}"] = tuple(wish(side, tuple(near[side]), chain, side) for side in range(2)), {}
        found[f"two far, {name}"] = tuple(wish(side, tuple(far[side]), chain, side) for side in range(2)), {}
        random, tracks, wishes = np.random.default_rng(3), {}, []
        times = np.arange(standing.motion.frame_count)[:, None] / rate
        for side in range(2):
            sway = sum(
                0.15
                * random.normal(size=3)
                * np.sin(2.0 * np.pi * (random.uniform(0.1, 0.5) * times + random.uniform()))
                for _ in range(3)
            )
            follow = FollowTracked(f"{side}")
            shoulder = standing.positions[:, layout.collar_point(side) + 1]
            tracks[follow] = Track(shoulder + arm * (sway + forward @ [0.5, 0.0, 0.0]), np.eye(3)[None])
            wishes.append(wish(side, follow, chain, side))
        found[f"wandering, {name}"] = tuple(wishes), tracks
    return found


def _brings(before: AdaptedMotion, wishes: tuple[Constraint, ...], tracks: Tracks) -> float:
    """The same sum as in tests/core/test_smooth.py, of wishes beside where the motion has their points."""
    total = 0.0
    for wish in wishes:
        target = wish.target
        goal = (
            tracks[target].positions[before.first_frame :][: before.frame_count]
            if isinstance(target, FollowTracked)
            else np.array(target)
        )
        way = goal - body_point_positions(wish.point, before)
        speed = np.linalg.norm(np.gradient(way, axis=0), axis=1) * before.frame_rate
        push = np.linalg.norm(np.gradient(np.gradient(way, axis=0), axis=0), axis=1) * before.frame_rate**2
        total += float(((push + speed**2 / LEVER) / LEVER).max())
    return total


def _peak(adapted: AdaptedMotion) -> float:
    arms = adapted.morphology.layout.spine_count + 10
    return float(angular_acceleration(local_rotations(adapted)[:, :arms], adapted.frame_rate).max())


@pytest.mark.parametrize("body", ["adult_woman", "child"])
@pytest.mark.parametrize("stem", ["walk", "box_lift", *outside(*CAPTURED)])
def test_no_joint_jolts_and_no_foot_slides(stem: str, body: str) -> None:
    capture, motion, _ = taken(named(stem))
    contacts = contacts_of(capture)
    standing: GroundedMotion = ground_motion(motion, BODIES[body], contacts, Ground())
    window = capture.first_frame, capture.first_frame + LONGEST - 1
    before, source = solve_constraints(standing, (), *window), _peak(solve_constraints(standing, ()))
    for name, (wishes, tracks) in _sets(standing, before).items():
        allowed = max(QUIET_PEAK, source) + _brings(before, wishes, tracks)
        eased = solve_constraints(standing, wishes, *window, tracks, eased=True)
        assert _peak(eased) < 3.0 * allowed, name
        assert contact_quality(eased, contacts, Ground()).slide < 2e-4, name


@pytest.mark.parametrize(
    ("stem", "body"),
    [
        ("crawl", "adult_woman"),
        ("crawl", "giant"),
        *outside(
            ("accad_female1_A11_CrawlForward", "adult_woman"),
            ("accad_female1_A11_CrawlForward", "giant"),
            ("accad_female1_D6_CartWheel", "adult_woman"),
            ("accad_female1_D6_CartWheel", "giant"),
        ),
    ],
)
def test_hands_and_knees_stand_no_worse_for_being_eased(stem: str, body: str) -> None:
    capture, motion, _ = taken(named(stem))
    contacts = contacts_of(capture)
    standing = ground_motion(motion, BODIES[body], contacts, Ground())
    before, head = solve_constraints(standing, ()), BodyPoint(BodyPart.HEAD, at_end=True)
    place = tuple(body_point_positions(head, before)[before.frame_count // 2] + [0.0, 0.3, 0.2])
    wrist = BodyPoint(WRISTS[0], at_end=True)
    wishes = tuple(
        PositionConstraint("motion", f"{priority}", point, WHOLE, priority, ALWAYS, target=place)
        for priority, point in enumerate((head, wrist))
    )
    plain, eased = (solve_constraints(standing, wishes, eased=each) for each in (False, True))
    slides = [contact_quality(each, contacts, Ground()).slide for each in (plain, eased)]
    assert slides[1] < slides[0] + 2e-4
