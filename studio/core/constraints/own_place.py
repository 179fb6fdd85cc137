"""Per-character positions: a point of the grounded body at one time, before constraints; and keys relative to it."""

import math
from dataclasses import dataclass, field, replace
from typing import ClassVar, Self

from studio.core.constraints.base import BodyPoint, Vector, finite_vector
from studio.core.curves.keyed import Line
from studio.core.plausible import TIME_RANGE


@dataclass(frozen=True)
class OwnPlace:
    """Position relative to ``point`` of the grounded body at ``time`` (motion seconds), before constraints.

    It differs between bodies: one with longer steps has it farther along. ``offset`` is in leg lengths of the body
    (thigh and shank), as its travel is; ``own`` are further offsets of single performers, by id.
    """

    kind: ClassVar[str] = "own_place"
    point: BodyPoint
    time: float
    offset: Vector = (0.0, 0.0, 0.0)
    own: tuple[tuple[str, Vector], ...] = ()

    def __post_init__(self) -> None:
        if not math.isfinite(self.time):
            raise ValueError(f"The time of a per-character target must be a finite number of seconds, not {self.time}.")
        TIME_RANGE.check(self.time)
        object.__setattr__(self, "offset", finite_vector(self.offset, "The offset of a per-character target"))
        own = tuple((str(key), finite_vector(each, f"The offset of '{key}'")) for key, each in self.own)
        object.__setattr__(self, "own", own)
        if len(dict(own)) < len(own):
            raise ValueError("A per-character target has two offsets for one character. Keep one of them.")

    def of(self, performer_id: str) -> Self:
        """Position for one performer: its own offset is added, and those of others are dropped."""
        if not self.own:
            return self
        own = dict(self.own).get(performer_id)
        return replace(self, offset=_sum(self.offset, own) if own else self.offset, own=())

    def with_own(self, performer_id: str, offset: Vector | None) -> Self:
        """Copy with ``offset`` as the own offset of a performer; None removes it."""
        rest = tuple((key, each) for key, each in self.own if key != performer_id)
        return replace(self, own=rest if offset is None else (*rest, (performer_id, offset)))

    def moved(self, performer_id: str, further: Vector) -> Self:
        """Copy moved by ``further``, in leg lengths: for that performer only if it has an own offset, else for all."""
        own = dict(self.own).get(performer_id)
        if own is None:
            return replace(self, offset=_sum(self.offset, further))
        return self.with_own(performer_id, _sum(own, further))

    def keyed(self, seconds: float) -> "KeyedOwnPlace":
        """Keyed copy with one key of zero at ``seconds``: every body keeps its own position."""
        return KeyedOwnPlace((seconds,), ((0.0, 0.0, 0.0),), origin=self)


@dataclass(frozen=True)
class KeyedOwnPlace(Line):
    """Keyed offsets (x, y, z) from the per-character position ``origin``, in leg lengths of the body."""

    kind: ClassVar[str] = "keyed_own_place"
    size: ClassVar[int] = 3
    times: tuple[float, ...]
    values: tuple[Vector, ...]
    origin: OwnPlace = field(kw_only=True)

    def own_at(self, seconds: float) -> OwnPlace:
        """Per-character position with the offset of the keys at ``seconds``."""
        return replace(self.origin, offset=_sum(self.origin.offset, self.value_at(seconds)))

    def moved_at(self, seconds: float, performer_id: str, further: Vector) -> Self:
        """Copy moved by ``further``, in leg lengths: by a key at ``seconds``, or by the own offset of a performer that
        has one.
        """
        if performer_id in dict(self.origin.own):
            return replace(self, origin=self.origin.moved(performer_id, further))
        return self.with_key(seconds, _sum(self.value_at(seconds), further))


def _sum(first: Vector, second: Vector) -> Vector:
    return first[0] + second[0], first[1] + second[1], first[2] + second[2]
