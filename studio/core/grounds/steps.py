"""Ground with a flight of steps, up or down."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from studio.core.grounds.ground import FloatArray, Ground
from studio.core.grounds.slope import direction_vector

GREATEST_FOOTHOLD_OFFSET = 0.06
"""Greatest displacement of a foot in metres to stand on one tread."""
FULL_OFFSET_RISE = 0.03
"""Rise of a step in metres from which feet are fully displaced from its edges; for lower steps the displacement is
proportional.
"""
RISER_CLEARANCE = 0.02
"""Further distance in metres that a sole keeps from the riser of the next higher step, which it passes as it leaves or
arrives.
"""
EDGE_CLEARANCE = 0.005
"""Distance in metres that a sole keeps from the edges of a tread."""
SOLE_HALF_WIDTH = 0.035
"""Half width of a sole in metres."""


@dataclass(frozen=True)
class Steps(Ground):
    """Ground with ``count`` steps of ``rise`` and ``tread`` metres towards ``direction`` (radians), the first riser at
    ``start``.

    A negative rise goes down. The ground is level before the first and after the last step.
    """

    kind: ClassVar[str] = "steps"
    rise: float = 0.17
    tread: float = 0.30
    count: int = 12
    direction: float = 0.0
    start: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        super().__post_init__()
        if not (all(map(math.isfinite, self.start)) and self.tread >= 0.02 and 1 <= self.count <= 1000):
            raise ValueError("Steps have a finite start, treads of at least 0.02 m, and number from 1 to 1000.")

    def rise_at(self, xy: FloatArray) -> FloatArray:
        return np.asarray(self.rise * self._step(self._beyond(xy)))

    def foothold_offsets(self, soles: FloatArray) -> FloatArray:
        """Displacements (N, 2) along the flight by which heel, ball and tip of a sole share a tread, or at least cross
        no riser.
        """
        ways = self._beyond(soles)
        line = soles[:, 2] - soles[:, 0]
        length = np.maximum(np.linalg.norm(line, axis=1), 1e-9)
        across = direction_vector(self.direction + math.pi / 2)
        ways = np.column_stack([ways, ways.mean(axis=1)])
        room = SOLE_HALF_WIDTH * np.abs(line @ across) / length + EDGE_CLEARANCE
        weight = min(abs(self.rise) / FULL_OFFSET_RISE, 1.0)
        shifts = np.array([self._best(way, margin) for way, margin in zip(ways, room, strict=True)])
        return weight * shifts.reshape(-1, 1) * direction_vector(self.direction)

    def _best(self, way: FloatArray, room: float) -> float:
        """Displacement in metres with the least cost of one sole at ``way`` (heel, ball, tip, middle) to a tread near
        it.

        ``way`` is in metres along the flight, ``room`` the distance that the sole keeps from the edges.
        """
        near = np.unique(self._step(way))
        low, high = way.min() - room, way.max() + room
        shifts, costs = [], []
        for step in near:
            begin = (step - 1) * self.tread if step > 0 else -math.inf
            end = step * self.tread if step < self.count else math.inf
            fits = high - low <= end - begin
            if self.rise > 0.0:
                clear = end - high - RISER_CLEARANCE
                wanted = max(min(0.0, clear), begin - low) if fits else clear
            else:
                clear = begin - low + RISER_CLEARANCE
                wanted = min(max(0.0, clear), end - high) if fits else clear
            shift = min(max(wanted, -GREATEST_FOOTHOLD_OFFSET), GREATEST_FOOTHOLD_OFFSET)
            over_end, over_begin = high + shift - end, begin - low - shift
            into, over = (over_end, over_begin) if self.rise > 0.0 else (over_begin, over_end)
            within = max(into, over) <= 1e-9
            close = 0.0 if within else max(into + RISER_CLEARANCE, 0.0)
            costs.append(100.0 * close + max(over, 0.0) + 0.1 * abs(shift))
            shifts.append(shift)
        return float(shifts[int(np.argmin(costs))])

    def _step(self, way: FloatArray) -> FloatArray:
        return np.clip(np.floor(way / self.tread) + 1.0, 0.0, self.count)

    def _beyond(self, xy: FloatArray) -> FloatArray:
        return np.asarray((xy - np.array(self.start)) @ direction_vector(self.direction))
