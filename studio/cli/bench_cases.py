"""Cases of ``bench``: whole clips on one character, each solved as in the studio.

The tasks are those for which the papers' authors report times. Their targets move with the body, each at a fixed offset
from its shoulder, so their distance beyond the limb's reach can be stated, and measured.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from studio.core.body.canonical import BodyPart
from studio.core.body.morphology import Morphology
from studio.core.captures.contacts import ContactInterval
from studio.core.constraints.balance import BalanceConstraint
from studio.core.constraints.base import BodyPoint, Chain, Constraint
from studio.core.constraints.follow import FollowTracked
from studio.core.constraints.position import PositionConstraint
from studio.core.curves.activation import ActivationCurve
from studio.core.grounds.ground import Ground
from studio.core.kernels import channel_columns as channel
from studio.core.normalized.motion import NormalizedMotion
from studio.core.rotations import normalized
from studio.core.solver.adapt import solve_constraints
from studio.core.solver.grounding.grounded_motion import GroundedMotion, ground_motion
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.core.solver.task_assembly.tracks import Track, Tracks
from studio.jobs.adaptation import ADAPTED_MOTION_ID, ReadyCapture

FloatArray = NDArray[np.float64]

MOST_BENCH_FRAMES = 1200
"""Maximum length in frames of the adapted clips."""
BEYOND_REACH_METRES = 0.1
"""Residual in metres of a target beyond the arm's reach, in every frame, when the arm alone is solved."""
NEAR_TARGET_ARM_LENGTHS = 0.8
"""Distance from the shoulder of a reachable target, in arm lengths."""
FAR_TARGET_ARM_LENGTHS = 2.0
"""Distance from the shoulder of a target that is out of reach even without joint limits, in arm lengths."""
ELBOW_OFFSET_METRES = 0.15
"""Distance in metres of the elbow's target from the elbow's position while its wrist is held."""

WHOLE_CASE_ACTIVATION = ActivationCurve(-1.0, -1.0, 1e6, 1e6)
LIMB_CHAIN, LIMB_AND_TRUNK_CHAIN, WHOLE_BODY_CHAIN = Chain(clavicle=0.0), Chain(trunk=1.0), Chain(trunk=1.0, root=1.0)
ROOT_CHAIN = Chain(0.0, 0.0, 0.0, 0.0, 1.0)
BENCH_FOREARMS = BodyPart.LEFT_FOREARM, BodyPart.RIGHT_FOREARM
BENCH_UPPER_ARMS = BodyPart.LEFT_UPPER_ARM, BodyPart.RIGHT_UPPER_ARM


@dataclass(frozen=True, eq=False)
class BenchCase:
    """Row of the table: name, request, microseconds per frame that the paper took, and our aim.

    ``reachable`` is True if the constraint of highest priority can be met in most frames.
    """

    name: str
    request: AdaptRequest
    paper: float | None = None
    aim: float | None = None
    reachable: bool = True

    @property
    def highest(self) -> Constraint:
        """Position constraint of the highest priority."""
        places = [each for each in self.request.constraints if isinstance(each, PositionConstraint)]
        return min(places, key=lambda each: each.priority)


def make_tasks(
    motion: NormalizedMotion, contacts: tuple[ContactInterval, ...], body: Morphology
) -> tuple[BenchCase, ...]:
    """Rows of the table for one clip and one body, from the easiest to the hardest."""
    right, left = 1, 0
    standing = ground_motion(motion, body, contacts, Ground())
    near, beyond = (
        positions_before_shoulder(standing, right, NEAR_TARGET_ARM_LENGTHS),
        positions_beyond_arm(standing, right),
    )
    far = [positions_before_shoulder(standing, side, FAR_TARGET_ARM_LENGTHS) for side in (left, right)]
    tracks = {
        _follow("near"): near,
        _follow("beyond"): beyond,
        _follow("left"): far[left],
        _follow("right"): far[right],
    }
    followed: Tracks = {follow: _track(places) for follow, places in tracks.items()}
    bare = AdaptRequest(motion, body, tracks=followed, eased=True)
    held = replace(bare, contacts=contacts)
    balance = BalanceConstraint(
        ADAPTED_MOTION_ID, "Balance", BodyPoint(BodyPart.PELVIS), ROOT_CHAIN, 0, WHOLE_CASE_ACTIVATION
    )
    reachable, strict = (
        wrist_constraint(right, "near", LIMB_CHAIN),
        wrist_constraint(right, "near", LIMB_AND_TRUNK_CHAIN),
    )
    elbow, aside = elbow_constraint_aside(solve_constraints(standing, (strict,), tracks=bare.tracks), right)
    return (
        BenchCase("+ one reachable limb", replace(bare, constraints=(reachable,)), 34.0, 2.0),
        BenchCase("the same, feet held", replace(held, constraints=(reachable,)), 34.0),
        BenchCase(
            "+ arm, clavicle and trunk, 10 cm beyond reach, feet held, balance",
            replace(held, constraints=(balance, wrist_constraint(right, "beyond", LIMB_AND_TRUNK_CHAIN, 1))),
            40.0,
            8.0,
        ),
        BenchCase(
            "wrist strictly before elbow, same arm",
            replace(held, constraints=(strict, elbow), tracks={**bare.tracks, _follow("aside"): aside}),
            None,
            6.0,
        ),
        BenchCase(
            "worst: two unreachable wrists, planted feet, balance",
            replace(
                held,
                constraints=(
                    balance,
                    wrist_constraint(left, "left", WHOLE_BODY_CHAIN, 1),
                    wrist_constraint(right, "right", WHOLE_BODY_CHAIN, 1),
                ),
            ),
            115.0,
            15.0,
            reachable=False,
        ),
    )


