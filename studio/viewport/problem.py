"""Worst problem at present: the performer and constraint with the largest residual at full activation."""

from dataclasses import dataclass

from studio.core.constraints.carried_over import mirrored_constraint
from studio.core.solver.performers.stage import constraints_of_performer
from studio.core.stage.project import Project
from studio.engine.posed_performer import ResultOf
from studio.engine.residuals import Residual, worst_residual


@dataclass(frozen=True)
class Problem:
    """Worst frame of one constraint on one performer, and a sentence about it."""

    performer_id: str
    constraint_id: str
    residual: Residual
    sentence: str


def worst_problem(project: Project, result_of: ResultOf) -> Problem | None:
    """Worst residual of an enabled constraint over all visible performers; None if all constraints are met."""
    worst: Problem | None = None
    for performer_id, performer in project.performers.items():
        motion = result_of(performer_id) if performer.visible and performer.clips else None
        if motion is None:
            continue
        for asked in constraints_of_performer(project, performer_id):
            constraint_id, constraint, clip = asked.constraint_id, asked.constraint, performer.clips[asked.clip]
            found = worst_residual(project, performer_id, motion, constraint_id)
            if found is None or found.amount <= found.measure.worth_saying:
                continue
            if worst is None or found.weight > worst.residual.weight:
                name = (mirrored_constraint(constraint) if clip.mirrored else constraint).name
                sentence = _sentence(performer.name, found, name)
                worst = Problem(performer_id, constraint_id, found, sentence)
    return worst


def _sentence(performer: str, residual: Residual, constraint: str) -> str:
    own = f" ({residual.frame} of the clip)" if residual.frame != residual.stage_frame else ""
    remark = f", {residual.remark}" if residual.remark else ""
    return f"{performer}: '{constraint}' has an error of {residual.text} at frame {residual.stage_frame}{own}{remark}"
