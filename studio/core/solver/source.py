"""The motion as its own actor performed it: what adapted motions are compared with."""

import numpy as np

from studio.core.body.morphology import Morphology
from studio.core.normalized.actor import Actor
from studio.core.normalized.motion import NormalizedMotion
from studio.core.normalized.realize import realize
from studio.core.solver.request import AdaptedMotion


def source_motion(motion: NormalizedMotion, actor: Actor) -> AdaptedMotion:
    """``motion`` on the body that it was captured from, unchanged by ground or constraints."""
    return played_on(motion, actor.morphology)


def played_on(motion: NormalizedMotion, body: Morphology) -> AdaptedMotion:
    """``motion`` on a body, unchanged by ground or constraints."""
    positions, rotations = realize(motion, body, play=True)
    return AdaptedMotion(body, motion.frame_rate, 0, positions, rotations, np.empty((0, len(positions))))
