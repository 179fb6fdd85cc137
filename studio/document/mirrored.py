"""Constraints and contacts of a motion as a mirrored clip plays them: on the other side of the body."""

from dataclasses import fields
from typing import cast

from studio.core.captures.contacts import ContactInterval
from studio.core.changed_records import RecordT, with_fields
from studio.core.constraints.base import Constraint
from studio.core.normalized.mirror import mirrored_contacts
from studio.core.stage.clip import Clip
from studio.core.stage.correction import Correction
from studio.core.stage.mirrored_props import constraint_as_played
from studio.core.stage.project import Project
from studio.document.commands.replace import same_value


def mirrored_entity(project: Project, performer_id: str, clip: Clip, entity: RecordT) -> RecordT:
    """Constraint, contact or correction mirrored as the clip of a performer plays it; other entities are unchanged.
    Applied twice, it returns the original.
    """
    match entity:
        case Constraint():
            return cast(RecordT, constraint_as_played(project, performer_id, clip, entity))
        case ContactInterval():
            return cast(RecordT, mirrored_contacts((entity,))[0])
        case Correction():
            return cast(RecordT, entity.mirrored())
    return entity


def mirrored_edit(project: Project, performer_id: str, clip: Clip, stored: RecordT, new: RecordT) -> RecordT:
    """``stored`` with the edits that a view made in its mirror image ``new``.

    Fields that the view did not change keep their identity.
    """
    before, after = (mirrored_entity(project, performer_id, clip, each) for each in (stored, new))
    if type(before) is not type(new):
        return after
    names = [each.name for each in fields(new)]
    return with_fields(
        stored,
        **{name: getattr(after, name) for name in names if not same_value(getattr(before, name), getattr(new, name))},
    )


def mirrored_project(project: Project, performer_id: str, clip: Clip) -> Project:
    """Project in which the constraints and contacts of a mirrored clip's motion are on the side where the clip plays
    them.
    """
    changed = {
        name: {
            key: mirrored_entity(project, performer_id, clip, each) if each.motion_id == clip.motion_id else each
            for key, each in getattr(project, name).items()
        }
        for name in ("constraints", "contacts")
    }
    return with_fields(project, **changed)
