"""Targets of a clip: where the body should be, frame by frame, before its limbs are solved."""

from dataclasses import dataclass, field

import numpy as np

from .curves import FloatArray
from .feet import FootPath

FRAME_RATE = 60.0
"""Frames a second of the captures that come with the studio."""


def frame_times(duration: float, frame_rate: float = FRAME_RATE) -> FloatArray:
    """Times (F,) in seconds of a clip's frames, first and last included."""
    return np.arange(round(duration * frame_rate) + 1) / frame_rate


@dataclass
class ArmTargets:
    """One arm. ``wrist`` (F, 3) metres from the resting shoulder, in the axes of the chest; angles in degrees."""

    wrist: FloatArray
    elbow: FloatArray
    """(3,) or (F, 3) direction in the chest's axes to which the elbow points."""
    upright: float | FloatArray = 0.0
    """1 where the arm hangs by its weight: its axes take only the heading of the chest."""
    held: FloatArray | None = None
    """(F, 3) a place in the world that holds the wrist, by ``holding`` (F,) from 0 to 1."""
    holding: FloatArray | None = None
    carries: bool = False
    """True if the body stands on the hand that is held: it sinks where the arm would not reach."""
    pronation: float | FloatArray = 0.0
    """Palm down; 0 has the thumb up when the forearm points forward."""
    flexion: float | FloatArray = 0.0
    """Wrist towards the palm."""
    deviation: float | FloatArray = 0.0
    """Wrist towards the thumb."""
    shrug: float | FloatArray = 0.0
    """Shoulder up, on top of what the reach of the arm asks."""
    thrust: float | FloatArray = 0.0
    """Shoulder forward, likewise."""


@dataclass
class AirLeg:
    """A leg that kicks: angles (F,) in degrees blended over the path of the foot by ``share`` (F,) from 0 to 1."""

    share: FloatArray
    thigh: FloatArray
    """Raised forward from hanging straight down, against the pelvis."""
    knee: FloatArray
    foot: FloatArray
    """Pitch against the shank; above zero pointed, at 0 square to it."""
    toe: FloatArray
    outward: FloatArray


@dataclass
class Targets:
    """A whole body. Turns are (F, 3) degrees: yaw to the left, pitch forward, roll towards the right."""

    times: FloatArray
    pelvis: FloatArray
    """(F, 3) where the root should be; it sinks where a leg would not reach."""
    pelvis_turn: FloatArray
    chest_turn: FloatArray
    """Against the pelvis."""
    head_turn: FloatArray
    """In the world: the head is steady while the body moves."""
    arms: tuple[ArmTargets, ArmTargets]
    feet: tuple[FootPath, FootPath]
    splay: tuple[float, float] = (6.0, 6.0)
    """Radians by which each knee points outward."""
    air: dict[int, AirLeg] = field(default_factory=dict)
    """Kicking legs by side."""

    @property
    def frame_rate(self) -> float:
        """Frames a second."""
        return float((len(self.times) - 1) / (self.times[-1] - self.times[0]))
