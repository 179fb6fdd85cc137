"""Characters in: read from files or made of a capture's actor, put on the stage playing what the others play."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from studio.app.capture_import import changing_nothing, import_motion
from studio.app.workbench import Workbench
from studio.core.body.canonical import BodyPart
from studio.core.captures.capture import Guess
from studio.core.captures.remarks import remarks_on_body
from studio.core.errors import StudioError
from studio.core.mesh.character import Character
from studio.core.names import free_name
from studio.core.stage.project import Performer
from studio.document import colours
from studio.document.document import Document
from studio.io.importing import GUESS_ALL, load_character
from studio.io.project.character_file import actor_character
from studio.io.registry import Progress, ReadCharacter, known_formats

PERFORMER_SPACING, ARM_ROOM = 1.2, 0.6
"""Metres from the outermost performer to a new one, and for the arms between their trunks and heads, at least."""


def import_character(bench: Workbench, path: Path) -> int:
    """Read a character file, then put the character on the stage; returns the task."""

    def work(progress: Progress) -> ReadCharacter:
        with changing_nothing():
            try:
                return load_character(path, GUESS_ALL, progress)
            except StudioError as error:
                moves = path.suffix.lower() in known_formats().suffixes("capture_reader")
                alone = " To read a motion, use Import motion." if moves else ""
                raise StudioError(f"{error}{alone}") from error

    task: int = bench.runner.run(f"Opening {path.name}", work, lambda read: show_import(bench, path, read))
    return task


def show_import(bench: Workbench, path: Path, read: ReadCharacter) -> None:
    """Put a character that was read from ``path`` on the stage, and tell what was repaired or guessed."""
    put_character(bench.document, marked(read.character, bench.document), f"Import {path.name}")
    _tell(bench, path, read)


def marked(character: Character, document: Document) -> Character:
    """One that shows its materials' colours is known in lists and plots by a colour that no other has."""
    if character.skin.appearance is None:
        return character
    return replace(character, colour=colours.character_colour(len(document.project.characters)))


def make_active_actor_character(bench: Workbench) -> None:
    """The actor of the motion that plays becomes a character."""
    motion = bench.document.project.motions.get(bench.document.active_motion_id or "")
    if motion is not None:
        make_actor_character(bench, motion.capture_id)


def make_actor_character(bench: Workbench, capture_id: str) -> None:
    """The actor of a capture becomes a character of the same measures, on the stage."""
    document = bench.document
    capture = document.project.captures[capture_id]
    colour = colours.character_colour(len(document.project.characters))
    text = f"Create character from the actor of {capture.name}"

    def work(progress: Callable[[float, str], None]) -> Character:
        progress(0.1, f"Measuring the actor of {capture.name}")
        from studio.core.normalized.normalize import normalize  # late: it loads kernels

        _, actor = normalize(capture)
        return actor_character(f"Actor of {capture.name}", actor.morphology, colour)

    bench.runner.run(text, work, lambda character: put_character(document, character, text))


def put_character(document: Document, character: Character, text: str) -> str:
    """The character, and a performer that plays it beside the others, selected: one undo step.

    A second one of a name is numbered.
    """
    project = document.project
    taken = {each.name for each in project.characters.values()} | {each.name for each in project.performers.values()}
    character = replace(character, name=free_name(character.name, taken))
    active = project.performers.get(document.active_performer_id or "")
    outermost = max(project.performers.values(), key=lambda other: other.position[1], default=None)
    side = 0.0
    if outermost is not None:
        breadths = _half_breadth(project.characters[outermost.character_id]) + _half_breadth(character)
        side = outermost.position[1] + max(PERFORMER_SPACING, breadths + ARM_ROOM)
    with document.group(text):
        character_id = document.add("characters", character, text)
        clips = active.clips if active else ()
        performer = Performer(character.name, character_id, clips, (0.0, side))
        performer_id = document.add("performers", performer, text)
    document.selection.set(("performers", performer_id))
    return performer_id


def _half_breadth(character: Character) -> float:
    """Metres from the middle to the outermost of trunk and head, cape and hat too."""
    skin, layout = character.skin, character.build.layout
    middle = skin.segments[:, 0] < layout.segment(BodyPart.LEFT_CLAVICLE)
    scale = character.morphology.stature / character.build.stature
    return scale * float(np.abs(skin.vertices[middle, 1]).max(initial=0.0))


def _tell(bench: Workbench, path: Path, read: ReadCharacter) -> None:
    """Tell repairs, daring guesses and whether the file holds a motion; without any, clear the message before."""
    count, sentences = len(read.repairs), []
    daring = [f"{guess.subject}: {guess.value}. {guess.reason}" for guess in read.guesses if is_daring(guess)]
    if count:
        first = read.repairs[0].removeprefix(f"{path.name}, ")
        sentences.append(f"{path.name} was read with {count} repair{'' if count == 1 else 's'}: {first}")
    elif daring:
        sentences.append(f"{path.name} was read; guessed {' '.join(daring)}")
    actions: list[tuple[str, Callable[[], object]]] = [("Close", bench.clear_message)]
    sentences += [f"Warning: {remark.sentence}" for remark in remarks_on_body(read.character.build)]
    if read.moves:
        sentences.append("The file holds a motion too." if sentences else f"{path.name} holds a motion too.")
        actions.insert(0, ("Import its motion", lambda: import_motion(bench, path)))
    if sentences:
        bench.say(" ".join(sentences), *actions)
    else:
        bench.clear_message()


def is_daring(guess: Guess) -> bool:
    """True if a guess goes beyond known names."""
    return guess.subject != "body map" or "by shape" in guess.value
