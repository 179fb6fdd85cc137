"""Form row of the scope of a constraint or contact: the characters or the clip to which it applies."""

from collections.abc import Callable

from studio.core.captures.contacts import ContactInterval
from studio.core.constraints.base import Constraint
from studio.core.constraints.scope import EVERYONE, Scope
from studio.core.stage.clip_row import players_of
from studio.core.stage.project import Project
from studio.panels.editor import Editor
from studio.panels.fields import Choice, Section

UNPLAYED_CLIP = "Unused clip"


class ScopeRow:
    """Form row of a scope: all performers of the motion, one performer, or one clip. ``put`` is called with the
    choice.
    """

    def __init__(
        self, editor: Editor[Constraint | ContactInterval], section: Section, put: Callable[[Scope], None]
    ) -> None:
        self._editor = editor
        self._choice = Choice("Applies to", ())
        self._choice.setToolTip("All characters with this motion, one of them, or one clip only.")
        self._choice.value_chosen.connect(put)
        section.add_row("Applies to", self._choice)

    def refresh(self) -> None:
        """Update the choices and select the entity's scope."""
        entity = self._editor.entity
        scopes = scopes_of(self._editor.document.project, entity.motion_id)
        if entity.scope not in scopes:
            scopes[entity.scope] = UNPLAYED_CLIP
        self._choice.offer(scopes.items())
        self._choice.show_value(entity.scope)


def scopes_of(project: Project, motion_id: str) -> dict[Scope, str]:
    """Possible scopes of a constraint or contact of a motion, with their labels."""
    scopes = {EVERYONE: "All characters"}
    for key, performer in project.performers.items():
        if any(clip.motion_id == motion_id for clip in performer.clips):
            scopes[Scope(performer_id=key)] = f"{performer.name} only"
    for key, clip in project.clips.items():
        if clip.motion_id == motion_id:
            names = [each.name for each in players_of(project, key).values()]
            whose = names[0] if len(names) == 1 else f"{len(names)} characters"
            scopes[Scope(clip_id=key)] = f"Clip at {clip.start:.2f} s of {whose}"
    return scopes
