"""Orientation constraints: a segment of the body is rotated to a target."""

from dataclasses import dataclass
from typing import ClassVar

from studio.core.constraints.base import Constraint, KindInfo
from studio.core.constraints.target import Turn, checked_turn


@dataclass(frozen=True)
class OrientationConstraint(Constraint):
    """Constraint that gives the segment of ``point`` the rotation ``target``, a quaternion (x, y, z, w) in motion
    space.

    The target may be keyed, or follow the rotation of an object. Raises ValueError if the four numbers are no rotation.
    The residual is an angle.
    """

    kind: ClassVar[str] = "orientation"
    unit: ClassVar[str] = "rad"
    shown: ClassVar[KindInfo] = KindInfo(
        "Add orientation constraint", "Keep the current rotation of the segment at the picked joint", "#C9B458",
        picks=True,
    )  # fmt: skip
    target: Turn = (0.0, 0.0, 0.0, 1.0)

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "target", checked_turn(self.target, self))
