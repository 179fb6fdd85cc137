"""Motion of a clip's take, prepared for a person who corrects the clip's label."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.core.body.sticks import bone_pairs
from studio.core.normalized.realize import realize_motion
from studio.library.library import LibraryClip
from studio.library.proposed_strikes import body_track

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class OpenedClip:
    """Clip that is opened for labelling, with the stick figure and the limb speeds of its whole take.

    ``points`` (F, P, 3) are on the actor's body, joined by ``pairs`` (B, 2). ``speeds`` (4, F) are those of the ends of
    the limbs relative to the hips, in limb lengths per second.
    """

    clip: LibraryClip
    points: FloatArray
    pairs: NDArray[np.intp]
    speeds: FloatArray

    @classmethod
    def of(cls, clip: LibraryClip) -> "OpenedClip":
        """Pose the take of ``clip`` and measure the speeds in the same way as ``proposed_strikes``."""
        body, motion = clip.actor.body, clip.take.motion
        points, rotations = realize_motion(motion, body, play=True)
        track = body_track(points, rotations, body, motion.frame_rate)
        return cls(clip, points, bone_pairs(body.layout), np.array([limb.speed for limb in track.limbs]))

    @property
    def frame_rate(self) -> float:
        """Frame rate of the take."""
        return self.clip.take.motion.frame_rate
