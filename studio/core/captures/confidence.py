"""Confidence of guesses about a file."""

from enum import StrEnum
from typing import Self


class Confidence(StrEnum):
    """Confidence of a guess, derived from its lead over the second best guess or from the scatter of the evidence."""

    SURE = "sure"
    LIKELY = "likely"
    DOUBTFUL = "doubtful"

    @classmethod
    def of(cls, margin: float, likely: float, sure: float) -> Self:
        """Confidence for a ``margin``; ``likely`` and ``sure`` are the least margins of these levels."""
        return cls("sure" if margin >= sure else "likely" if margin >= likely else "doubtful")
