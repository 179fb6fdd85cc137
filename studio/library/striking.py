"""Strike: a motion made of a clip that a search found, blended in and driven to the target (P09 3.4).

The clip follows the current motion with the same transition as clips in a row. A constraint drives it to the target: it
fades in from the beginning of the clip on (for a leg, shortly before the hit), is fully active at the hit, and fades
out. The target may move until the hit.
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
from studio.library.searching import Result, length_in_words

STRIKE_CHAIN = Chain(limb=1.0, clavicle=1.0, trunk=0.6, root=0.4)
"""Segments that help a limb to reach the target: as in P09, the limb, then the trunk and the root."""
VISIBLE_RESIDUAL_METRES = 0.005
"""Residual in metres below which a miss is invisible."""
BLEND_IN_FRACTION = 0.6
"""Fraction of the time to the hit in which the clip blends in."""
LEG_DRIVE_SECONDS = 0.25
"""Seconds before and after its hit in which a leg is driven to its target; earlier, while it is lifted, it would
swerve.
"""
HIT_HALF_WIDTH_SECONDS = 1 / 120
"""Seconds at full activation before and after a hit: half a frame at 60 Hz, as a blow touches only for a moment."""


@dataclass(frozen=True, eq=False)
class StrikeClip:
    """Range of a motion that plays from frame ``start`` to ``last`` and hits at frame ``hit``, with the label of its
    clip.
    """

    motion: NormalizedMotion
    contacts: tuple[ContactInterval, ...]
    start: int
    hit: int
    last: int
    label: ClipLabel

    @classmethod
    def of(cls, found: Result) -> "StrikeClip":
        """Range of a motion that the search result ``found`` plays."""
        take, label = found.clip.take, found.clip.label
        return cls(take.motion, take.contacts, found.start, found.hit, label.last, label)

    @property
    def seconds(self) -> float:
        """Seconds from the start to the hit."""
        return (self.hit - self.start) / self.motion.frame_rate

    def piece(self, begins: float) -> MotionPiece:
        """Piece of motion that plays from ``begins`` seconds on; its blend ends before the hit."""
        ease = min(BLEND_IN_FRACTION * self.seconds, 1.0)
        return MotionPiece(self.motion, self.contacts, self.start, self.last, begins, ease=ease)


@dataclass(frozen=True, eq=False)
class Strike:
    """Motion with a strike in it: ``composite`` on ``body``, and the ``constraint`` that drives it to the target."""

    composite: Composite
    body: Morphology
    constraint: PositionConstraint
    change: int
    """Frame of the composite at which the strike begins."""
    hit: int
    """Frame of the composite in which the strike hits."""

    def request(self, target: Place | None = None) -> AdaptRequest:
        """Request to the solver; ``target``, if given, replaces the target of the constraint."""
        asked = self.constraint if target is None else replace(self.constraint, target=target)
        whole = self.composite
        return AdaptRequest(whole.motion, self.body, whole.contacts, (asked,))

    def adapted(self, target: Place | None = None) -> AdaptedMotion:
        """Solved motion of all frames; ``residuals[0, hit]`` is the residual at the hit. ``target``, if given, replaces
        the target of the constraint.
        """
        return adapt(self.request(target))


def make_strike(playing: MotionPiece, at_frame: int, blow: StrikeClip, body: Morphology, target: Place) -> Strike:
    """Strike in which ``blow`` follows the motion ``playing`` at frame ``at_frame`` and hits ``target``.

    ``target`` is in the space of the playing motion on ``body``; it may be keyed or follow something.
    """
    rate = playing.motion.frame_rate * float(speed_at(playing.speed, at_frame / playing.motion.frame_rate))
    before = replace(playing, last=at_frame)
    begin = before.end  # as a clip that is inserted at the playhead
    whole = _with_changes_of(before, compose_pieces((before, blow.piece(begin))), rate)
    return strike_from_change(whole, round((begin - whole.timing.begin) * whole.timing.frame_rate), blow, body, target)


def _with_changes_of(piece: MotionPiece, whole: Composite, rate: float) -> Composite:
    """Composite that begins with ``piece`` of a row, at ``rate`` frames per second, with the clip changes of that row.

    The body is then inertialised at these changes too.
    """
    scale = whole.timing.frame_rate / rate
    earlier = [
        replace(each, first=round((each.first - piece.first) * scale))
        for each in piece.motion.changes
        if piece.first < each.first <= piece.last
    ]
    return replace(whole, motion=replace(whole.motion, changes=(*earlier, *whole.motion.changes)))


def strike_from_change(composite: Composite, change: int, blow: StrikeClip, body: Morphology, target: Place) -> Strike:
    """Strike of ``composite``, which plays ``blow`` from frame ``change`` on, at ``target``, on ``body``."""
    hit = change + round(blow.seconds * composite.timing.frame_rate)
    return Strike(composite, body, _aim(composite, change, hit, blow.label, body, target), change, hit)


@dataclass(frozen=True, eq=False)
class TriedStrike:
    """Search result that has been solved, with the remaining residual ``missed`` in metres."""

    found: Result
    missed: float

    @property
    def hits(self) -> bool:
        """True if the residual is too small to be seen."""
        return self.missed < VISIBLE_RESIDUAL_METRES

    @property
    def reasons(self) -> tuple[str, ...]:
        """Reasons of the search result, and whether it hits after solving."""
        return (*self.found.reasons, "meets it" if self.hits else f"{length_in_words(self.missed)} short")


def tried_strikes(found: Sequence[Result], residual_of: Callable[[Result], float]) -> list[TriedStrike]:
    """Search results with their residuals: those that hit before those that miss, each group in the order of ``found``.

    ``residual_of`` solves a result and returns the residual at its hit in metres.
    """
    all_tried = [TriedStrike(each, residual_of(each)) for each in found]
    return sorted(all_tried, key=lambda each: not each.hits)


def aimed_constraint(found: Result, clip: Clip, target: Place, body: Morphology) -> PositionConstraint:
    """Constraint that drives the strike ``found``, played as ``clip``, to ``target``, in motion seconds."""
    label, rate = found.clip.label, found.clip.take.motion.frame_rate
    curve = _met_at(found.hit / rate, found.start / rate, label.last / rate, label.limb)
    point = hit_point(label.limb, label.segment, body)
    name = f"{label.limb.words.capitalize()} {label.kind}"
    return PositionConstraint(
        clip.motion_id, name, point, STRIKE_CHAIN, 0, curve, target=target, scope=Scope(clip_id=clip.id)
    )


def _aim(
    whole: Composite, change: int, hit: int, label: ClipLabel, body: Morphology, target: Place
) -> PositionConstraint:
    rate = whole.timing.frame_rate
    curve = _met_at(hit / rate, change / rate, (whole.motion.frame_count - 1) / rate, label.limb)
    point = hit_point(label.limb, label.segment, body)
    return PositionConstraint("", f"{label.kind} hits", point, STRIKE_CHAIN, 0, curve, target=target)


def _met_at(hit: float, start: float, end: float, limb: Limb) -> ActivationCurve:
    """Activation that is full at second ``hit``, with equal fades before and after, between ``start`` and ``end``
    seconds.

    If the strike begins too late for a fade, the activation is full at once.
    """
    led = hit - start if limb.is_arm else min(hit - start, LEG_DRIVE_SECONDS)
    begin, full_end = hit - led, hit + HIT_HALF_WIDTH_SECONDS
    gone = max(min(hit + led, end), full_end)
    return ActivationCurve(begin, max(begin, hit - HIT_HALF_WIDTH_SECONDS), full_end, gone, EaseShape.SMOOTH)
