"""Targets of strikes: a prop, or the face of another performer."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.core.body.canonical import BodyPart
from studio.core.constraints.base import BodyPoint
from studio.core.constraints.follow import Follow, FollowPerformer, FollowProp
from studio.core.stage.project import Project
from studio.engine.posed_performer import ResultOf, posed_performers
from studio.engine.prop_places import prop_at

FloatArray = NDArray[np.float64]

FACE_POINT = BodyPoint(BodyPart.HEAD, (0.1, 0.0, 0.05))


@dataclass(frozen=True)
class StrikeTarget:
    """Target of a strike: an entity of the project in ``props`` or ``performers``."""

    collection: str
    id: str

    def name(self, project: Project) -> str:
        """Name of the target for the user."""
        return str(project.get(self.collection, self.id).name)

    @property
    def follow(self) -> Follow:
        """Constraint target that follows the prop, or the face of the performer."""
        return FollowProp(self.id) if self.collection == "props" else FollowPerformer(self.id, FACE_POINT)

    def place(self, project: Project, result_of: ResultOf, time: float) -> FloatArray | None:
        """(3,) position of the target on the stage at ``time``; None if it is not solved."""
        posed = posed_performers(project, result_of, time)
        if project.get(self.collection, self.id) is None:
            return None
        if self.collection == "props":
            return prop_at(project, posed, self.id, time).place
        if self.id not in posed:
            return None
        from studio.core.solver.task_assembly.points import point_indices  # not before it is needed: it loads kernels

        pose = posed[self.id]
        origin, segment = point_indices(FACE_POINT, pose.motion.morphology.layout)
        turned = pose.motion.rotations[pose.row, segment] @ np.array(FACE_POINT.offset)
        return pose.placement.to_stage(pose.motion.positions[pose.row, origin] + turned)


def targets_of(project: Project) -> list[tuple[StrikeTarget, str]]:
    """All possible targets with their names: props, then the faces of performers."""
    props = [(StrikeTarget("props", key), prop.name) for key, prop in project.props.items()]
    performers = {key: one for key, one in project.performers.items() if one.visible}
    return props + [(StrikeTarget("performers", key), f"{one.name}, face") for key, one in performers.items()]