def clip_of(
    ready: ReadyCapture, longest: int = MOST_BENCH_FRAMES
) -> tuple[NormalizedMotion, tuple[ContactInterval, ...]]:
    """Motion of a capture from its first frame on, at most ``longest`` frames, with its contacts."""
    first = ready.capture.first_frame
    motion = ready.motion
    channels = motion.channels[first : first + longest]
    contacts = tuple(
        replace(each, first=max(each.first - first, 0), last=min(each.last - first, len(channels) - 1))
        for each in ready.contacts
        if first <= each.last and each.first - first < len(channels)
    )
    return NormalizedMotion(motion.name, motion.frame_rate, channels, motion.spine_places, motion.girdle), contacts


def wrist_constraint(side: int, target: str, chain: Chain, priority: int = 0) -> PositionConstraint:
    """Position constraint of a wrist at the followed target ``target``, active all the time."""
    return _position(BENCH_FOREARMS[side], target, chain, priority)


def positions_before_shoulder(standing: GroundedMotion, side: int, reach: float) -> FloatArray:
    """Positions (F, 3) ``reach`` arm lengths in front of a shoulder, a little outward and below."""
    length = float(standing.morphology.first_frame_body.arm[side].sum())
    return np.asarray(_shoulder(standing, side) + reach * length * _directions(standing, side))


def positions_beyond_arm(standing: GroundedMotion, side: int) -> FloatArray:
    """Positions (F, 3) that the arm alone misses by ``BEYOND_REACH_METRES``."""
    far = positions_before_shoulder(standing, side, FAR_TARGET_ARM_LENGTHS)
    missed = solve_constraints(
        standing, (wrist_constraint(side, "far", LIMB_CHAIN),), tracks={_follow("far"): _track(far)}
    ).residuals[0]
    return np.asarray(far - (missed - BEYOND_REACH_METRES)[:, None] * _directions(standing, side))


def elbow_constraint_aside(solved: AdaptedMotion, side: int) -> tuple[PositionConstraint, Track]:
    """Position constraint of the elbow with lower priority, and its target track.

    The target is ``ELBOW_OFFSET_METRES`` farther from the line from shoulder to wrist.
    """
    layout = solved.morphology.layout
    shoulder, elbow, end = (solved.positions[:, layout.collar_point(side) + k] for k in (1, 2, 3))
    axis = normalized(end - shoulder)
    out = elbow - shoulder
    out = normalized(out - np.sum(out * axis, axis=1, keepdims=True) * axis)
    return _position(BENCH_UPPER_ARMS[side], "aside", LIMB_AND_TRUNK_CHAIN, 1), _track(
        elbow + ELBOW_OFFSET_METRES * out
    )


def _shoulder(standing: GroundedMotion, side: int) -> FloatArray:
    return standing.positions[:, standing.morphology.layout.collar_point(side) + 1]


def _directions(standing: GroundedMotion, side: int) -> FloatArray:
    """Unit directions (F, 3) forwards, a little outwards and down."""
    yaw = standing.motion.channels[:, channel.YAW]
    forward, out = 0.9, 0.3 - 0.6 * side
    x, y = forward * np.cos(yaw) - out * np.sin(yaw), forward * np.sin(yaw) + out * np.cos(yaw)
    return normalized(np.stack([x, y, np.full(len(yaw), -0.2)], axis=1))


def _follow(target: str) -> FollowTracked:
    return FollowTracked(target)


def _track(positions: FloatArray) -> Track:
    return Track(positions, np.eye(3)[None])


def _position(part: BodyPart, target: str, chain: Chain, priority: int) -> PositionConstraint:
    point = BodyPoint(part, at_end=True)
    return PositionConstraint(
        ADAPTED_MOTION_ID, part.label, point, chain, priority, WHOLE_CASE_ACTIVATION, target=_follow(target)
    )


def target_positions(task: BenchCase, constraint: PositionConstraint) -> FloatArray:
    """Target positions (F, 3) of a task's position constraint."""
    if not isinstance(constraint.target, FollowTracked):
        raise TypeError(f"'{constraint.name}' is not a target of a task.")
    track = task.request.tracks[constraint.target]
    assert isinstance(track, Track)
    return track.positions
