"""Foot contacts: when heel and toe stand on the ground."""

from dataclasses import dataclass
from enum import StrEnum


class FootPoint(StrEnum):
    """What of a foot touches: the heel moves with the ankle, the toe with the toe joint."""

    LEFT_HEEL = "left_heel"
    LEFT_TOE = "left_toe"
    RIGHT_HEEL = "right_heel"
    RIGHT_TOE = "right_toe"

    @property
    def side(self) -> int:
        """0 left, 1 right."""
        return 0 if self.value.startswith("left") else 1

    @property
    def is_heel(self) -> bool:
        return self.value.endswith("heel")


@dataclass(frozen=True)
class ContactInterval:
    """One contact of a motion: ``point`` stands still on the ground from frame ``first`` to ``last``, both included."""

    motion_id: str
    point: FootPoint
    first: int
    last: int

    def __post_init__(self) -> None:
        object.__setattr__(self, "point", FootPoint(self.point))
        if not 0 <= self.first <= self.last:
            raise ValueError(f"A contact runs from a frame to a later one, not from {self.first} to {self.last}.")
