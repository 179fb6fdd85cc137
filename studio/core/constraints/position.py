"""Position: a point of the body is to be at a place of the stage."""

from dataclasses import dataclass
from typing import ClassVar

from studio.core.constraints.base import Constraint, Vector, finite_vector


@dataclass(frozen=True)
class PositionConstraint(Constraint):
    """``point`` is to be at ``target``: metres, in the space of the motion (before a performer's placement)."""

    kind: ClassVar[str] = "position"
    target: Vector = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "target", finite_vector(self.target, f"'{self.name}': a target"))
