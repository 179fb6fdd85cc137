"""Adaptation of all visible performers of a project."""

from studio.core.body.morphology import Morphology
from studio.core.captures.capture import Capture
from studio.core.normalized.motion import NormalizedMotion
from studio.core.normalized.normalize import normalize_capture
from studio.core.solver.adapt import adapt
from studio.core.solver.performers.rows import timing_of
from studio.core.solver.performers.staged_performances import StagedPerformances, adapt_performers
from studio.core.solver.request import AdaptedMotion
from studio.core.stage.project import Project


def adapted_performers(project: Project) -> dict[str, AdaptedMotion]:
    """Adapted motion of every visible performer that plays human motions."""
    return {key: each.adapted for key, each in stage_performances(project).performances.items()}


def stage_performances(project: Project) -> StagedPerformances:
    """Requests and adapted motions of all visible performers that have a clip, and the errors of those that fail."""
    shown = [key for key, each in project.performers.items() if each.visible and each.clips]
    made = adapt_performers(project, shown, prepared_capture, adapt)
    return StagedPerformances(
        {key: made.performances[key] for key in shown if key in made.performances},
        {key: made.failures[key] for key in shown if key in made.failures},
    )


def prepared_capture(capture: Capture) -> tuple[NormalizedMotion, Morphology]:
    """Normalised motion of a capture, and the morphology of its actor."""
    motion, actor = normalize_capture(capture)
    return motion, actor.morphology


def stage_duration(project: Project, performer_id: str) -> float:
    """Stage second at which a performer's last clip ends."""
    return timing_of(project, project.performers[performer_id]).end
