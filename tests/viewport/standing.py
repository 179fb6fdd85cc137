"""Adapted motions to look at: bodies standing in their rest pose, sliding forward a little."""

from typing import Any

import numpy as np

from studio.core.body.rest_pose import rest_pose
from studio.core.constraints.base import Constraint
from studio.core.constraints.position import PositionConstraint
from studio.core.solver.request import AdaptedMotion, UnconstrainedPoses
from studio.core.stage.project import Project
from studio.viewport.body_points import point_path
from tests.solved_live import SolvedLive

FRAMES, RATE = 30, 60.0


def standing(project: Project, performer_id: str) -> AdaptedMotion:
    """The performer's body at rest, its residuals as the project's constraints ask."""
    performer = project.performers[performer_id]
    morphology = project.characters[performer.character_id].morphology
    positions, rotations = (np.repeat(part[None], FRAMES, axis=0) for part in rest_pose(morphology))
    positions[:, :, 0] += np.linspace(0.0, 0.3, FRAMES)[:, None]
    motion = AdaptedMotion(morphology, RATE, 0, positions, rotations, np.zeros((0, FRAMES)))
    asked = [one for one in project.constraints_of("motion").values() if one.enabled]
    residuals = [_misses(motion, one) for one in asked]
    misses, unasked = np.reshape(residuals, (-1, FRAMES)), UnconstrainedPoses(positions, rotations)
    return AdaptedMotion(morphology, RATE, 0, positions, rotations, misses, unconstrained=unasked)


def _misses(motion: AdaptedMotion, constraint: Constraint) -> Any:
    """(FRAMES,) metres from a target; what other kinds ask, the standing bodies do."""
    if not isinstance(constraint, PositionConstraint) or not isinstance(constraint.target, tuple):
        return np.zeros(FRAMES)
    return np.linalg.norm(point_path(motion, constraint.point) - constraint.target, axis=1)


class StandingLive(SolvedLive):
    """The engine's part, played by bodies that stand."""

    def __init__(self, document: Any) -> None:
        super().__init__(document)
        self._document = document
        self.was_interactive: list[bool] = []
        self.late: set[str] = set()
        """Performers whose results are not there yet."""
        document.entity_changed.connect(lambda *_: self.was_interactive.append(self.interactive))

    def result(self, performer_id: str) -> AdaptedMotion | None:
        return None if performer_id in self.late else standing(self._document.project, performer_id)

    def source(self, motion_id: str) -> AdaptedMotion:
        return standing(self._document.project, next(iter(self._document.project.performers)))

    def adapt(self) -> None:
        for performer_id in self._document.project.performers:
            self.adapted.emit(performer_id)
        self.reported_changed.emit()


def results_of(project: Project) -> dict[str, AdaptedMotion]:
    return {key: standing(project, key) for key in project.performers}
