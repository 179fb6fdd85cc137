"""Upright constraints: an axis of a segment points in one direction, as a tray stays level."""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from studio.core.constraints.base import BodyPoint, Constraint, KindInfo, Vector, finite_vector

if TYPE_CHECKING:
    from studio.core.constraints.carried_over import ClipTransform

UPRIGHT_AXIS_METRES, CONE_SIDES = 0.25, 24
"""Length in metres of the axis in the 3D view, and number of sides of its cone."""


@dataclass(frozen=True)
class UprightConstraint(Constraint):
    """Constraint that keeps ``axis`` of the segment of ``point`` within ``cone`` radians of ``direction``.

    ``axis`` is in the segment's axes, ``direction`` in motion space. The segment rotates freely about the direction.
    The residual is an angle. Raises ValueError for an axis or direction without length, and for a cone below zero or of
    at least half a turn.
    """

    kind: ClassVar[str] = "upright"
    unit: ClassVar[str] = "rad"
    shown: ClassVar[KindInfo] = KindInfo(
        "Add upright constraint", "Keep the axis of the picked segment that points up now within a cone around up",
        "#A9B96F", picks=True,
    )  # fmt: skip
    axis: Vector = (0.0, 0.0, 1.0)
    direction: Vector = (0.0, 0.0, 1.0)
    cone: float = 0.0

    def __post_init__(self) -> None:
        super().__post_init__()
        for name in ("axis", "direction"):
            numbers = np.array(finite_vector(getattr(self, name), f"'{self.name}': the {name}"))
            length = float(np.linalg.norm(numbers))
            if not length > 1e-6:
                raise ValueError(f"'{self.name}': the {name} has no length. Enter a direction.")
            object.__setattr__(self, name, tuple((numbers / length).tolist()))
        if not (math.isfinite(self.cone) and 0.0 <= self.cone < math.pi):
            raise ValueError(
                f"'{self.name}': the maximum angle must be 0 to 180 degrees, not {math.degrees(self.cone):g}."
            )

    def carried(self, carry: "ClipTransform") -> dict[str, Any]:
        """Axis and direction, by field name, rotated and mirrored by ``carry``."""
        axis = carry.body_point(BodyPoint(self.point.part, self.axis)).offset
        return {"axis": axis, "direction": tuple(carry.directions(self.direction).tolist())}

    def sketch(self, position: NDArray[np.float64], turn: NDArray[np.float64]) -> tuple[NDArray[np.float64], ...]:
        """Lines of the axis, and of its cone."""
        wanted = np.array(self.direction)
        side = np.cross(wanted, np.eye(3)[np.argmin(np.abs(wanted))])
        side /= np.linalg.norm(side)
        angles = np.linspace(0.0, 2.0 * np.pi, CONE_SIDES + 1)[:, None]
        ring = np.cos(angles) * side + np.sin(angles) * np.cross(wanted, side)
        ring = position + UPRIGHT_AXIS_METRES * (np.cos(self.cone) * wanted + np.sin(self.cone) * ring)
        axis = np.stack([position, position + UPRIGHT_AXIS_METRES * (turn @ np.array(self.axis))])
        spokes = tuple(np.stack([position, ring[k]]) for k in range(0, CONE_SIDES, CONE_SIDES // 4))
        return (
            (axis, ring, *spokes)
            if self.cone > 0.0
            else (axis, np.stack([position, position + UPRIGHT_AXIS_METRES * wanted]))
        )

    def lean(self, turns: NDArray[np.float64]) -> NDArray[np.float64]:
        """Angles (F,) in radians of the axis from the direction, beyond the cone, for segment rotations (F, 3, 3)."""
        axes, wanted = turns @ np.array(self.axis), np.array(self.direction)
        leans = np.arctan2(np.linalg.norm(np.cross(axes, wanted), axis=1), axes @ wanted)
        return np.asarray(np.maximum(leans - self.cone, 0.0))
