"""Trust in what was guessed of a file."""

from enum import StrEnum
from typing import Self


class Confidence(StrEnum):
    """Trust in a guess, by how far the best reading is ahead of the second best, or how far the evidence scatters."""

    SURE = "sure"
    LIKELY = "likely"
    DOUBTFUL = "doubtful"

    @classmethod
    def of(cls, margin: float, likely: float, sure: float) -> Self:
        """The confidence that a ``margin`` gives which is ``likely`` or ``sure`` from the values of these names on."""
        return cls("sure" if margin >= sure else "likely" if margin >= likely else "doubtful")
