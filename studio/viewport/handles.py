"""Constraint handles: where the targets are for each performer, and which of them are missed."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from studio.core.constraints.position import PositionConstraint
from studio.core.project import Project
from studio.viewport.body_points import point_path
from studio.viewport.camera import FloatArray
from studio.viewport.performance import Posed

REACHED = 0.003
"""Metres; nearer than this the point counts as on its target."""


@dataclass(frozen=True, eq=False)
class Handle:
    """A position constraint as one performer has it: target and point on the stage (3,), activation now."""

    constraint_id: str
    performer_id: str
    kind: str
    target: FloatArray
    point: FloatArray
    activation: float
    main: bool
    """Of the active performer: drawn in full."""

    @property
    def missed(self) -> bool:
        """Whether the point should be on the target now, and is not."""
        return self.activation > 0.5 and float(np.linalg.norm(self.point - self.target)) > REACHED


def constraint_handles(project: Project, posed: Mapping[str, Posed], active: str | None) -> list[Handle]:
    """The handles of every posed performer, the active one's last, so that they are drawn on top."""
    handles = []
    for performer_id, pose in sorted(posed.items(), key=lambda item: item[0] == active):
        row = slice(pose.row, pose.row + 1)
        for constraint_id, constraint in project.constraints_of(pose.motion_id or "").items():
            if not isinstance(constraint, PositionConstraint) or not constraint.enabled:
                continue
            handles.append(
                Handle(
                    constraint_id, performer_id, constraint.kind, pose.placement.to_stage(constraint.target),
                    pose.placement.to_stage(point_path(pose.motion, constraint.point, row)[0]),
                    float(constraint.activation.at(pose.seconds)), performer_id == active,
                )
            )  # fmt: skip
    return handles
