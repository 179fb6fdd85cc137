"""Parallel constraints: axes of two segments of a body point in the same direction, as feet that stay aligned."""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from studio.core.body.canonical import BodyPart
from studio.core.constraints.base import BodyPoint, Constraint, KindInfo, Vector, finite_vector

if TYPE_CHECKING:
    from studio.core.constraints.carried_over import ClipTransform

PARALLEL_AXIS_METRES = 0.25
"""Length in metres of the axis in the 3D view."""


@dataclass(frozen=True)
class ParallelConstraint(Constraint):
    """Constraint that keeps ``axis`` of one segment within ``cone`` radians of ``other_axis`` of the segment of
    ``other``.

    The first segment is that of ``point``; each axis is in the axes of its own segment. The segment rotates freely
    about the axis. The residual is an angle. Raises ValueError for an axis without length, a segment with itself, and a
    cone below zero or of at least half a turn.
    """

    kind: ClassVar[str] = "parallel"
    unit: ClassVar[str] = "rad"
    shown: ClassVar[KindInfo] = KindInfo(
        "Add parallel constraint",
        "Keep the segment at the picked joint parallel to that of the other side, or to the pelvis",
        "#B6A0D8", picks=True,
    )  # fmt: skip
    axis: Vector = (1.0, 0.0, 0.0)
    other: BodyPoint = BodyPoint(BodyPart.PELVIS)
    other_axis: Vector = (1.0, 0.0, 0.0)
    cone: float = 0.0

    def __post_init__(self) -> None:
        super().__post_init__()
        for name in ("axis", "other_axis"):
            words = name.replace("_", " ")
            numbers = np.array(finite_vector(getattr(self, name), f"'{self.name}': the {words}"))
            length = float(np.linalg.norm(numbers))
            if not length > 1e-6:
                raise ValueError(f"'{self.name}': the {words} has no length. Enter a direction.")
            object.__setattr__(self, name, tuple((numbers / length).tolist()))
        if self.other.part is self.point.part:
            raise ValueError(f"'{self.name}': a segment is always parallel to itself. Choose another segment.")
        if not (math.isfinite(self.cone) and 0.0 <= self.cone < math.pi):
            raise ValueError(
                f"'{self.name}': the maximum angle must be 0 to 180 degrees, not {math.degrees(self.cone):g}."
            )

    def carried(self, carry: "ClipTransform") -> dict[str, Any]:
        """Both axes, by field name, transformed by ``carry``; in a mirror, for the segments of the other sides."""
        return {
            "axis": carry.body_point(BodyPoint(self.point.part, self.axis)).offset,
            "other_axis": carry.body_point(BodyPoint(self.other.part, self.other_axis)).offset,
        }

    def sketch(self, position: NDArray[np.float64], turn: NDArray[np.float64]) -> tuple[NDArray[np.float64], ...]:
        """Line of the axis at its point."""
        return (np.stack([position, position + PARALLEL_AXIS_METRES * (turn @ np.array(self.axis))]),)

    def lean(self, turns: NDArray[np.float64], others: NDArray[np.float64]) -> NDArray[np.float64]:
        """Angles (F,) in radians between the axes, beyond the cone, for rotations (F, 3, 3) of both segments."""
        axes, along = turns @ np.array(self.axis), others @ np.array(self.other_axis)
        leans = np.arctan2(np.linalg.norm(np.cross(axes, along), axis=1), np.sum(axes * along, axis=1))
        return np.asarray(np.maximum(leans - self.cone, 0.0))
