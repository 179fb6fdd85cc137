"""A clip that was found, made to hit: placed and blended in, put on the performer, driven to the target (P09 3.4).

The clip takes over from what plays by the transition of all clips in a row. A constraint asks for the target: it eases
in from the change on, with a leg from when that swings, is all there at the hit, and goes again. The target may move on
until the hit.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from studio.core.body.morphology import Morphology
from studio.core.captures.contacts import ContactInterval
from studio.core.constraints.activation import ActivationCurve, EaseShape
from studio.core.constraints.base import Chain
from studio.core.constraints.position import PositionConstraint
from studio.core.constraints.target import Place
from studio.core.normalized.compose import Composite, compose
from studio.core.normalized.motion import NormalizedMotion
from studio.core.normalized.pieces import MotionPiece
from studio.core.solver.adapt import adapt, place_of
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.core.stage.clip import Clip
from studio.core.stage.scope import Scope
from studio.library.clips import ClipLabel, Limb, hit_point
from studio.library.searching import Result, StrikeQuery, metres

CHAIN = Chain(limb=1.0, clavicle=1.0, trunk=0.6, root=0.4)
"""What of the body may help a limb to reach: P09 goes on from the limb to the trunk and the root."""
VISIBLE_MISS = 0.005
"""Metres of a miss that nobody sees."""
POSE_HOLD_SECONDS = 0.5
"""Seconds for which a pose is held to try what takes over from it."""
EASED_IN = 0.6
"""Part of the time to the hit in which the clip takes over from what played."""
SWUNG = 0.25
"""Seconds before and after its hit in which a leg is led to a target: one that is led as it is lifted goes astray."""
HIT_HALF_WIDTH = 1 / 120
"""Seconds to each side of a hit for which the target is met whole: a frame of 60 Hz, as a blow touches and goes on."""


@dataclass(frozen=True, eq=False)
class Blow:
    """A stretch of a motion that hits at frame ``hit`` of it, played from ``start`` on; what it was found as."""

    motion: NormalizedMotion
    contacts: tuple[ContactInterval, ...]
    start: int
    hit: int
    last: int
    label: ClipLabel

    @classmethod
    def of(cls, found: Result) -> "Blow":
        """A clip as it was found."""
        take, label = found.clip.take, found.clip.label
        return cls(take.motion, take.contacts, found.start, found.hit, label.last, label)

    @property
    def seconds(self) -> float:
        """From its start to its hit."""
        return (self.hit - self.start) / self.motion.frame_rate

    def piece(self, begins: float) -> MotionPiece:
        """What of it plays from ``begins`` seconds on; it has taken over some time before it hits."""
        ease = min(EASED_IN * self.seconds, 1.0)
        return MotionPiece(self.motion, self.contacts, self.start, self.last, begins, ease=ease)


@dataclass(frozen=True, eq=False)
class Strike:
    """What plays, with a blow behind it: ``composite`` on ``body`` with the ``constraint`` that makes it hit."""

    composite: Composite
    body: Morphology
    constraint: PositionConstraint
    change: int
    """The frame of the composite from which on the blow plays."""
    hit: int
    """The frame in which it hits."""

    def request(self, target: Place | None = None) -> AdaptRequest:
        """What the solver is asked, with the ``target`` where it is now in the place of the first one."""
        asked = self.constraint if target is None else replace(self.constraint, target=target)
        whole = self.composite
        return AdaptRequest(whole.motion, self.body, whole.contacts, (asked,))

    def adapted(self, target: Place | None = None) -> AdaptedMotion:
        """All frames solved; ``residuals[0, hit]`` is by how much the target is missed."""
        return adapt(self.request(target))


def make_strike(playing: MotionPiece, at_frame: int, blow: Blow, body: Morphology, target: Place) -> Strike:
    """Let ``blow`` take over from ``playing`` at its frame ``at_frame``, and hit ``target``.

    ``target`` lies in the space of the motion that plays, on ``body``; it may be keyed or follow something.
    """
    rate = playing.motion.frame_rate * playing.speed
    before = replace(playing, last=at_frame)
    begin = before.end + 1.0 / rate
    whole = compose((before, blow.piece(begin)))
    return strike_in(whole, round((begin - whole.timing.begin) * whole.timing.frame_rate), blow, body, target)


def strike_in(composite: Composite, change: int, blow: Blow, body: Morphology, target: Place) -> Strike:
    """The strike that a ``composite`` is which plays ``blow`` from its frame ``change`` on, on ``body``."""
    hit = change + round(blow.seconds * composite.timing.frame_rate)
    return Strike(composite, body, _aim(composite, change, hit, blow.label, body, target), change, hit)


@dataclass(frozen=True, eq=False)
class Tried:
    """A clip that was found, and by how many metres it ``missed`` when it was tried."""

    found: Result
    missed: float

    @property
    def hits(self) -> bool:
        """Whether the target is met as well as anybody sees."""
        return self.missed < VISIBLE_MISS

    @property
    def reasons(self) -> tuple[str, ...]:
        """As those of the result, and whether it hits in the end."""
        return (*self.found.reasons, "reached" if self.hits else f"{metres(self.missed)} short")


def tried(found: Sequence[Result], asked: StrikeQuery) -> list[Tried]:
    """What hits before what does not, each in the order of ``found``."""
    all_tried = [Tried(each, missed_by(each, asked)) for each in found]
    return sorted(all_tried, key=lambda each: not each.hits)


def missed_by(found: Result, asked: StrikeQuery) -> float:
    """Metres by which the hit misses the place although all is done to meet it, from the pose that was asked on: with
    what stands there, and smoothed.
    """
    pose, place = asked.pose, np.asarray(asked.place, dtype=np.float64)
    held = replace(pose, channels=np.repeat(pose.channels, round(POSE_HOLD_SECONDS * pose.frame_rate), axis=0))
    x, y, z = place.tolist()
    last = held.frame_count - 1
    stands = tuple(ContactInterval("", point, 0, last) for point in asked.contacts)
    made = make_strike(MotionPiece(held, stands, 0, last), last, Blow.of(found), asked.body, (x, y, z))
    adapted = adapt(replace(made.request(), eased=True), made.hit, made.hit)
    return float(np.linalg.norm(place_of(made.constraint.point, adapted)[0] - place))


def aimed(found: Result, clip: Clip, target: Place, body: Morphology) -> PositionConstraint:
    """What drives a clip to a target, in seconds of its motion."""
    label, rate = found.clip.label, found.clip.take.motion.frame_rate
    curve = _met_at(found.hit / rate, found.start / rate, label.last / rate, label.limb)
    point = hit_point(label.limb, label.segment, body)
    name = f"{label.limb.words.capitalize()} {label.kind}"
    return PositionConstraint(clip.motion_id, name, point, CHAIN, 0, curve, target=target, scope=Scope(clip_id=clip.id))


def _aim(
    whole: Composite, change: int, hit: int, label: ClipLabel, body: Morphology, target: Place
) -> PositionConstraint:
    rate = whole.timing.frame_rate
    curve = _met_at(hit / rate, change / rate, (whole.motion.frame_count - 1) / rate, label.limb)
    point = hit_point(label.limb, label.segment, body)
    return PositionConstraint("", f"{label.kind} hits", point, CHAIN, 0, curve, target=target)


def _met_at(hit: float, start: float, end: float, limb: Limb) -> ActivationCurve:
    """All of it round the hit, as long before as after, between start and end, in seconds.

    At once where a blow is begun that late.
    """
    led = hit - start if limb.is_arm else min(hit - start, SWUNG)
    begin, full_end = hit - led, hit + HIT_HALF_WIDTH
    gone = max(min(hit + led, end), full_end)
    return ActivationCurve(begin, max(begin, hit - HIT_HALF_WIDTH), full_end, gone, EaseShape.SMOOTH)
