"""Removal of an entity together with everything that depends on it."""

from dataclasses import replace

from studio.core.stage.behaviour import Behaviour, without_references
from studio.core.stage.project import Performer, Project
from studio.core.stage.prop import Prop
from studio.document.commands.replace import Edit, with_edits_applied


def removal_edits(project: Project, collection: str, entity_id: str) -> tuple[Edit, ...]:
    """Edits that remove an entity and everything that depends on it.

    Performers of a removed motion only lose its clips, a removed holder releases its prop, and a behaviour continues
    without a removed performer.
    """
    edits: list[Edit] = []
    for name, key in project.referring_to(collection, entity_id):
        old = project.get(name, key)
        if old is None:
            continue
        if collection == "motions" and isinstance(old, Performer):
            kept = tuple(clip for clip in old.clips if clip.motion_id != entity_id)
            over = tuple(layer for layer in old.layers if layer.clip.motion_id != entity_id)
            steps: tuple[Edit, ...] = (Edit(name, key, old, replace(old, clips=kept, layers=over)),)
        elif collection == "performers" and isinstance(old, Prop):
            steps = (Edit(name, key, old, old.without(entity_id)),)
        elif isinstance(old, Behaviour):
            steps = (Edit(name, key, old, without_references(old, collection, entity_id)),)
        else:
            steps = removal_edits(project, name, key)
        edits += steps
        project = with_edits_applied(project, steps)
    place = project.place(collection, entity_id)
    return (*edits, Edit(collection, entity_id, project.get(collection, entity_id), None, place))
