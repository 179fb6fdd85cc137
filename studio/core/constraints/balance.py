"""Balance: the centre of mass is to be over a place of the ground."""

import math
from dataclasses import dataclass
from typing import ClassVar

from studio.core.constraints.base import Constraint


@dataclass(frozen=True)
class BalanceConstraint(Constraint):
    """The centre of mass stays over ``place`` (metres, motion space), or over where the motion itself has it.

    ``point`` is not used: the whole body is meant. The miss is the horizontal distance.
    """

    kind: ClassVar[str] = "balance"
    place: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.place is not None and not all(math.isfinite(number) for number in self.place):
            raise ValueError(f"'{self.name}': a place on the ground is two finite numbers in metres.")
