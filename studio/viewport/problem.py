"""The most important problem now: which performer misses which constraint by most, where it should hold."""

from dataclasses import dataclass

import numpy as np

from studio.core.project import Project
from studio.viewport.performance import Results, stage_time

WORTH_SAYING = 0.005
"""Metres short of a target below which nobody needs to be told."""
FULLY = 0.999


@dataclass(frozen=True)
class Problem:
    """The worst frame of the worst performer of one constraint."""

    performer_id: str
    constraint_id: str
    frame: int
    time: float
    """On the stage, seconds."""
    metres: float
    sentence: str


def worst_problem(project: Project, result_of: Results) -> Problem | None:
    """The largest residual of a fully active constraint over all visible performers; None if all hold."""
    worst: Problem | None = None
    for performer_id, performer in project.performers.items():
        motion = result_of(performer_id) if performer.visible and performer.clips else None
        if motion is None:
            continue
        clip = performer.clips[0]
        asked = {k: one for k, one in project.constraints_of(clip.motion_id).items() if one.enabled}
        if len(asked) != len(motion.residuals):
            continue  # a newer answer is on its way
        frames = motion.first_frame + np.arange(motion.frame_count)
        played = (frames >= clip.first) & (frames <= clip.last)
        for (constraint_id, constraint), residual in zip(asked.items(), motion.residuals, strict=True):
            full = constraint.activation.at(frames / motion.frame_rate) >= FULLY
            short = np.where(full & played, np.nan_to_num(residual), 0.0)
            row = int(np.argmax(short))
            if short[row] > max(WORTH_SAYING, worst.metres if worst else 0.0):
                worst = Problem(
                    performer_id, constraint_id, int(frames[row]),
                    stage_time(clip, motion.frame_rate, frames[row] / motion.frame_rate), float(short[row]),
                    _sentence(performer.name, short[row], constraint.name, frames[row]),
                )  # fmt: skip
    return worst


def _sentence(performer: str, metres: float, constraint: str, frame: int) -> str:
    return f"{performer}: {_length(metres)} short of '{constraint}' at frame {frame}"


def _length(metres: float) -> str:
    return f"{metres * 1000:.0f} mm" if metres < 1.0 else f"{metres:.2f} m"
