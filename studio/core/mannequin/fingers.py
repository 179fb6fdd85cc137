"""Fingers: tubes along their phalanges, closed surfaces of their own that are rooted in the palm.

A tube has the same vertices however far it is bent, so one hand shape can become another by moving vertices. Lengths
are fractions of the hand's length; the palm faces +x of the hand's frame, the thumb lies on its -y side, z points to
the finger tips.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.core.body.morphology import FloatArray
from studio.core.mannequin.surface import Triangles
from studio.core.rotations import frame_along

FINGER_SIDES = 8
"""Number of vertices around a finger."""
_PHALANGES = (0.45, 0.30, 0.25)
"""Shares of a finger's length, from the knuckle to the tip."""
_STATIONS = np.array([-0.16, 0.0, 0.14, 0.28, 0.38, 0.45, 0.52, 0.62, 0.69, 0.75, 0.81, 0.90, 0.96, 0.99])
"""Places of the rings along a finger: close together where it bends, the first one within the palm."""
_GIRTHS = np.array([1.00, 1.08, 1.02, 0.95, 0.96, 1.00, 0.95, 0.88, 0.89, 0.92, 0.88, 0.86, 0.68, 0.36])


@dataclass(frozen=True)
class Finger:
    """Finger of the left hand: root, direction when straight, length, radius, and bends of its joints."""

    root: tuple[float, float, float]
    way: tuple[float, float, float]
    """Direction of the straight finger."""
    bends_to: tuple[float, float, float]
    """Direction in which the tip moves as the finger bends."""
    length: float
    radius: float
    at_ease: tuple[float, float, float]
    """Bends in degrees of the three joints, from the root on, of a hand at ease."""
    fist: tuple[float, float, float] = (84.0, 98.0, 62.0)
    open: tuple[float, float, float] = (-2.0, 3.0, 2.0)

    def bends(self, grip: float) -> FloatArray:
        """Bends (3,) of the joints in radians for a grip: -1 open, 0 at ease, 1 a fist."""
        other = np.array(self.fist if grip > 0.0 else self.open)
        return np.radians(np.array(self.at_ease) + abs(grip) * (other - self.at_ease))


_PALM = (1.0, 0.0, 0.0)
FINGERS = (
    Finger(
        (0.085, -0.190, 0.27),
        (0.20, -0.30, 0.93),
        (0.70, 0.70, 0.10),
        0.37,
        0.062,
        (4.0, 12.0, 14.0),
        (26.0, 42.0, 40.0),
        (-8.0, 2.0, 2.0),
    ),
    Finger((0.012, -0.150, 0.50), (0.0, -0.07, 1.0), _PALM, 0.46, 0.051, (16.0, 24.0, 14.0)),
    Finger((0.004, -0.048, 0.52), (0.0, -0.02, 1.0), _PALM, 0.50, 0.053, (21.0, 28.0, 16.0)),
    Finger((0.006, 0.052, 0.50), (0.0, 0.04, 1.0), _PALM, 0.47, 0.050, (26.0, 31.0, 18.0)),
    Finger((0.016, 0.142, 0.46), (0.0, 0.12, 1.0), _PALM, 0.38, 0.044, (30.0, 33.0, 20.0)),
)
"""Fingers from the thumb to the little finger."""


def fingers(girth: float, grip: float = 0.0) -> tuple[FloatArray, Triangles]:
    """Vertices (V, 3) and triangles of the thumb and fingers of a left hand with breadth ``girth`` and the given
    ``grip``.
    """
    tubes = [_tube(finger, girth, grip) for finger in FINGERS]
    counts = np.cumsum([0, *(len(tube) for tube in tubes[:-1])])
    return np.concatenate(tubes), np.concatenate([_TRIANGLES + count for count in counts])


def _tube(finger: Finger, girth: float, grip: float) -> FloatArray:
    """Vertices (SIDES * rings + 2, 3) of one finger: its rings, then the centres of its root and its tip."""
    frame = frame_along(np.array(finger.way), np.array(finger.bends_to))
    places, bent = _bent_line(finger, grip)
    ways = np.stack([np.sin(bent), np.zeros(len(bent)), np.cos(bent)], axis=1)
    upward = np.stack([np.cos(bent), np.zeros(len(bent)), -np.sin(bent)], axis=1)
    angles = 2.0 * np.pi * np.arange(FINGER_SIDES) / FINGER_SIDES
    radius = finger.radius * girth
    ring = np.cos(angles)[:, None] * upward[:, None] + np.sin(angles)[:, None] * [0.0, 1.0, 0.0]
    rings = places[:, None] + radius * _GIRTHS[:, None, None] * ring
    tip = places[-1] + 0.25 * radius * ways[-1]
    tube = np.vstack([rings.reshape(-1, 3), places[:1], tip])
    return np.asarray(np.array(finger.root) * [girth, girth, 1.0] + tube @ frame.T)


def _bent_line(finger: Finger, grip: float) -> tuple[FloatArray, FloatArray]:
    """Centres (R, 3) of the rings of a finger, z along the straight finger and x in the direction of its bend; and the
    bend (R,) there in radians.
    """
    joints = np.cumsum([0.0, *_PHALANGES[:-1]])
    fine = np.linspace(_STATIONS[0], _STATIONS[-1], 400)
    bent = np.zeros(len(fine))
    for turn, joint in zip(finger.bends(grip), joints, strict=True):
        bent += turn * _smooth((fine - joint) / 0.16 + 0.5)
    steps = np.gradient(fine) * finger.length
    across, along = np.cumsum(steps * np.sin(bent)), np.cumsum(steps * np.cos(bent))
    x, z = (np.interp(_STATIONS, fine, line) - np.interp(0.0, fine, line) for line in (across, along))
    return np.stack([x, np.zeros(len(x)), z], axis=1), np.interp(_STATIONS, fine, bent)


def _smooth(share: FloatArray) -> FloatArray:
    t = np.clip(share, 0.0, 1.0)
    return np.asarray(t * t * (3.0 - 2.0 * t))


def _ring_triangles(rings: int) -> NDArray[np.int64]:
    """Triangles round a tube of ``rings`` rings, closed by a fan at each end; counter-clockwise from outside."""
    here = np.arange(FINGER_SIDES)
    beside = (here + 1) % FINGER_SIDES
    found = []
    for ring in range(rings - 1):
        low, high = ring * FINGER_SIDES, (ring + 1) * FINGER_SIDES
        found += [
            np.stack([low + here, low + beside, high + beside], 1),
            np.stack([low + here, high + beside, high + here], 1),
        ]
    root, tip, last = rings * FINGER_SIDES, rings * FINGER_SIDES + 1, (rings - 1) * FINGER_SIDES
    found += [
        np.stack([np.full(FINGER_SIDES, root), beside, here], 1),
        np.stack([np.full(FINGER_SIDES, tip), last + here, last + beside], 1),
    ]
    return np.concatenate(found).astype(np.int64)


_TRIANGLES = _ring_triangles(len(_STATIONS))
