"""Takeover: a motion that begins at any frame of a grounded one, placed where the body is.

It follows the last displayed poses, so standing feet stay in place. It is grounded by itself and then inertialised from
the current pose (``solver.grounding.inertialisation``).
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from studio.core.body.morphology import AnimatedMorphology
from studio.core.captures.contacts import FOOT_POINTS, ground_contacts
from studio.core.grounds.ground import Ground
from studio.core.normalized.compose import Composite, blended_continuation, pieces_after
from studio.core.normalized.encode import encode_motion
from studio.core.normalized.motion import NormalizedMotion
from studio.core.normalized.pieces import MotionPiece
from studio.core.solver.grounding.grounded_motion import GroundedMotion, ground_motion
from studio.core.solver.grounding.inertialisation import Stance, inertialised_motion

LAST_POSE_SECONDS = 2.0
"""Seconds for which the last pose is held before the takeover, so that standing feet keep their contacts."""
SPEED_FRAMES = 3
"""Number of last displayed frames from which velocities are computed."""
SHOWN_ORIGIN = (-1, 0)
"""Origin of the piece made of the last displayed frames, which belongs to no clip."""
ACCELERATION_SECONDS = 1.0
"""Seconds of the previous motion from which the accelerations of its joints are computed."""


@dataclass(frozen=True, eq=False)
class Takeover:
    """Motion ``composite`` in which the new pieces play from frame ``first`` on, grounded as ``standing`` but not
    inertialised.

    The difference at the takeover decays in ``seconds``; 0 chooses the time automatically.
    """

    composite: Composite
    standing: GroundedMotion
    first: int
    seconds: float

    def inertialised(self, before: GroundedMotion, rows: NDArray[np.int64]) -> GroundedMotion:
        """Grounded motion inertialised from the frames ``rows`` of ``before``, the last displayed ones."""
        return inertialised_motion(self.standing, self.first, Stance.of(before, rows), self.seconds)


def take_over(
    before: GroundedMotion,
    rows: NDArray[np.int64],
    pieces: Sequence[MotionPiece],
    stood: Callable[[Composite], GroundedMotion],
) -> Takeover:
    """Takeover by ``pieces`` after the frames ``rows`` (SPEED_FRAMES,) of ``before``; ``stood`` is a function that
    grounds a composite.
    """
    begins, ease = pieces[0].start, pieces[0].ease
    shown = _shown(before, rows, begins)
    composite = pieces_after(shown, pieces)
    if any(each.point not in FOOT_POINTS for each in ground_contacts((*shown.contacts, *composite.contacts))):
        # a body supported by hands, knees or seat as well may turn over: its blend is grounded as a whole
        composite = blended_continuation(shown, _played(before, int(rows[-1])), pieces)
    return Takeover(composite, stood(composite), round(composite.timing.frame_at(begins)), ease)


def _shown(before: GroundedMotion, rows: NDArray[np.int64], start: float) -> MotionPiece:
    """Last displayed frames, on level ground, as a piece that ends where ``start`` begins.

    The last pose is held before them, so that a standing foot is detected there, whatever the next piece does with
    it.
    """
    standing, rate = before, before.motion.frame_rate
    if not standing.ground.is_level:
        standing = ground_motion(
            standing.motion,
            standing.morphology,
            standing.contacts,
            Ground(),
            standing.volume,
            standing.actor,
            standing.limited,
        )
    frame = rows[-1]
    body = standing.morphology
    still = body.at(frame) if isinstance(body, AnimatedMorphology) else body
    positions = standing.positions[rows] - [0.0, 0.0, standing.ground.height]
    seen = encode_motion(positions, standing.rotations[rows], still, rate, "before")
    held = np.concatenate([np.tile(seen.channels[-1], (round(LAST_POSE_SECONDS * rate), 1)), seen.channels])
    motion = replace(seen, channels=held)
    last = len(held) - 1
    stands = tuple(replace(each, first=0, last=last) for each in standing.contacts if each.first <= frame <= each.last)
    return MotionPiece(motion, stands, 0, last, start - len(held) / rate, origin=SHOWN_ORIGIN)


def _played(before: GroundedMotion, frame: int) -> NormalizedMotion:
    motion = before.motion
    first = max(frame - round(ACCELERATION_SECONDS * motion.frame_rate), 0)
    return replace(motion, channels=motion.channels[first : frame + 1], changes=())
