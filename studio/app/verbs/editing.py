"""Actions of the Edit menu and of visibility: undo, delete, copy, hide."""

from collections.abc import Sequence
from dataclasses import replace

from PySide6.QtGui import QGuiApplication

from studio.app.verbs import clips
from studio.app.workbench import Workbench
from studio.core.captures.contacts import ContactInterval
from studio.core.errors import StudioError
from studio.core.names import free_name
from studio.core.stage.behaviour import Transition
from studio.core.stage.clip import Clip
from studio.core.stage.project import GROUND_ID
from studio.core.stage.staging import path_heading, performers_in_row
from studio.document.behaviour_commands import duplicate_states, remove_parts
from studio.document.clip_edits import name_of, remove_clips
from studio.document.clipboard import paste_json, selection_as_json
from studio.document.correction_edits import set_key as set_correction_key
from studio.document.key_edits import delete_keys, set_keys
from studio.engine.posed_performer import swept_points

NESTED_COLLECTIONS = ("clips", "states", "transitions")
DELETED_BEFORE_CHARACTERS = (
    *("constraints", "contacts", "labels", "props", "behaviours", "corrections", "cameras", "sounds", "footage"),
    *NESTED_COLLECTIONS,
)


def undo(bench: Workbench) -> None:
    """Undo the last step."""
    bench.document.undo_stack.undo()


def redo(bench: Workbench) -> None:
    """Redo the last undone step."""
    bench.document.undo_stack.redo()


def duplicate(bench: Workbench) -> None:
    """Duplicate the selection: constraints with the lowest priority, a clip after itself, states beside their
    originals.
    """
    document = bench.document
    if document.selection.of("states"):
        bodies = [item for item in document.selection.items if item[0] == "performers"]
        copied = duplicate_states(document, document.selection.of("states"))
        document.selection.set(*bodies, *(("states", key) for key in copied))
        return
    if document.selection.of("clips"):
        clips.duplicate(bench)
        return
    copies = []
    keys = document.selection.of("constraints")
    text = (
        f"Duplicate {_name(bench, 'constraints', keys[0])}" if len(keys) == 1 else f"Duplicate {len(keys)} constraints"
    )
    with document.group(text):
        for key in keys:
            constraint, others = document.project.constraints[key], document.project.constraints.values()
            name = free_name(constraint.name, {each.name for each in others})
            copy = replace(constraint, name=name, priority=max(each.priority for each in others) + 1)
            copies.append(("constraints", document.add("constraints", copy, text)))
    document.selection.set(*copies)


def delete(bench: Workbench) -> None:
    """Delete the selected keys; if there are none, the selected entities and everything that depends on them.

    A performer that is selected together with its constraint or clip is kept.
    """
    document = bench.document
    if document.keys.items:
        delete_keys(document)
        return
    selected = [item for item in document.selection.items if item != ("grounds", GROUND_ID)]
    items = [item for item in selected if item[0] in DELETED_BEFORE_CHARACTERS] or selected
    text = _deletion(bench, items)
    with document.group(text):
        remove_clips(document, document.selection.of("clips"), text)
        remove_parts(document, document.selection.of("states"), document.selection.of("transitions"), text)
        for collection, key in items:
            if collection not in NESTED_COLLECTIONS and document.project.get(collection, key) is not None:
                document.remove(collection, key, text)


def copy(bench: Workbench) -> None:
    """Copy the selected keys, constraints, contacts and corrections to the system clipboard, as JSON."""
    text = selection_as_json(bench.document)
    if not text:
        raise StudioError("Select constraints, contacts, corrections or keys to copy first.")
    QGuiApplication.clipboard().setText(text)


def paste_copied(bench: Workbench) -> None:
    """Paste from the system clipboard, also from another window."""
    paste_json(bench.document, QGuiApplication.clipboard().text())


def paste_mirrored(bench: Workbench) -> None:
    """Paste with left and right swapped."""
    paste_json(bench.document, QGuiApplication.clipboard().text(), mirrored=True)


def set_key(bench: Workbench) -> None:
    """Set a key at the playhead on the selection. Raises StudioError if nothing in it can be keyed."""
    document = bench.document
    corrections = [key for key in document.selection.of("corrections") if key in document.project.corrections]
    for key in corrections:
        set_correction_key(document, key, document.playhead.time)
    rotates = bench.has_viewport and bench.viewport.tool == "rotate"
    if not corrections and not set_keys(document, rotates):
        raise StudioError(
            "Nothing here can be keyed. Select a constraint with a target, a correction, a prop or a character first."
        )


