"""Constraint handles: the targets of each performer, and which of them are not reached."""

from collections.abc import Container, Mapping
from dataclasses import dataclass

import numpy as np

from studio.core.constraints.balance import Support
from studio.core.constraints.base import LEAST_CONSTRAINT_WEIGHT, Constraint
from studio.core.rotations import from_matrix, to_matrix
from studio.core.solver.performers.stage import constraints_of_performer
from studio.core.solver.task_assembly.shared_goals import groups_with_shared_goal, weighted_mean
from studio.core.stage.held_grips import gripped_prop
from studio.core.stage.project import Project
from studio.engine.posed_performer import PosedPerformer
from studio.engine.target_context import TargetContext
from studio.viewport.camera import FloatArray
from studio.viewport.handle_figures import HandleShape, figure_of, figure_with_goal, with_outline, with_path
from studio.viewport.handle_places import handle_position


@dataclass(frozen=True, eq=False)
class Handle:
    """Handle of a constraint on one performer: stage position ``target`` (3,) if it has one, figure, and current
    activation.
    """

    constraint_id: str
    performer_id: str
    kind: str
    target: FloatArray | None
    figure: HandleShape
    activation: float
    is_primary: bool
    """True for handles of the active performer, which are drawn in full."""

    @property
    def is_missed(self) -> bool:
        """True if the constraint is fully active and its target not reached."""
        return self.activation > 0.5 and self.figure.missed

    @property
    def extent(self) -> FloatArray:
        """(N, 3) stage points of the figure."""
        own = [] if self.target is None else [self.target[None]]
        links = [] if self.figure.link is None else [self.figure.link]
        return np.concatenate([*own, *links, *self.figure.lines])


def constraint_handles(
    project: Project, posed: Mapping[str, PosedPerformer], active: str | None, only: Container[str] | None = None
) -> list[Handle]:
    """Handles on every posed performer, those of the active one last so that they are painted on top; with ``only``, of
    some constraints.
    """
    handles = []
    for performer_id, pose in sorted(posed.items(), key=lambda item: item[0] == active):
        asked = project.constraints_for(performer_id, pose.clip) if pose.clip else {}
        moment, floor = TargetContext(project, posed, pose), floor_under(project, pose)
        shared = _shared_goals(moment, asked)
        for constraint_id, constraint in asked.items():
            if only is not None and constraint_id not in only:
                continue
            constraint = moment.as_played(constraint)
            now = moment.with_targets_fixed(constraint) if constraint.enabled else None
            if now is None:
                continue
            place = handle_position(now, floor)
            if constraint_id in shared:
                figure = figure_with_goal(now, *shared[constraint_id], pose, floor)
            else:
                figure = figure_of(now, pose, floor)
            if isinstance(getattr(constraint, "place", None), Support):
                figure = with_outline(figure, moment.support_outline(), floor)
            if place is not None:
                held, leg_length = getattr(constraint, constraint.shown.held_by, None), pose.motion.body.leg_length
                figure = with_path(figure, held, pose.seconds, np.array(place), leg_length)
            handles.append(
                Handle(
                    constraint_id, performer_id, constraint.kind,
                    None if place is None else pose.clip_placement.to_stage(place),
                    figure.placed(pose.clip_placement),
                    _activation(project, performer_id, pose, constraint_id), performer_id == active,
                )
            )  # fmt: skip
    return handles


def _shared_goals(moment: TargetContext, asked: Mapping[str, Constraint]) -> dict[str, tuple[tuple[float, ...], bool]]:
    """Blended goal of each active constraint that shares its point with others, and True if it has a weight above
    zero.
    """
    times = np.array([moment.pose.seconds])
    found: dict[str, tuple[tuple[float, ...], bool]] = {}
    enabled = [key for key, each in asked.items() if each.enabled]
    for group in groups_with_shared_goal([asked[key] for key in enabled]):
        pulls, targets = {}, []
        for key in (enabled[place] for place in group):
            constraint = moment.as_played(asked[key])
            pull = constraint.weights_at(times) * _activation(moment.project, moment.performer_id, moment.pose, key)
            now = moment.with_targets_fixed(constraint)
            if now is not None and pull[0] > 0.0:
                pulls[key] = pull
                targets.append(np.array(getattr(now, "target"))[None])  # noqa: B009 - both kinds have it
        if len(pulls) < 2:
            continue
        turns = targets[0].shape[1] == 4
        mean = weighted_mean([to_matrix(each) for each in targets] if turns else targets, np.array([*pulls.values()]))
        goal = tuple((from_matrix(mean) if turns else mean)[0].tolist())
        found |= {key: (goal, bool(pull[0] > LEAST_CONSTRAINT_WEIGHT)) for key, pull in pulls.items()}
    return found


def _activation(project: Project, performer_id: str, pose: PosedPerformer, constraint_id: str) -> float:
    """Current activation. Of a hand constraint on a carried prop it is that of the current loop, since the hold limits
    it.
    """
    constraint = project.constraints[constraint_id]
    if gripped_prop(constraint) is None or pose.played is None:
        return float(constraint.activation.at(pose.seconds))
    here = [
        each.constraint.activation
        for each in constraints_of_performer(project, performer_id)
        if each.constraint_id == constraint_id and (each.clip, each.repeat) == pose.played.piece.origin
    ]
    return max((float(curve.at(pose.seconds)) for curve in here), default=0.0)


def floor_under(project: Project, pose: PosedPerformer) -> float:
    """Height in metres of the ground under a performer's root."""
    return float(project.ground.height_at(pose.points[0]))
