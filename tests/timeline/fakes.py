"""A live adaptation whose answers are given by the test."""

import numpy as np

from studio.core.solver.request import AdaptedMotion
from tests.builders import make_morphology
from tests.solved_live import SolvedLive


def make_result(project, errors, motion_id="motion"):
    """An answer with the given error (metres, or (F,)) for each constraint, NaN where it is not active."""
    motion = project.motions[motion_id]
    capture = project.captures[motion.capture_id]
    frames = capture.poses.frame_count
    times = np.arange(frames) / capture.frame_rate
    asked = {key: each for key, each in project.constraints_of(motion_id).items() if each.enabled}
    residuals = np.full((len(asked), frames), np.nan)
    for row, (key, constraint) in enumerate(asked.items()):
        active = constraint.activation.at(times) > 0
        residuals[row, active] = np.broadcast_to(errors.get(key, 0.0), frames)[active]
    morphology = make_morphology()
    layout = morphology.layout
    positions = np.zeros((frames, layout.point_count, 3))
    positions[:, layout.toe_point(0), 0] = 2.0 * times
    rotations = np.broadcast_to(np.eye(3), (frames, layout.segment_count, 3, 3))
    return AdaptedMotion(morphology, capture.frame_rate, 0, positions, rotations, residuals)


class FakeLive(SolvedLive):
    """Every constraint misses what a test says."""

    def __init__(self, document):
        super().__init__(document)
        self.document = document
        self.errors = {}
        self.unsolved = set()
        self.failures = {}
        self.interactive_history = [False]

    @property
    def interactive(self):
        return self.interactive_history[-1]

    @interactive.setter
    def interactive(self, value):
        self.interactive_history.append(value)

    def failure(self, performer_id):
        return self.failures.get(performer_id, "")

    def reported_motion(self, performer_id):
        return None if performer_id in self.unsolved else self.result(performer_id)

    def result(self, performer_id):
        return make_result(self.document.project, self.errors.get(performer_id, {}))
