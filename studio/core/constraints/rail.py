"""Rail constraints: a point slides along a line or over a plane, which may move."""

import math
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from studio.core.constraints.base import Constraint, KindInfo, Vector, finite_vector
from studio.core.constraints.follow import FOLLOWS, FollowPerformer, FollowProp
from studio.core.constraints.target import Place, checked_place
from studio.core.plausible import PLACE_RANGE

if TYPE_CHECKING:
    from studio.core.constraints.carried_over import ClipTransform

PLANE_PATCH_HALF_METRES = 0.6
"""Half the edge in metres of the drawn piece of a plane."""


class RailShape(StrEnum):
    """Shape of a rail: a line with two ends, or an endless plane."""

    LINE = "line"
    PLANE = "plane"


@dataclass(frozen=True)
class RailConstraint(Constraint):
    """Constraint that keeps ``point`` on a line of ``length`` metres through ``centre`` along ``direction``, or on a
    plane.

    The plane goes through ``centre`` and has the normal ``direction``. Centre and direction are in motion space. The
    rail moves with the object that its centre follows: the direction tilts with a prop, and rotates about Z with a
    segment. Raises ValueError for a direction or a line without length.
    """

    kind: ClassVar[str] = "rail"
    shown: ClassVar[KindInfo] = KindInfo(
        "Add rail constraint", "Let the picked joint slide along a line through it, or over a plane", "#7FB8C9",
        held_by="centre", handle="centre", picks=True,
    )  # fmt: skip
    shape: RailShape = RailShape.LINE
    centre: Place = (0.0, 0.0, 0.0)
    direction: Vector = (1.0, 0.0, 0.0)
    length: float = 2.0

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "shape", RailShape(self.shape))
        object.__setattr__(self, "centre", checked_place(self.centre, self, "the centre of a rail"))
        numbers = np.array(finite_vector(self.direction, f"'{self.name}': the direction"))
        size = float(np.linalg.norm(numbers))
        if not size > 1e-6:
            raise ValueError(f"'{self.name}': the direction has no length. Enter a direction.")
        object.__setattr__(self, "direction", tuple((numbers / size).tolist()))
        if not (math.isfinite(self.length) and self.length > 0.0):
            raise ValueError(f"'{self.name}': the length of a rail must be greater than 0, not {self.length} m.")
        PLACE_RANGE.check(self.length, f"'{self.name}': a length")

    def carried(self, carry: "ClipTransform") -> dict[str, Any]:
        """Direction, by field name, rotated and mirrored by ``carry``; in the axes of a prop or performer it is
        unchanged.
        """
        if isinstance(self.centre, FollowPerformer | FollowProp):
            return {}
        seen = replace(carry, turn=0.0) if isinstance(self.centre, FOLLOWS) else carry
        return {"direction": tuple(seen.directions(self.direction).tolist())}

    def nearest(self, positions: NDArray[np.float64]) -> NDArray[np.float64]:
        """Positions (..., 3) on a fixed rail nearest to ``positions`` (..., 3), in metres."""
        along, centre = np.array(self.direction), np.array(self.centre)
        heights = (positions - centre) @ along
        if self.shape is RailShape.PLANE:
            return np.asarray(positions - heights[..., None] * along)
        return np.asarray(centre + np.clip(heights, -self.length / 2, self.length / 2)[..., None] * along)

    def sketch(self, position: NDArray[np.float64], turn: NDArray[np.float64]) -> tuple[NDArray[np.float64], ...]:
        """Lines of the rail, or of a piece of its plane and the normal, and from the point to the rail."""
        along, centre = np.array(self.direction), np.array(self.centre)
        link = np.stack([position, self.nearest(position)])
        if self.shape is RailShape.LINE:
            return np.stack([centre - self.length / 2 * along, centre + self.length / 2 * along]), link
        first = np.cross(along, np.eye(3)[np.argmin(np.abs(along))])
        first *= PLANE_PATCH_HALF_METRES / np.linalg.norm(first)
        second = np.cross(along, first)
        corners = [first + second, second - first, -first - second, first - second, first + second]
        return np.array(corners) + centre, np.stack([centre, centre + 0.25 * along]), link
