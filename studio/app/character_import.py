"""Import of characters: read from a file or made from the actor of a capture, and added to the stage."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from studio.app.capture_import import import_motion, project_unchanged_on_error
from studio.app.workbench import Workbench
from studio.core.body.canonical import BodyPart
from studio.core.captures.capture import Guess
from studio.core.captures.remarks import body_remarks
from studio.core.errors import StudioError
from studio.core.mesh.character import Character
from studio.core.names import free_name
from studio.core.stage.clip import Clip
from studio.core.stage.project import Performer, Project
from studio.core.stage.staging import next_row_position, swept_points
from studio.document import colours
from studio.document.document import Document
from studio.io.figure.body import remapped_character
from studio.io.importing import GUESS_ALL, load_character
from studio.io.project.character_file import actor_character
from studio.io.registry import Progress, ReadCharacter, known_formats

ARM_ROOM_METRES = 0.6
"""Metres that are left for the arms between the torsos of two characters placed side by side."""


def import_character(bench: Workbench, path: Path) -> int:
    """Read a character file, then add the character to the stage. Returns the id of the task."""

    def work(progress: Progress) -> ReadCharacter:
        with project_unchanged_on_error():
            try:
                return load_character(path, GUESS_ALL, progress)
            except StudioError as error:
                moves = path.suffix.lower() in known_formats().suffixes("capture_reader")
                alone = " To import its animation, use File > Import capture." if moves else ""
                raise StudioError(f"{error}{alone}") from error

    task: int = bench.runner.run(f"Opening {path.name}", work, lambda read: show_import(bench, path, read))
    return task


def show_import(bench: Workbench, path: Path, read: ReadCharacter) -> None:
    """Add a character that was read from ``path`` to the stage, and report repairs and guesses."""
    add_read_character(
        bench.document, with_identification_colour(read.character, bench.document), f"Import {path.name}"
    )
    _tell(bench, path, read)


def with_identification_colour(character: Character, document: Document) -> Character:
    """Character with a free identification colour in lists and plots if its skin has the colours of its materials."""
    if character.skin.appearance is None:
        return character
    return replace(character, colour=colours.character_colour(len(document.project.characters)))


def make_active_actor_character(bench: Workbench) -> None:
    """Create a character from the actor of the motion that the active performer plays."""
    motion = bench.document.project.motions.get(bench.document.active_motion_id or "")
    if motion is not None:
        make_actor_character(bench, motion.capture_id)


def make_actor_character(bench: Workbench, capture_id: str) -> None:
    """Create a character with the proportions of a capture's actor, and add it to the stage."""
    document = bench.document
    capture = document.project.captures[capture_id]
    colour = colours.character_colour(len(document.project.characters))
    text = f"Create character from the actor of {capture.name}"

    def work(progress: Callable[[float, str], None]) -> Character:
        progress(0.1, f"Measuring the actor of {capture.name}")
        from studio.core.normalized.normalize import normalize_capture  # late: it loads kernels

        _, actor = normalize_capture(capture)
        return actor_character(f"Actor of {capture.name}", actor.morphology, colour)

    bench.runner.run(text, work, lambda character: add_read_character(document, character, text))


def remap_character(bench: Workbench, character_id: str, joints: Mapping[str, str], text: str) -> int:
    """Measure and bind a character again with another body map ``joints``, as one undo step with the text ``text``.
    Returns the id of the task.
    """
    document = bench.document
    character = document.project.characters[character_id]

    def work(progress: Progress) -> Character:
        progress(0.1, text)
        made = remapped_character(character, joints)
        progress(1.0, text)
        return made

    def put(made: Character) -> None:
        if document.project.characters.get(character_id) is not character:
            raise StudioError(f"{character.name} changed while you mapped it. Pick the joint again.")
        document.replace("characters", character_id, made, text)

    task: int = bench.runner.run(text, work, put)
    return task


def add_read_character(document: Document, character: Character, text: str) -> str:
    """Add a character, and a selected performer that uses it beside the others, as one undo step; returns the
    performer's id. A name that is taken gets a number.
    """
    project = document.project
    taken = {each.name for each in project.characters.values()} | {each.name for each in project.performers.values()}
    character = replace(character, name=free_name(character.name, taken))
    active = project.performers.get(document.active_performer_id or "")
    room = ARM_ROOM_METRES + _half_breadth(character)
    gaps = {
        key: room + _half_breadth(project.characters[each.character_id]) for key, each in project.performers.items()
    }
    clips = active.clips if active else ()
    sweeps = {
        key: swept
        for key, each in project.performers.items()
        if (swept := _swept_points(project, each.clips, project.characters[each.character_id])) is not None
    }
    position = next_row_position(project.performers, gaps, sweeps, _swept_points(project, clips, character))
    with document.group(text):
        character_id = document.add("characters", character, text)
        performer = Performer(character.name, character_id, clips, position)
        performer_id = document.add("performers", performer, text)
    document.selection.set(("performers", performer_id))
    return performer_id


def _swept_points(project: Project, clips: Sequence[Clip], character: Character) -> NDArray[np.float64] | None:
    """Ground points (T, P, 2) in metres over which a character moves during its first clip; None without a clip."""
    if not clips:
        return None
    clip = clips[0]
    swept = swept_points(project.captures[project.motions[clip.motion_id].capture_id], clip.first, clip.last)
    return None if swept is None else character.morphology.leg_length * swept


def _half_breadth(character: Character) -> float:
    """Largest distance in metres of torso or head from the body's middle plane, including cape and hat."""
    skin, layout = character.skin, character.build.layout
    middle = skin.segments[:, 0] < layout.segment_of_part(BodyPart.LEFT_CLAVICLE)
    scale = character.morphology.stature / character.build.stature
    return scale * float(np.abs(skin.vertices[middle, 1]).max(initial=0.0))


def _tell(bench: Workbench, path: Path, read: ReadCharacter) -> None:
    """Report repairs, uncertain guesses and a motion in the file. If there are none, the last message is removed."""
    count, sentences = len(read.repairs), []
    daring = [f"{guess.subject}: {guess.value}. {guess.reason}" for guess in read.guesses if is_uncertain(guess)]
    if count:
        first = read.repairs[0].removeprefix(path.name).lstrip(",: ")
        sentences.append(f"{path.name} was read with {count} repair{'' if count == 1 else 's'}: {first}")
    elif daring:
        sentences.append(f"{path.name} was imported; assumed {' '.join(daring)}")
    actions: list[tuple[str, Callable[[], object]]] = [("Close", bench.clear_message)]
    sentences += [f"Warning: {remark.sentence}" for remark in body_remarks(read.character.build)]
    if read.moves:
        sentences.append("The file also contains animation." if sentences else f"{path.name} also contains animation.")
        actions.insert(0, ("Import animation", lambda: import_motion(bench, path)))
    if sentences:
        bench.post_message(" ".join(sentences), *actions)
    else:
        bench.clear_message()


def is_uncertain(guess: Guess) -> bool:
    """True if a guess was not made from known joint names."""
    return guess.subject != "body map" or "by shape" in guess.value
