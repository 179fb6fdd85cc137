"""Props: objects on the stage that bodies hold, strike and stand beside."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import ClassVar

import numpy as np

from studio.core.constraints.base import BodyPoint, Vector, finite_vector
from studio.core.constraints.carried_over import MIRROR_TRANSFORM, Y_MIRROR_SIGNS, is_hinged
from studio.core.constraints.follow import UNTURNED
from studio.core.constraints.procedural import ProceduralPlace
from studio.core.curves.keyed import KeyedNumber, KeyedPlace, KeyedTurn, Quaternion, unit_quaternion
from studio.core.curves.tangents import LEFT_OUT_IF_DEFAULT
from studio.core.mesh.triangle_mesh import TriangleMesh
from studio.core.plausible import TIME_RANGE, TURN_RANGE


class PropShape(StrEnum):
    """Shape of a prop within its size; a stick lies along Z, and stairs rise along X."""

    BOX = "box"
    BALL = "ball"
    STICK = "stick"
    TABLE = "table"
    STAIRS = "stairs"
    MESH = "mesh"


X_MIRROR_SIGNS: Vector = (-1.0, 1.0, 1.0)
"""Signs of the axes of a prop in a mirror image of its holder, if the prop's x axis lies across the body."""
PICK_UP_SECONDS = 0.01
"""Seconds from the begin of a hold during which the prop still lies at its pick-up position."""


@dataclass(frozen=True, kw_only=True)
class Hold:
    """Hold of a prop from stage second ``begin`` to ``end``; None for no limit.

    The prop is picked up from its own position. It is put down at a later key of that position if there is one, else it
    stays where it is let go.
    """

    begin: float | None = None
    end: float | None = None

    def __post_init__(self) -> None:
        spans = [second for second in (self.begin, self.end) if second is not None]
        if not all(map(math.isfinite, spans)) or sorted(spans) != spans:
            raise ValueError(
                f"A prop must be put down after it is picked up: {self.begin} to {self.end} seconds is empty."
            )
        TIME_RANGE.check(spans)

    @property
    def is_always(self) -> bool:
        """True if the prop is neither picked up nor put down."""
        return self.begin is None and self.end is None

    def holds_at(self, time: float) -> bool:
        """True if stage second ``time`` lies within the hold."""
        return self.seconds_from(time) == 0.0

    def seconds_from(self, time: float) -> float:
        """Seconds from stage second ``time`` to the nearest moment of the hold; 0 while it lasts."""
        before = 0.0 if self.begin is None else self.begin - time
        return max(before, 0.0 if self.end is None else time - self.end, 0.0)


@dataclass(frozen=True)
class InHand(Hold):
    """Hold at one point of a performer's adapted body; ``turn`` is the prop's rotation in the axes of the segment."""

    kind: ClassVar[str] = "in_hand"
    performer_id: str
    point: BodyPoint
    turn: Quaternion = UNTURNED

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "turn", unit_quaternion(self.turn))

    @property
    def reflection(self) -> Vector:
        """Signs of the prop's axes where a mirror image of the body holds it."""
        return X_MIRROR_SIGNS if is_hinged(self.point.part) else Y_MIRROR_SIGNS

    def mirrored(self) -> "InHand":
        """The hold by the other side, for the mirror image of the body."""
        return replace(
            self,
            point=MIRROR_TRANSFORM.body_point(self.point),
            turn=MIRROR_TRANSFORM.own_turn(self.turn, self.point.part),
        )


