"""Volume constraints: a point of the body stays inside, outside, or on the surface of a volume."""

import math
from dataclasses import dataclass, field
from enum import StrEnum
from typing import ClassVar

from studio.core.constraints.base import Constraint, KindInfo, Vector, finite_vector
from studio.core.constraints.follow import UNTURNED
from studio.core.constraints.target import Place, checked_place
from studio.core.curves.keyed import KeyedNumber, KeyedTurn, Quaternion, unit_quaternion
from studio.core.curves.tangents import LEFT_OUT_IF_DEFAULT
from studio.core.mesh.triangle_mesh import TriangleMesh
from studio.core.plausible import TURN_RANGE


class AreaShape(StrEnum):
    """Shape of the volume of an area constraint.

    A half-space lies below its tilted top plane. A table is a box that points leave along its own z axis, and near its
    edges sideways.
    """

    HALF_SPACE = "half_space"
    BOX = "box"
    SPHERE = "sphere"
    CYLINDER = "cylinder"
    TABLE = "table"
    MESH = "mesh"


@dataclass(frozen=True)
class AreaConstraint(Constraint):
    """Constraint that keeps ``point`` outside a volume, or ``inside`` it, or ``on_surface`` from either side.

    ``centre`` is in metres in motion space. ``size`` in metres are the edges of a box or table (x, y, z), the diameter
    of a sphere (x), or diameter and height of a cylinder (x, z). All but a sphere and a half-space are rotated by
    ``tilt`` and then by ``heading`` about Z. A half-space is bounded by the plane through ``centre`` with ``size`` as
    its normal, which points outside. A ``mesh`` has its own size and its origin at ``centre``; outside is where its
    triangles are seen counter-clockwise. The volume moves if centre, heading or tilt is keyed, and with the object that
    its centre follows: it rotates with a prop, and about Z with a bone. Raises ValueError for a volume of no size, or a
    mesh shape without a mesh.
    """

    kind: ClassVar[str] = "area"
    shown: ClassVar[KindInfo] = KindInfo(
        "Add volume constraint", "Keep the picked joint out of a volume: a table under it, until you choose another",
        "#D98A6A", held_by="centre", handle="centre", picks=True,
    )  # fmt: skip
    shape: AreaShape = AreaShape.TABLE
    centre: Place = (0.0, 0.0, 0.0)
    size: Vector = (1.0, 1.0, 1.0)
    heading: float | KeyedNumber = 0.0
    inside: bool = False
    on_surface: bool = False
    mesh: TriangleMesh | None = None
    whole: bool = False
    """True to keep arms, legs and trunk outside; the point and the chain are then not used."""
    margin: float = field(default=0.0, metadata=LEFT_OUT_IF_DEFAULT)
    """Distance in metres that a point keeps outside, rounded at edges; a whole body keeps its own thickness in
    addition.
    """
    tilt: Quaternion | KeyedTurn = field(default=UNTURNED, metadata=LEFT_OUT_IF_DEFAULT)

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "shape", AreaShape(self.shape))
        object.__setattr__(self, "centre", checked_place(self.centre, self, "the centre of a volume"))
        object.__setattr__(self, "size", finite_vector(self.size, f"'{self.name}': the size of a volume"))
        if not (isinstance(self.heading, KeyedNumber) or math.isfinite(self.heading)):
            raise ValueError(f"'{self.name}': the heading must be a finite number of radians, not {self.heading}.")
        TURN_RANGE.check(self.heading.values if isinstance(self.heading, KeyedNumber) else self.heading)
        if not isinstance(self.tilt, KeyedTurn):
            object.__setattr__(self, "tilt", unit_quaternion(self.tilt))
        if self.shape is AreaShape.MESH and self.mesh is None:
            raise ValueError(f"'{self.name}': the shape 'mesh' needs a mesh. Load it from a file.")
        if (self.whole or self.margin) and (self.inside or self.on_surface):
            subject = "a whole body" if self.whole else "a point with a margin"
            raise ValueError(f"'{self.name}': {subject} can only stay outside a volume. Set the region to outside.")
        if not 0.0 <= self.margin < math.inf:
            raise ValueError(f"'{self.name}': the margin of a volume must be 0 or more metres, not {self.margin}.")
        used: dict[AreaShape, tuple[float, ...]] = {
            AreaShape.SPHERE: self.size[:1],
            AreaShape.CYLINDER: (self.size[0], self.size[2]),
            AreaShape.MESH: (),
        }
        if self.shape is AreaShape.HALF_SPACE:
            empty = math.hypot(*self.size) < 1e-9
        else:
            empty = any(edge <= 0.0 for edge in used.get(self.shape, self.size))
        if empty:
            raise ValueError(f"'{self.name}': the size of a volume must be greater than zero.")
