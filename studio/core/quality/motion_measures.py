"""Measures of an adapted motion that plug-ins add to plots and reports."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class MotionMeasure:
    """Measure that gives a number for each frame of an adapted motion."""

    title: str
    """Name in plots, and key in reports."""
    unit: str
    values: Callable[[Any], NDArray[np.float64]]
    """``(adapted: AdaptedMotion) -> (F,)``: function that returns the values in ``unit``."""

    def of(self, adapted: Any) -> NDArray[np.float64]:
        """Values (F,) for an adapted motion. An error of the plug-in is raised as a ValueError that names
        the measure.
        """
        try:
            values = np.asarray(self.values(adapted), dtype=np.float64)
        except Exception as error:  # another's code may raise anything
            raise ValueError(f"The measure '{self.title}' failed: {error or type(error)}") from error
        if values.shape != (adapted.frame_count,):
            raise ValueError(
                f"The measure '{self.title}' gave {values.shape} values for {adapted.frame_count} frames. It gives one"
                " for each frame."
            )
        return values


ADDED_MEASURES: dict[str, MotionMeasure] = {}
"""Measures of plug-ins by title."""


def add_measure(measure: MotionMeasure) -> MotionMeasure:
    """Register a measure and return it. Raises ValueError if its title is taken."""
    if ADDED_MEASURES.get(measure.title, measure) != measure:
        raise ValueError(f"there is already a measure called '{measure.title}'.")
    ADDED_MEASURES[measure.title] = measure
    return measure