@dataclass(frozen=True)
class Carried(Hold):
    """Hold between both hands of a performer, at the hands' positions in the motion before constraints are solved.

    The prop rotates with the chest. ``offset`` (leg lengths; ahead, left and up of the chest) is from the middle of the
    hands or, if ``steady``, from the hips. ``heading`` (radians) is the prop's rotation about Z from the chest's
    heading, applied after its ``tilt``. Constraints that keep the hands on the prop do not move it, so a prop of any
    size can be held.
    """

    kind: ClassVar[str] = "carried"
    performer_id: str
    offset: Vector = (0.0, 0.0, 0.0)
    heading: float = 0.0
    tilt: Quaternion = field(default=UNTURNED, metadata=LEFT_OUT_IF_DEFAULT)
    steady: bool = field(default=False, metadata=LEFT_OUT_IF_DEFAULT)
    """True if the hands hold nothing in the captured motion: their gestures then do not swing the prop."""

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "offset", finite_vector(self.offset, "An offset from the hands"))
        object.__setattr__(self, "tilt", unit_quaternion(self.tilt))
        if not math.isfinite(self.heading):
            raise ValueError("A carried prop needs a finite heading.")
        TURN_RANGE.check(self.heading)

    @property
    def reflection(self) -> Vector:
        """Signs of the prop's axes where a mirror image of the body holds it: the axis across the body is reversed."""
        return X_MIRROR_SIGNS if quarter_turns(self.heading) % 2 else Y_MIRROR_SIGNS

    def mirrored(self) -> "Carried":
        """The hold for the mirror image of the body."""
        x, y, z = self.offset
        is_across_x = self.reflection == X_MIRROR_SIGNS
        tilt = np.array(self.tilt) * [*-np.array(self.reflection), 1.0]
        heading = math.remainder((math.pi if is_across_x else 0.0) - self.heading, 2.0 * math.pi)
        return replace(self, offset=(x, -y, z), heading=heading, tilt=tuple(tilt.tolist()))


def quarter_turns(angle: float) -> int:
    """Number of quarter turns, 0 to 3, nearest to ``angle`` in radians."""
    return round(2.0 * angle / math.pi) % 4


