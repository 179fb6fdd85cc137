"""Captures of walks on stairs, made from the project's own walk on the level."""

import math
from pathlib import Path

import numpy as np

from studio.core.grounds import Steps
from studio.core.solver.adapt import adapt
from studio.core.solver.request import AdaptRequest
from studio.core.solver.source import source_motion
from studio.io.export import take_of_actor, write_take
from studio.io.importing import load_capture
from studio.jobs.adaptation import ready_from_capture
from tests.real.taken import named


def write_climb(path: Path, rise: float) -> Steps:
    """Write the walk, adapted to four steps of ``rise`` metres on its own body; returns the steps in the motion's
    space.
    """
    ready = ready_from_capture(load_capture(named("walk")))
    hips = source_motion(ready.motion, ready.actor).positions[ready.capture.first_frame :, 0, :2]
    way = (hips[-1] - hips[0]) / np.linalg.norm(hips[-1] - hips[0])
    steps = Steps(0.0, rise, 0.32, 4, math.atan2(way[1], way[0]), tuple((hips[0] + 0.4 * way).tolist()))
    asked = AdaptRequest(ready.motion, ready.actor.morphology, ready.contacts, (), steps)
    adapted = adapt(asked, ready.capture.first_frame)
    write_take(take_of_actor(adapted, ready.actor, ready.capture, asked), path)
    return steps
