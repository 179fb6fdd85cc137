"""Edits of behaviours: each is one undo step."""

from collections.abc import Callable, Iterable
from dataclasses import replace

from studio.core.errors import StudioError
from studio.core.names import free_name
from studio.core.stage import behaviour_edits as edits
from studio.core.stage.behaviour import Behaviour
from studio.core.stage.project import Project
from studio.document.edited_project import EditedProject

BehaviourEdit = Callable[[Behaviour], Behaviour]
COPY_OFFSET = (48.0, 72.0)
"""Offset (x, y) of a copied state from its original in the diagram, in scene units."""
BEHAVIOUR_PARTS = ("states", "transitions")
"""Collections of the selection for parts of behaviours, whose ids are made by ``state_key`` and ``transition_key``."""


def state_key(behaviour_id: str, name: str) -> str:
    """Id by which a state is selected."""
    return f"{behaviour_id}/{name}"


def transition_key(behaviour_id: str, index: int) -> str:
    """Id by which a transition is selected."""
    return f"{behaviour_id}/{index}"


def behaviour_with(project: Project, collection: str, key: str) -> str | None:
    """Id of the behaviour that contains the state or transition with the id ``key``; None if there is none."""
    for behaviour_id, behaviour in project.behaviours.items():
        names = (
            [each.name for each in behaviour.states] if collection == "states" else range(len(behaviour.transitions))
        )
        if any(key == f"{behaviour_id}/{name}" for name in names):
            return behaviour_id
    return None


def place_of(key: str) -> int:
    """Index of a transition in its behaviour, from its id."""
    return int(key.rpartition("/")[2])


def shown_behaviour(document: EditedProject) -> str | None:
    """Id of the behaviour that is selected itself or through one of its parts; else that of the active performer. None
    without any.
    """
    project = document.project
    for collection, key in reversed(document.selection.items):
        if collection == "behaviours" and key in project.behaviours:
            return key
        if collection in BEHAVIOUR_PARTS and (found := behaviour_with(project, collection, key)):
            return found
    return project.behaviour_of(document.active_performer_id or "")


def edit_behaviour(
    document: EditedProject, behaviour_id: str, edit: BehaviourEdit, text: str, gesture: int | None = None
) -> None:
    """Replace a behaviour by the result of ``edit``, as one undo step. A ValueError raised by ``edit`` becomes a
    StudioError.
    """
    try:
        new = edit(document.project.behaviours[behaviour_id])
    except ValueError as error:
        raise StudioError(str(error)) from error
    document.replace("behaviours", behaviour_id, new, text, gesture)


def set_cast(document: EditedProject, performer_id: str, behaviour_id: str | None, partner_id: str = "") -> None:
    """Let a performer play a behaviour against a partner, in place of its former one; with None it plays its clips."""
    name = document.project.performers[performer_id].name
    chosen = document.project.behaviours[behaviour_id].name if behaviour_id else "own clips"
    text = f"Set behaviour of {name} to {chosen}"
    with document.group(text):
        for key, behaviour in document.project.behaviours.items():
            if key == behaviour_id:
                edit_behaviour(document, key, lambda old: edits.with_performer(old, performer_id, partner_id), text)
            elif behaviour.role_of(performer_id):
                edit_behaviour(document, key, lambda old: edits.without_performer(old, performer_id), text)


def add_behaviour(document: EditedProject, performer_id: str, behaviour: Behaviour, partner_id: str = "") -> str:
    """Add a behaviour that a performer plays from now on, and return its id."""
    named = replace(
        behaviour, name=free_name(behaviour.name, {each.name for each in document.project.behaviours.values()})
    )
    with document.group(f"Add behaviour {named.name}"):
        behaviour_id = document.add("behaviours", named, "Add behaviour")
        set_cast(document, performer_id, behaviour_id, partner_id)
    return behaviour_id


def detach_behaviour(document: EditedProject, performer_id: str, behaviour_id: str) -> str:
    """Give a performer its own copy of a shared behaviour, and return the copy's id."""
    project = document.project
    behaviour = project.behaviours[behaviour_id]
    role = behaviour.role_of(performer_id)
    with document.group(f"Make {behaviour.name} unique for {project.performers[performer_id].name}"):
        copied = replace(behaviour, cast=())
        return add_behaviour(document, performer_id, copied, role.partner_id if role else "")


def duplicate_states(document: EditedProject, states: Iterable[str]) -> list[str]:
    """Duplicate states in their behaviours, and return the copies' keys."""
    chosen, made = set(states), []
    with document.group("Duplicate states"):
        for key, behaviour in document.project.behaviours.items():
            names = {each.name for each in behaviour.states if state_key(key, each.name) in chosen}
            if names:
                copied = edits.with_copies(behaviour, names, COPY_OFFSET)
                edit_behaviour(document, key, lambda _, copied=copied: copied, "Duplicate states")  # type: ignore[misc]
                made += [state_key(key, each.name) for each in copied.states[len(behaviour.states) :]]
    return made


def remove_parts(document: EditedProject, states: Iterable[str], transitions: Iterable[str], text: str) -> None:
    """Remove states, with all their transitions, and single transitions from their behaviours."""
    names, places = set(states), set(transitions)
    with document.group(text):
        for key, behaviour in document.project.behaviours.items():
            own = {index for index in range(len(behaviour.transitions)) if transition_key(key, index) in places}
            gone = {each.name for each in behaviour.states if state_key(key, each.name) in names}
            if own:
                edit_behaviour(document, key, lambda old, own=own: edits.without_transitions(old, own), text)  # type: ignore[misc]
            if gone:
                edit_behaviour(document, key, lambda old, gone=gone: edits.without_states(old, gone), text)  # type: ignore[misc]
