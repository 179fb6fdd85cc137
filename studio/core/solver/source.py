"""The motion on its own actor, as a reference for adapted motions."""

import numpy as np

from studio.core.body.morphology import Morphology
from studio.core.normalized.actor import SourceRig
from studio.core.normalized.motion import NormalizedMotion
from studio.core.normalized.realize import realize_motion
from studio.core.solver.request import AdaptedMotion


def source_motion(motion: NormalizedMotion, actor: SourceRig) -> AdaptedMotion:
    """``motion`` on the body of its actor, without grounding and constraints."""
    return motion_on_body(motion, actor.morphology)


def motion_on_body(motion: NormalizedMotion, body: Morphology) -> AdaptedMotion:
    """``motion`` on a body, without grounding and constraints."""
    positions, rotations = realize_motion(motion, body, play=True)
    return AdaptedMotion(body, motion.frame_rate, 0, positions, rotations, np.empty((0, len(positions))))
