"""Measures of residuals: unit, display and thresholds of lengths and angles, shared by all views."""

import math
from dataclasses import dataclass

from studio.core.constraints.base import Constraint
from studio.document.length_units import length_text

DECIMAL_BELOW = 9.95
"""Amount in millimetres or degrees below which one decimal is shown."""


@dataclass(frozen=True)
class Measure:
    """Kind of amount: displayed unit, factor from metres, radians or a ratio to that unit, and thresholds."""

    sign: str
    factor: float
    held_below: float
    """Amount below which a residual is invisible, and the constraint held."""
    partly_below: float
    """Amount up to which a residual is hardly visible, and the constraint partly held."""
    worth_saying: float
    """Amount from which a problem is reported."""
    worst_shown: float
    """Amount at which an error strip has its full height."""

    def text_of(self, amount: float) -> str:
        """Amount as text with unit: ``0.4 mm``, ``42 mm``, ``1.20 m``; ``0.4°``, ``42°``."""
        value = amount * self.factor
        decimals = 1 if value < DECIMAL_BELOW else 0
        if self is LENGTH_MEASURE:
            return length_text(amount, "m", 2) if value >= 1000.0 else length_text(amount, "mm", decimals)
        return f"{value:.{decimals}f}{self.sign}"

    def weight(self, amount: float) -> float:
        """Badness of an amount relative to the visible tolerance, by which lengths and angles are compared."""
        return amount / self.partly_below


LENGTH_MEASURE = Measure(" mm", 1000.0, held_below=0.001, partly_below=0.020, worth_saying=0.005, worst_shown=0.1)
SKATE_MEASURE = Measure(" mm", 1000.0, held_below=0.02, partly_below=0.2, worth_saying=0.1, worst_shown=0.5)
"""Distance travelled by a foot along the ground; feet in captures travel up to 9 cm as they land and lift."""
ANGLE_MEASURE = Measure(
    "°",
    math.degrees(1.0),
    held_below=math.radians(0.5),
    partly_below=math.radians(5.0),
    worth_saying=math.radians(1.0),
    worst_shown=math.radians(45.0),
)
PEAK_MEASURE = Measure(" ×", 1.0, held_below=1.5, partly_below=3.0, worth_saying=3.0, worst_shown=8.0)
"""Ratio of an angular acceleration to its maximum in the capture."""
_BY_UNIT = {"m": LENGTH_MEASURE, "rad": ANGLE_MEASURE}


def measure_of(constraint: Constraint) -> Measure:
    """Measure of the residuals of a constraint."""
    return _BY_UNIT[constraint.unit]
