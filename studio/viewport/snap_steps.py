"""Snapping steps of gizmos."""

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class SnapSteps:
    """Steps of a drag with Ctrl, and of nudges by keys."""

    metres: float = 0.01
    radians: float = math.radians(15.0)
    factor: float = 0.1


DEFAULT_STEPS = SnapSteps()
