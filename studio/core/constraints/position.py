"""Position constraints: a point of the body moves to a target."""

from dataclasses import dataclass
from typing import ClassVar

from studio.core.constraints.base import Constraint, KindInfo
from studio.core.constraints.target import Place, checked_place


@dataclass(frozen=True)
class PositionConstraint(Constraint):
    """Constraint that moves ``point`` to ``target``: a position in motion space, keyed positions, or a
    followed object.
    """

    kind: ClassVar[str] = "position"
    shown: ClassVar[KindInfo] = KindInfo(
        "Add position constraint", "Move the picked joint to a target position", "#5b93d6", held_by="target",
        picks=True,
    )  # fmt: skip
    target: Place = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "target", checked_place(self.target, self, "a target"))
