"""Props: things on the stage that bodies hold, strike and stand beside."""

import math
from dataclasses import dataclass
from enum import StrEnum
from typing import ClassVar

from studio.core.constraints.base import BodyPoint, Vector, finite_vector
from studio.core.constraints.follow import UNTURNED
from studio.core.constraints.keyed import KeyedNumber, KeyedPlace, Quaternion, unit_quaternion
from studio.core.constraints.procedural import ProceduralPlace
from studio.core.mesh.triangle_mesh import TriangleMesh


class PropShape(StrEnum):
    """What a prop looks like within its size: a stick lies along Z, stairs rise along X."""

    BOX = "box"
    BALL = "ball"
    STICK = "stick"
    TABLE = "table"
    STAIRS = "stairs"
    MESH = "mesh"


@dataclass(frozen=True, kw_only=True)
class Hold:
    """Somebody holds a prop from ``begin`` until ``end``, seconds of the stage; without them as long as it plays.

    It is picked up from where it is then, and put where keys of its place from then on say, or else left where it is.
    """

    begin: float | None = None
    end: float | None = None

    def __post_init__(self) -> None:
        spans = [second for second in (self.begin, self.end) if second is not None]
        if not all(map(math.isfinite, spans)) or sorted(spans) != spans:
            raise ValueError(f"A prop is held from one second to a later one, not from {self.begin} to {self.end}.")

    @property
    def is_always(self) -> bool:
        """Whether it is neither picked up nor put down."""
        return self.begin is None and self.end is None

    def holds_at(self, time: float) -> bool:
        """Whether it is held at a second of the stage."""
        return (self.begin is None or time >= self.begin) and (self.end is None or time <= self.end)


@dataclass(frozen=True)
class InHand(Hold):
    """Goes with a point of a performer, where constraints bring it: ``turn`` in the axes of its segment."""

    kind: ClassVar[str] = "in_hand"
    performer_id: str
    point: BodyPoint
    turn: Quaternion = UNTURNED

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "turn", unit_quaternion(self.turn))


@dataclass(frozen=True)
class Carried(Hold):
    """Goes between both hands of a performer where the motion has them, and faces as its chest does.

    ``offset`` is from the middle of the hands, ahead, to the left and up, in leg lengths. Hands that constraints hold
    on the prop do not move it, so any size is held.
    """

    kind: ClassVar[str] = "carried"
    performer_id: str
    offset: Vector = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "offset", finite_vector(self.offset, "An offset from the hands"))


@dataclass(frozen=True)
class Prop:
    """A thing of ``size`` metres, centred at ``position``, turned by ``heading`` about Z.

    Keys and rules count seconds of the stage. While it is ``held``, that says where it is.
    """

    name: str
    size: Vector = (0.4, 0.4, 0.4)
    position: Vector | KeyedPlace | ProceduralPlace = (0.0, 0.0, 0.2)
    heading: float | KeyedNumber = 0.0
    shape: PropShape = PropShape.BOX
    mesh: TriangleMesh | None = None
    """Of the shape that is one, fitted into the size."""
    held: InHand | Carried | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "size", finite_vector(self.size, f"'{self.name}': a size"))
        if not isinstance(self.position, KeyedPlace | ProceduralPlace):
            object.__setattr__(self, "position", finite_vector(self.position, f"'{self.name}': a position"))
        if (isinstance(self.heading, float | int) and not math.isfinite(self.heading)) or min(self.size) <= 0.0:
            raise ValueError(f"'{self.name}': a prop needs a finite heading and sides longer than zero.")
        if self.shape is PropShape.MESH and self.mesh is None:
            raise ValueError(f"'{self.name}': load a mesh first, then it can be the shape.")

    @property
    def holder(self) -> str | None:
        """The performer with whom it goes."""
        return self.held.performer_id if self.held else None

    def held_at(self, time: float) -> InHand | Carried | None:
        """How it is held at a second of the stage."""
        return self.held if self.held is not None and self.held.holds_at(time) else None

    @property
    def is_put(self) -> bool:
        """Whether keys of its place say where it is put down."""
        begun = -math.inf if self.held is None or self.held.begin is None else self.held.begin
        return isinstance(self.position, KeyedPlace) and self.position.times[-1] > begun
