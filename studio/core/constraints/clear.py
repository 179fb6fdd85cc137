"""Arm clearance constraints: hands, forearms and elbows stay out of trunk, head and thighs."""

import math
from dataclasses import dataclass
from enum import StrEnum
from typing import ClassVar

from studio.core.constraints.base import Constraint, KindInfo


class Arms(StrEnum):
    """Choice of arms: left, right or both."""

    BOTH = "both"
    LEFT = "left"
    RIGHT = "right"

    def has(self, side: int) -> bool:
        """True if the arm of side 0 (left) or 1 (right) is included."""
        return self is Arms.BOTH or self is (Arms.RIGHT if side else Arms.LEFT)


@dataclass(frozen=True)
class ClearConstraint(Constraint):
    """Constraint that keeps ``arms`` ``margin`` metres away from the body, except where the actor touches the own body.

    ``point`` is not used. Of the chain only the limb counts: at 1 the wrist moves and the elbow swivels about the line
    from shoulder to wrist, at 0 only the elbow swivels. The residual is the penetration of the margin. Raises
    ValueError for a margin below zero or wider than a body.
    """

    kind: ClassVar[str] = "clear"
    shown: ClassVar[KindInfo] = KindInfo(
        "Add arm clearance constraint", "Keep both arms of the active character out of its torso, head and thighs",
        "#D9A0A0", about="arms",
    )  # fmt: skip
    arms: Arms = Arms.BOTH
    margin: float = 0.0

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "arms", Arms(self.arms))
        if not (math.isfinite(self.margin) and 0.0 <= self.margin <= 0.5):
            raise ValueError(f"'{self.name}': the margin must be between 0 and 0.5 metres, not {self.margin}.")
