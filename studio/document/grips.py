"""Hand constraints of performers that carry props, removed with the holds for which they were made."""

import math

import numpy as np

from studio.core.constraints.base import Constraint
from studio.core.stage.held_grips import STAGE_TIME_TOLERANCE_SECONDS, gripped_prop
from studio.core.stage.prop import Carried, Prop
from studio.document.edited_project import EditedProject


def is_grip(constraint: Constraint, prop_id: str, performer_id: str) -> bool:
    """True if a constraint keeps a hand of the performer on a prop."""
    return gripped_prop(constraint) == prop_id and constraint.scope.performer_id == performer_id


def remove_grips(document: EditedProject, prop_id: str, hold: Carried, text: str) -> None:
    """Remove the constraints that keep the hands of its performer on a prop during ``hold``, with undo ``text``."""
    project = document.project
    for clip in project.performers[hold.performer_id].clips:
        rate = project.frame_rate_of(clip)
        first, last = (
            open_end
            if time is None
            else float(np.clip(clip.motion_seconds(time, rate), clip.first / rate, clip.last / rate))
            for time, open_end in ((hold.begin, -math.inf), (hold.end, math.inf))
        )
        for key, each in document.project.constraints_of(clip.motion_id).items():
            during = first - STAGE_TIME_TOLERANCE_SECONDS <= each.activation.full <= last + STAGE_TIME_TOLERANCE_SECONDS
            if during and is_grip(each, prop_id, hold.performer_id):
                document.remove("constraints", key, text)


def remove_ended_grips(document: EditedProject, prop_id: str, before: Prop, text: str) -> None:
    """Remove the hand constraints of the holds that a prop has no longer, with undo ``text``."""
    kept = [each for each in document.project.props[prop_id].holds if isinstance(each, Carried)]
    for hold in before.holds:
        begin = -math.inf if hold.begin is None else hold.begin
        carries_on = any(each.performer_id == hold.performer_id and each.holds_at(begin) for each in kept)
        if isinstance(hold, Carried) and not carries_on:
            remove_grips(document, prop_id, hold, text)
