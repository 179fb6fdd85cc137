"""Strike made of a clip that was found: placed and blended in, put on the performer, driven to the target (P09 3.4).

The clip takes over from the current motion by the transition of all clips in a row. A constraint drives it to the
target: it fades in from the change on (for a leg, shortly before the hit), is fully active at the hit, and fades out.
The target may move until the hit.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from studio.core.body.morphology import Morphology
from studio.core.captures.contacts import ContactInterval
from studio.core.constraints.base import Chain
from studio.core.constraints.position import PositionConstraint
from studio.core.constraints.scope import Scope
from studio.core.constraints.target import Place
from studio.core.curves.activation import ActivationCurve, EaseShape
from studio.core.curves.retiming import speed_at
from studio.core.normalized.compose import Composite, compose_pieces
from studio.core.normalized.motion import NormalizedMotion
from studio.core.normalized.pieces import MotionPiece
from studio.core.solver.adapt import adapt
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.core.stage.clip import Clip
from studio.library.clip_labels import ClipLabel, Limb, hit_point
from studio.library.searching import Result, metres

CHAIN = Chain(limb=1.0, clavicle=1.0, trunk=0.6, root=0.4)
"""Segments that may help a limb to reach: P09 goes on from the limb to the trunk and the root."""
VISIBLE_MISS = 0.005
"""Residual in metres below which a miss is invisible."""
EASED_IN = 0.6
"""Fraction of the time to the hit in which the clip blends in."""
SWUNG = 0.25
"""Seconds before and after its hit in which a leg is driven to a target: driven while it is lifted, it goes astray."""
HIT_HALF_WIDTH = 1 / 120
"""Seconds to each side of a hit at full activation: a frame of 60 Hz, as a blow touches and goes on."""


@dataclass(frozen=True, eq=False)
class StrikeClip:
    """Stretch of a motion that plays from frame ``start`` and hits at frame ``hit``, with the label of its clip."""

    motion: NormalizedMotion
    contacts: tuple[ContactInterval, ...]
    start: int
    hit: int
    last: int
    label: ClipLabel

    @classmethod
    def of(cls, found: Result) -> "StrikeClip":
        """Blow of a search result."""
        take, label = found.clip.take, found.clip.label
        return cls(take.motion, take.contacts, found.start, found.hit, label.last, label)

    @property
    def seconds(self) -> float:
        """Seconds from its start to its hit."""
        return (self.hit - self.start) / self.motion.frame_rate

    def piece(self, begins: float) -> MotionPiece:
        """Piece of motion that plays from ``begins`` seconds on; its blend ends before the hit."""
        ease = min(EASED_IN * self.seconds, 1.0)
        return MotionPiece(self.motion, self.contacts, self.start, self.last, begins, ease=ease)


@dataclass(frozen=True, eq=False)
class Strike:
    """Motion with a blow in it: ``composite`` on ``body``, with the ``constraint`` that makes it hit."""

    composite: Composite
    body: Morphology
    constraint: PositionConstraint
    change: int
    """Frame of the composite from which on the blow plays."""
    hit: int
    """Frame of the composite in which it hits."""

    def request(self, target: Place | None = None) -> AdaptRequest:
        """Request to the solver, with ``target`` in place of the constraint's own if it is given."""
        asked = self.constraint if target is None else replace(self.constraint, target=target)
        whole = self.composite
        return AdaptRequest(whole.motion, self.body, whole.contacts, (asked,))

    def adapted(self, target: Place | None = None) -> AdaptedMotion:
        """All frames solved; ``residuals[0, hit]`` is the residual at the hit."""
        return adapt(self.request(target))


def make_strike(playing: MotionPiece, at_frame: int, blow: StrikeClip, body: Morphology, target: Place) -> Strike:
    """Strike in which ``blow`` takes over from ``playing`` at its frame ``at_frame``, and hits ``target``.

    ``target`` lies in the space of the motion that plays, on ``body``; it may be keyed or follow something.
    """
    rate = playing.motion.frame_rate * float(speed_at(playing.speed, at_frame / playing.motion.frame_rate))
    before = replace(playing, last=at_frame)
    begin = before.end  # as a clip that is inserted at the playhead
    whole = _with_changes_of(before, compose_pieces((before, blow.piece(begin))), rate)
    return strike_in(whole, round((begin - whole.timing.begin) * whole.timing.frame_rate), blow, body, target)


def _with_changes_of(piece: MotionPiece, whole: Composite, rate: float) -> Composite:
    """Composite that begins with a ``piece`` of a row, which plays ``rate`` frames a second, with that row's changes of
    clips, so that the body is inertialised there too.
    """
    scale = whole.timing.frame_rate / rate
    earlier = [
        replace(each, first=round((each.first - piece.first) * scale))
        for each in piece.motion.changes
        if piece.first < each.first <= piece.last
    ]
    return replace(whole, motion=replace(whole.motion, changes=(*earlier, *whole.motion.changes)))


def strike_in(composite: Composite, change: int, blow: StrikeClip, body: Morphology, target: Place) -> Strike:
    """Strike of a ``composite`` that plays ``blow`` from its frame ``change`` on, on ``body``."""
    hit = change + round(blow.seconds * composite.timing.frame_rate)
    return Strike(composite, body, _aim(composite, change, hit, blow.label, body, target), change, hit)


@dataclass(frozen=True, eq=False)
class TriedStrike:
    """Search result with the residual ``missed`` in metres that was left when it was solved."""

    found: Result
    missed: float

    @property
    def hits(self) -> bool:
        """True if the residual is too small to be seen."""
        return self.missed < VISIBLE_MISS

    @property
    def reasons(self) -> tuple[str, ...]:
        """Reasons of the search result, and whether it hits after solving."""
        return (*self.found.reasons, "meets it" if self.hits else f"{metres(self.missed)} short")


def tried_strikes(found: Sequence[Result], residual_of: Callable[[Result], float]) -> list[TriedStrike]:
    """Search results, solved by ``residual_of``, which returns the residual at the hit in metres: those that hit before
    those that do not, each in the order of ``found``.
    """
    all_tried = [TriedStrike(each, residual_of(each)) for each in found]
    return sorted(all_tried, key=lambda each: not each.hits)


def aimed_constraint(found: Result, clip: Clip, target: Place, body: Morphology) -> PositionConstraint:
    """Constraint that drives a clip to a target, in seconds of the clip's motion."""
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
    """Activation that is full around the hit, with equal fades before and after it, between start and end (s).

    It is full at once if the blow begins that late.
    """
    led = hit - start if limb.is_arm else min(hit - start, SWUNG)
    begin, full_end = hit - led, hit + HIT_HALF_WIDTH
    gone = max(min(hit + led, end), full_end)
    return ActivationCurve(begin, max(begin, hit - HIT_HALF_WIDTH), full_end, gone, EaseShape.SMOOTH)