@dataclass(frozen=True)
class Prop:
    """Object on the stage of ``size`` metres, centred at ``position``, rotated by ``tilt`` and then by ``heading``
    about Z.

    Keyed values count stage seconds. ``held`` is the first hold, during which the holder moves the prop; ``later`` has
    the following ones. A hold that begins when another ends takes the prop out of the other's hands.
    """

    name: str
    size: Vector = (0.4, 0.4, 0.4)
    position: Vector | KeyedPlace | ProceduralPlace = (0.0, 0.0, 0.2)
    heading: float | KeyedNumber = 0.0
    shape: PropShape = PropShape.BOX
    mesh: TriangleMesh | None = None
    """Mesh of ``PropShape.MESH``, fitted into the size."""
    held: InHand | Carried | None = None
    later: tuple[InHand | Carried, ...] = ()
    tilt: Quaternion | KeyedTurn = field(default=UNTURNED, metadata=LEFT_OUT_IF_DEFAULT)

    def __post_init__(self) -> None:
        if not isinstance(self.tilt, KeyedTurn):
            object.__setattr__(self, "tilt", unit_quaternion(self.tilt))
        object.__setattr__(self, "size", finite_vector(self.size, f"'{self.name}': a size"))
        if getattr(self.position, "origin", None) is not None:
            raise ValueError(f"'{self.name}': a prop cannot have a per-character position.")
        if not isinstance(self.position, KeyedPlace | ProceduralPlace):
            object.__setattr__(self, "position", finite_vector(self.position, f"'{self.name}': a position"))
        if (isinstance(self.heading, float | int) and not math.isfinite(self.heading)) or min(self.size) <= 0.0:
            raise ValueError(f"'{self.name}': a prop needs a finite heading and a size greater than zero.")
        TURN_RANGE.check(self.heading.values if isinstance(self.heading, KeyedNumber) else self.heading)
        if self.shape is PropShape.MESH and self.mesh is None:
            raise ValueError(f"'{self.name}': the shape 'mesh' needs a mesh. Load it from a file first.")
        for one, after in zip(self.holds, self.holds[1:], strict=False):
            if one.end is None or after.begin is None or after.begin < one.end:
                raise ValueError(f"'{self.name}': a character must put the prop down before another picks it up.")
        if self.later and self.held is None:
            raise ValueError(f"'{self.name}': its pick-ups must be in order of time.")

    @property
    def holds(self) -> tuple[InHand | Carried, ...]:
        """All holds, in order of time."""
        return self.later if self.held is None else (self.held, *self.later)

    @property
    def holders(self) -> frozenset[str]:
        """Ids of the performers that hold the prop at some time."""
        return frozenset(each.performer_id for each in self.holds)

    def held_at(self, time: float) -> InHand | Carried | None:
        """Latest hold that lasts at stage second ``time``; None if nobody holds the prop."""
        return next((each for each in reversed(self.holds) if each.holds_at(time)), None)

    def reflection_by(self, performer_id: str, time: float) -> Vector | None:
        """Signs of the prop's axes where a performer's mirror image holds it; None if that performer never does.

        Of several holds of the performer, the one nearest to stage second ``time`` counts.
        """
        own = [each for each in self.holds if each.performer_id == performer_id]
        return min(own, key=lambda hold: hold.seconds_from(time)).reflection if own else None

    def lies_at(self, time: float) -> bool:
        """True if at stage second ``time`` the prop is at its own position: not held, or only just picked up."""
        hold = self.held_at(time)
        return hold is None or (hold is self.held and hold.begin is not None and time - hold.begin < PICK_UP_SECONDS)

    def with_holds(self, holds: Sequence[InHand | Carried]) -> "Prop":
        """Copy with ``holds``, given in order of time, in place of all holds."""
        return replace(self, held=holds[0] if holds else None, later=tuple(holds[1:]))

    def with_hold(self, old: InHand | Carried, new: InHand | Carried) -> "Prop":
        """Copy with the hold ``old`` replaced by ``new``."""
        return self.with_holds([new if each is old else each for each in self.holds])

    def with_span(self, hold: InHand | Carried, begin: float | None, end: float | None) -> "Prop":
        """Copy in which ``hold`` lasts from ``begin`` to ``end``, limited by its neighbours.

        Where one hold ended as the next began (a hand-over), the neighbour is changed so that it still does.
        """
        holds = list(self.holds)
        place = next(at for at, each in enumerate(holds) if each is hold)
        if place > 0 and begin is not None:
            before = holds[place - 1]
            hands = before.end == hold.begin
            begin = max(begin, before.begin if hands and before.begin is not None else before.end or begin)
            if hands:
                holds[place - 1] = replace(before, end=begin)
        if place + 1 < len(holds) and end is not None:
            after = holds[place + 1]
            hands = after.begin == hold.end
            end = min(end, after.end if hands and after.end is not None else (end if hands else after.begin or end))
            if hands:
                holds[place + 1] = replace(after, begin=end)
        if begin is not None and end is not None:
            begin = min(begin, end)
        holds[place] = replace(hold, begin=begin, end=end)
        return self.with_holds(holds)

    def taken(self, hold: InHand | Carried, time: float) -> "Prop":
        """Copy in which ``hold`` takes the prop at ``time`` from the present holder. Later holds are removed."""
        before = [each for each in self.holds if each.begin is None or each.begin < time]
        ended = [replace(each, end=time if each.end is None else min(each.end, time)) for each in before]
        return self.with_holds([*ended, replace(hold, begin=time)])

    def without(self, performer_id: str) -> "Prop":
        """Copy without the holds of one performer."""
        return self.with_holds([each for each in self.holds if each.performer_id != performer_id])

    def release_is_keyed(self, index: int) -> bool:
        """True if a key of the position sets where the hold at ``index`` puts the prop down."""
        hold, after = self.holds[index], self.holds[index + 1 : index + 2]
        if not isinstance(self.position, KeyedPlace) or (after and after[0].begin == hold.end):
            return False
        begun = -math.inf if hold.begin is None else hold.begin
        taken = after[0].begin if after and after[0].begin is not None else math.inf
        return any(begun < time <= taken for time in self.position.times)