def hide(bench: Workbench) -> None:
    """Hide the selected characters, or show them if they are hidden."""
    document = bench.document
    keys = document.selection.of("performers") or filter(None, (document.active_performer_id,))
    performers = {key: document.project.performers[key] for key in keys}
    visible = not any(performer.visible for performer in performers.values())
    names = ", ".join(performer.name for performer in performers.values())
    with document.group(f"{'Show' if visible else 'Hide'} {names}"):
        for key, performer in performers.items():
            document.replace("performers", key, replace(performer, visible=visible), "Hide")


def solo(bench: Workbench) -> None:
    """Show only the selected characters; show all if only they are visible already."""
    document = bench.document
    performers = document.project.performers
    kept = document.selection.of("performers") or (document.active_performer_id,)
    alone = all(performer.visible == (key in kept) for key, performer in performers.items())
    names = ", ".join(performer.name for key, performer in performers.items() if key in kept)
    with document.group("Show all characters" if alone else f"Solo {names}"):
        for key, performer in performers.items():
            document.replace("performers", key, replace(performer, visible=alone or key in kept), "Solo")


def show_all(bench: Workbench) -> None:
    """Show all characters."""
    document = bench.document
    with document.group("Show all characters"):
        for key, performer in document.project.performers.items():
            document.replace("performers", key, replace(performer, visible=True), "Show")


def line_up(bench: Workbench) -> None:
    """Place the selected characters, or all visible ones, side by side across the direction of travel."""
    document = bench.document
    project, chosen = document.project, document.selection.of("performers")
    keys = chosen if len(chosen) > 1 else [key for key, each in project.performers.items() if each.visible]
    performers = {key: project.performers[key] for key in keys if project.performers[key].clips}
    if len(performers) < 2:
        raise StudioError("Show or select at least two characters that play something first.")
    swept = swept_points(project, bench.live.result)
    active = document.active_performer_id
    followed = next((swept[key][:, 0] for key in (active, *performers) if key in performers and key in swept), None)
    travel = None if followed is None else path_heading(followed)
    with document.group("Arrange characters side by side"):
        for key, performer in performers_in_row(performers, travel or 0.0, swept).items():
            document.replace("performers", key, performer, "Arrange side by side")


def preferences(bench: Workbench) -> None:
    """Show the preferences dialog."""
    from studio.app.preferences_dialog import PreferencesDialog  # it lists the actions, of which this is one

    PreferencesDialog(bench).show()


def escape(bench: Workbench) -> None:
    """Cancel a drag; without one close the message, or else clear the selection."""
    view = bench.viewport if bench.has_viewport else None
    if view is not None and (view.cancel_gesture() or view.joint_picked is not None):
        view.pick(None)
    elif bench.window.strip.text:
        bench.clear_message()
    else:
        bench.document.selection.clear()


def select_ground(bench: Workbench) -> None:
    """Show the ground in the inspector."""
    bench.document.selection.set(("grounds", GROUND_ID))


def select_capture(bench: Workbench) -> None:
    """Show the import report of the capture that is playing."""
    motion = bench.document.project.motions.get(bench.document.active_motion_id or "")
    if motion is not None:
        bench.document.selection.set(("captures", motion.capture_id))


def _deletion(bench: Workbench, items: Sequence[tuple[str, str]]) -> str:
    """Undo text for deleting ``items``; it tells performers, which leave the stage, from characters of the library."""
    collections = {collection for collection, _ in items}
    what = _name(bench, *items[0]) if len(items) == 1 else f"{len(items)} items"
    if collections == {"performers"}:
        return f"Remove {what if len(items) == 1 else f'{len(items)} characters'} from stage"
    return f"Delete {f'{len(items)} {next(iter(collections))}' if len(collections) == 1 < len(items) else what}"


def _name(bench: Workbench, collection: str, key: str) -> str:
    entity = bench.document.project.get(collection, key)
    if isinstance(entity, ContactInterval):
        return f"{entity.point.words} contact"
    if isinstance(entity, Transition):
        return f"transition to {entity.target}"
    if isinstance(entity, Clip):
        return f"clip {name_of(bench.document.project, entity)}"
    return str(getattr(entity, "name", "selection"))
