"""Edits of correction layers: find or add one, set its keys, mirror it."""

from collections.abc import Mapping
from dataclasses import replace

from studio.core.body.canonical import BodyPart
from studio.core.constraints.base import Vector
from studio.core.errors import StudioError
from studio.core.names import free_name
from studio.core.stage.correction import new_correction
from studio.document.edited_project import EditedProject


def correction_at(document: EditedProject, performer_id: str, time: float) -> str | None:
    """Id of the correction in which a pose of the performer at the stage time ``time`` is keyed: of those that act
    then, a selected one, else the last. None if there is none.
    """
    acting = {key: each for key, each in document.project.corrections_of(performer_id).items() if each.acts_at(time)}
    selected = [key for key in document.selection.of("corrections") if key in acting]
    return next(reversed(selected or [*acting]), None)


def set_pose(
    document: EditedProject,
    performer_id: str,
    time: float,
    turns: Mapping[BodyPart, Vector],
    hips: Vector | None = None,
    gesture: int | None = None,
    text: str = "Correct pose",
    *,
    name: str = "",
) -> str:
    """Key rotation vectors of some parts, in radians, and the displacement of the hips in the correction that acts at
    the stage time ``time``; returns the correction's id, which is selected.

    Without one a new correction is added, with ``name``, by default the object of ``text``.
    """
    name = name or text.removeprefix("Correct ")
    with document.group(text, gesture):
        key = correction_at(document, performer_id, time) or _add(document, performer_id, name, time)
        set_pose_of(document, key, time, turns, hips, gesture, text)
    document.selection.set(*_with_body(document, performer_id), ("corrections", key))
    return key


def set_pose_of(
    document: EditedProject,
    correction_id: str,
    time: float,
    turns: Mapping[BodyPart, Vector],
    hips: Vector | None,
    gesture: int | None,
    text: str,
) -> None:
    """Key rotation vectors of some parts, in radians, and the displacement of the hips in a correction at ``time``,
    to which its range is extended.
    """
    correction = document.project.corrections[correction_id]
    pose = correction.pose_at(time).with_turns(turns)
    pose = pose if hips is None else replace(pose, hips=hips)
    document.replace("corrections", correction_id, correction.with_key(time, pose), text, gesture)


def set_key(document: EditedProject, correction_id: str, time: float) -> None:
    """Set a key of a correction at ``time`` with its interpolated values."""
    correction = document.project.corrections[correction_id]
    document.replace(
        "corrections",
        correction_id,
        correction.with_key(time, correction.pose_at(time)),
        f"Set key of {correction.name}",
    )


def mirror_correction(document: EditedProject, correction_id: str) -> None:
    """Mirror a correction to the other side of the body."""
    correction = document.project.corrections[correction_id]
    document.replace("corrections", correction_id, correction.mirrored(), f"Mirror {correction.name}")


def _add(document: EditedProject, performer_id: str, name: str, time: float) -> str:
    performer = document.project.performers.get(performer_id)
    if performer is None or not performer.clips:
        raise StudioError("There is no clip to correct. Add a clip to the character first.")
    taken = {each.name for each in document.project.corrections_of(performer_id).values()}
    made = new_correction(free_name(name[:1].upper() + name[1:], taken), performer_id, time)
    return document.add("corrections", made, f"Correct {name}")


def _with_body(document: EditedProject, performer_id: str) -> tuple[tuple[str, str], ...]:
    chosen = ("performers", performer_id)
    return (chosen,) if chosen in document.selection.items else ()
