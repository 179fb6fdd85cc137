"""What a constraint asks from frame to frame, beside where the unsolved poses have what it is for."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studio.core.body.morphology import Morphology
from studio.core.kernels.tasks.goals import RADIAN_LENGTH
from studio.core.solver.asking.rows import Rows

FloatArray = NDArray[np.float64]
Course = tuple[FloatArray, float]
"""A way (F, n), and the lever over which it turns a bone, in the same unit."""

FARTHEST = 0.8
"""Metres that a target brings its point at most: what is farther off is no more than a direction."""


@dataclass(frozen=True, eq=False)
class Unsolved:
    """Constraint ``c`` of some rows on the unsolved poses (F, P, 3) and (F, S, 3, 3) of a body."""

    c: int
    rows: Rows
    positions: FloatArray
    rotations: FloatArray
    body: Morphology

    @property
    def row(self) -> Any:
        """Its record of ``TASK``."""
        return self.rows.asked[self.c]

    @property
    def segment(self) -> FloatArray:
        """(F, 3, 3) the axes of its segment."""
        return self.rotations[:, self.row["segments"][0]]

    @cached_property
    def place(self) -> FloatArray:
        """(F, 3) its point."""
        return self._end(0)

    @cached_property
    def wanted(self) -> FloatArray:
        """(F or 1, 3) its target, or the other point of the body."""
        return self.rows.places[self.c] if self.row["points"][1] < 0 else self._end(1)

    @property
    def wanted_turn(self) -> FloatArray:
        """(F or 1, 3, 3) its target, or what goes with the body."""
        if self.row["points"][1] < 0:
            return self.rows.turns[self.c]
        return np.asarray(self.rotations[:, self.row["segments"][1]] @ self.row["relative"])

    def _end(self, end: int) -> FloatArray:
        point, segment = self.row["points"][end], self.row["segments"][end]
        return np.asarray(self.positions[:, point] + self.rotations[:, segment] @ self.row["offsets"][end])


def course_to(wanted: FloatArray, begin: FloatArray) -> Course:
    """From a place (F, 3) to the one that is wanted, or nowhere where that is NaN."""
    way = np.where(np.isnan(wanted), 0.0, wanted - begin)
    return way / np.sqrt(1.0 + (np.linalg.norm(way, axis=1, keepdims=True) / FARTHEST) ** 2), RADIAN_LENGTH


def course_of_point(unsolved: Unsolved) -> Course:
    """From where its point is to its target."""
    return course_to(unsolved.wanted, unsolved.place)
