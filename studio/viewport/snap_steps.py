"""Steps to which gizmos snap."""

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class SnapSteps:
    """Steps to which Ctrl snaps a drag, and by which keys nudge a thing."""

    metres: float = 0.01
    radians: float = math.radians(15.0)
    factor: float = 0.1


DEFAULT_STEPS = SnapSteps()
