"""A flight of steps, up or down."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from studio.core.grounds.ground import FloatArray, Ground
from studio.core.grounds.slope import direction_vector

GREATEST_NUDGE = 0.06
"""Greatest displacement of a foot, in metres, to stand on one tread."""
FULL_NUDGE_RISE = 0.03
"""Rise in metres from which feet avoid the edges fully; for lower steps less so."""
RISER_ROOM = 0.02
"""Metres more that it keeps from the one that rises before it or behind it: it leaves and comes past that."""
EDGE_ROOM = 0.005
HALF_WIDTH = 0.035
"""Metres that a sole keeps from a riser, and half its width."""


@dataclass(frozen=True)
class Steps(Ground):
    """``count`` steps of ``rise`` and ``tread`` metres, the first riser at ``start`` (x, y), towards ``direction``.

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

    def nudges(self, soles: FloatArray) -> FloatArray:
        """Displacements along the flight, so that heel, ball and tip share a tread, or at least do not
        cross a riser.
        """
        ways = self._beyond(soles)
        line = soles[:, 2] - soles[:, 0]
        length = np.maximum(np.linalg.norm(line, axis=1), 1e-9)
        across = direction_vector(self.direction + math.pi / 2)
        ways = np.column_stack([ways, ways.mean(axis=1)])
        room = HALF_WIDTH * np.abs(line @ across) / length + EDGE_ROOM
        weight = min(abs(self.rise) / FULL_NUDGE_RISE, 1.0)
        shifts = np.array([self._best(way, margin) for way, margin in zip(ways, room, strict=True)])
        return weight * shifts.reshape(-1, 1) * direction_vector(self.direction)

    def _best(self, way: FloatArray, room: float) -> float:
        """Cheapest displacement of one sole to a tread near its positions ``way`` (heel, ball, tip, middle)."""
        near = np.unique(self._step(way))
        low, high = way.min() - room, way.max() + room
        shifts, costs = [], []
        for step in near:
            begin = (step - 1) * self.tread if step > 0 else -math.inf
            end = step * self.tread if step < self.count else math.inf
            fits = high - low <= end - begin
            if self.rise > 0.0:
                clear = end - high - RISER_ROOM
                wanted = max(min(0.0, clear), begin - low) if fits else clear
            else:
                clear = begin - low + RISER_ROOM
                wanted = min(max(0.0, clear), end - high) if fits else clear
            shift = min(max(wanted, -GREATEST_NUDGE), GREATEST_NUDGE)
            over_end, over_begin = high + shift - end, begin - low - shift
            into, over = (over_end, over_begin) if self.rise > 0.0 else (over_begin, over_end)
            within = max(into, over) <= 1e-9
            close = 0.0 if within else max(into + RISER_ROOM, 0.0)
            costs.append(100.0 * close + max(over, 0.0) + 0.1 * abs(shift))
            shifts.append(shift)
        return float(shifts[int(np.argmin(costs))])

    def _step(self, way: FloatArray) -> FloatArray:
        return np.clip(np.floor(way / self.tread) + 1.0, 0.0, self.count)

    def _beyond(self, xy: FloatArray) -> FloatArray:
        return np.asarray((xy - np.array(self.start)) @ direction_vector(self.direction))
