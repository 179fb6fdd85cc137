"""What ``bench`` measures: whole clips on one character, each as the studio does it.

The tasks are those by which the papers' authors tell their times. Each is a list of wishes that stand still in front
of a body that stays in place, so that how far they lie beyond its reach can be measured, and is.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from studio.cli.adaptation import MOTION_ID, ReadyCapture
from studio.core.canonical import BodyPart
from studio.core.constraints.activation import ActivationCurve
from studio.core.constraints.balance import BalanceConstraint
from studio.core.constraints.base import BodyPoint, Chain, Constraint
from studio.core.constraints.position import PositionConstraint
from studio.core.contacts import ContactInterval
from studio.core.ground import Ground
from studio.core.kernels import layout as at
from studio.core.morphology import Morphology
from studio.core.normalized.motion import NormalizedMotion
from studio.core.solver.adapt import Standing, hold, stand
from studio.core.solver.request import AdaptRequest

FloatArray = NDArray[np.float64]

FRAMES = 1200
"""Length of the clips that are adapted."""
BEYOND = 0.1
"""Metres by which the second task lies beyond the arm's reach: the median over the clip, solved with the arm alone."""
FAR = 2.0
"""Arm lengths from the shoulder: out of reach with every limit of the joints lifted, too."""
ASIDE = 0.15
"""Metres between where an elbow may be once its wrist is held and where it is wanted."""

ALWAYS = ActivationCurve(-1.0, -1.0, 1e6, 1e6)
LIMB, WITH_TRUNK, WHOLE = Chain(clavicle=0.0), Chain(trunk=1.0), Chain(trunk=1.0, root=1.0)
ROOT = Chain(0.0, 0.0, 0.0, 0.0, 1.0)
FOREARMS = BodyPart.LEFT_FOREARM, BodyPart.RIGHT_FOREARM
UPPER_ARMS = BodyPart.LEFT_UPPER_ARM, BodyPart.RIGHT_UPPER_ARM


@dataclass(frozen=True, eq=False)
class Task:
    """One row of the table: what is asked, microseconds a frame that the paper took, and our aim.

    ``reachable`` says whether the highest wish can be had in most frames.
    """

    name: str
    request: AdaptRequest
    paper: float | None = None
    aim: float | None = None
    reachable: bool = True

    @property
    def highest(self) -> Constraint:
        """The wish for a place that the others yield to."""
        places = [each for each in self.request.constraints if isinstance(each, PositionConstraint)]
        return min(places, key=lambda each: each.priority)


def make_tasks(motion: NormalizedMotion, contacts: tuple[ContactInterval, ...], body: Morphology) -> tuple[Task, ...]:
    """The issue of the papers' tables on one clip and one body, from the easiest to the worst."""
    right, left = 1, 0
    standing = stand(motion, body, contacts, Ground())
    bare = AdaptRequest(motion, body)
    held = AdaptRequest(motion, body, contacts)
    balance = BalanceConstraint(MOTION_ID, "Balance", BodyPoint(BodyPart.PELVIS), ROOT, 0, ALWAYS)
    near = wrist(right, before_shoulder(standing, right, 0.8), LIMB)
    strict = wrist(right, before_shoulder(standing, right, 0.8), WITH_TRUNK)
    beyond = wrist(right, beyond_arm(standing, right), WITH_TRUNK, 1)
    far = tuple(wrist(side, before_shoulder(standing, side, FAR), WHOLE, 1) for side in (left, right))
    return (
        Task("+ one reachable limb", replace(bare, constraints=(near,)), 34.0, 2.0),
        Task("the same, feet held", replace(held, constraints=(near,)), 34.0),
        Task(
            "+ arm, clavicle and trunk, 10 cm beyond reach, feet held, balance",
            replace(held, constraints=(balance, beyond)),
            40.0,
            8.0,
        ),
        Task(
            "wrist strictly before elbow, same arm",
            replace(held, constraints=(strict, elbow_aside(standing, right, strict))),
            None,
            6.0,
        ),
        Task(
            "worst: two unreachable wrists, planted feet, balance",
            replace(held, constraints=(balance, *far)),
            115.0,
            15.0,
            reachable=False,
        ),
    )


def clip_of(ready: ReadyCapture, longest: int = FRAMES) -> tuple[NormalizedMotion, tuple[ContactInterval, ...]]:
    """A capture from where its motion begins, ``longest`` frames at most, with its contacts."""
    first = ready.capture.first_frame
    motion = ready.motion
    channels = motion.channels[first : first + longest]
    contacts = tuple(
        replace(each, first=max(each.first - first, 0), last=min(each.last - first, len(channels) - 1))
        for each in ready.contacts
        if first <= each.last and each.first - first < len(channels)
    )
    return NormalizedMotion(motion.name, motion.frame_rate, channels, motion.spine_places), contacts


def wrist(side: int, place: FloatArray, chain: Chain, priority: int = 0) -> PositionConstraint:
    """A wrist that is to be at ``place`` (3,) all the time."""
    return _position(FOREARMS[side], place, chain, priority)


def before_shoulder(standing: Standing, side: int, reach: float) -> FloatArray:
    """(3,) ``reach`` arm lengths before, and a little outside and below, the middle of where a shoulder is."""
    body = standing.morphology
    shoulder = np.median(standing.positions[:, body.layout.collar(side) + 1], axis=0)
    yaw = np.median(standing.motion.channels[:, at.YAW])
    forward, leftward = np.array([np.cos(yaw), np.sin(yaw), 0.0]), np.array([-np.sin(yaw), np.cos(yaw), 0.0])
    way = 0.9 * forward + (0.3 - 0.6 * side) * leftward - np.array([0.0, 0.0, 0.2])
    return np.asarray(shoulder + reach * body.arm[side].sum() * way / np.linalg.norm(way))


def beyond_arm(standing: Standing, side: int) -> FloatArray:
    """(3,) a place that the arm alone misses by ``BEYOND``, as solved: the median over the clip."""
    reach, length = 1.1, float(standing.morphology.arm[side].sum())
    for _ in range(4):
        alone = hold(standing, (wrist(side, before_shoulder(standing, side, reach), LIMB),))
        reach += (BEYOND - float(np.median(alone.residuals[0]))) / length
    return before_shoulder(standing, side, reach)


def elbow_aside(standing: Standing, side: int, held: Constraint) -> PositionConstraint:
    """An elbow of lower priority, wanted ``ASIDE`` further from the line shoulder-wrist than it can be."""
    layout = standing.morphology.layout
    solved = hold(standing, (held,)).positions
    shoulder, elbow, end = (np.median(solved[:, layout.collar(side) + k], axis=0) for k in (1, 2, 3))
    axis = (end - shoulder) / np.linalg.norm(end - shoulder)
    out = elbow - shoulder - (elbow - shoulder) @ axis * axis
    place = elbow + ASIDE * out / np.linalg.norm(out)
    return _position(UPPER_ARMS[side], place, held.chain, held.priority + 1)


def _position(part: BodyPart, place: FloatArray, chain: Chain, priority: int) -> PositionConstraint:
    target = (float(place[0]), float(place[1]), float(place[2]))
    point = BodyPoint(part, at_end=True)
    return PositionConstraint(MOTION_ID, part.label, point, chain, priority, ALWAYS, target=target)
