"""``convert``: write a motion in another file format, with its own joints and frame rate; or a character."""

from argparse import Namespace
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

import numpy as np

from studio.cli.export_arguments import export_options
from studio.cli.import_arguments import import_options
from studio.cli.outputs import refuse_replacing
from studio.cli.printing import print_json
from studio.core.captures.capture import Guess
from studio.core.names import counted_noun
from studio.io.export import Take, format_for, take_of_capture, take_of_standing, write_take
from studio.io.importing import ImportOptions, known_of_motion, load_character, read_capture, read_file
from studio.io.project.character_file import actor_character
from studio.io.registry import ReadCharacter, format_of, known_formats
from studio.jobs.adaptation import ADAPTED_MOTION_ID, cleaning_records, ready_from_read
from studio.startup.kernel_warm_up import print_wait_reason


def run(arguments: Namespace) -> int:
    """Read, write, and print what was guessed or repaired; return the exit code."""
    if _writes_characters(arguments.target):
        refuse_replacing([arguments.target], arguments.source, arguments.overwrite)
        return _convert_character(arguments)
    format_for(arguments.target)
    options = export_options(arguments)
    options.check(arguments.target)
    refuse_replacing([arguments.target], arguments.source, arguments.overwrite)
    read = _take_of(arguments.source, import_options(arguments))
    take = options.applied_to(read, arguments.target)
    capture = take.capture
    written = write_take(take, arguments.target)
    joints = int(np.count_nonzero(~capture.skeleton.end_sites))
    guesses = _sentences(capture.guesses)
    if arguments.json:
        print_json(
            {
                "ok": True,
                "source": str(arguments.source),
                "file": str(arguments.target),
                "format": written.name,
                "frames": capture.frame_count,
                "frame_rate": capture.frame_rate,
                "joints": joints,
                "assumptions": guesses,
                "repairs": list(capture.repairs),
                "cleaning": cleaning_records(read.capture),
            }
        )
        return 0
    print(
        f"{arguments.target}: {written.name}, {counted_noun(capture.frame_count, 'frame')}"
        f" of {counted_noun(joints, 'joint')}",
        end=" ",
    )
    print(f"at {capture.frame_rate:g} fps.")
    _print_changes(guesses, capture.repairs)
    return 0


def _sentences(guesses: Iterable[Guess]) -> list[str]:
    return [f"{guess.title}. {guess.reason}" for guess in guesses]


def _print_changes(guesses: Iterable[str], repairs: Iterable[str]) -> None:
    for kind, sentences in (("guessed", guesses), ("repaired", repairs)):
        for sentence in sentences:
            print(f"  {kind:<9} {sentence}")


def _take_of(source: Path, options: ImportOptions) -> Take:
    """Take of the motion in a file; a file that can only hold a character gives one frame in which it stands."""
    if not format_of(source, "capture_reader", "character_reader").capture_reader:
        still = load_character(source, options)
        standing = take_of_standing(still.character)
        return replace(standing, capture=replace(standing.capture, guesses=still.guesses, repairs=still.repairs))
    print_wait_reason()
    read = read_capture(source, options)
    return take_of_capture(read.capture, known_of_motion(read.capture, read.annotations, ADAPTED_MOTION_ID))


def _writes_characters(target: Path) -> bool:
    """True if the suffix of the file is that of a character format and of no motion format."""
    known = known_formats()
    suffix = target.suffix.lower()
    return suffix in known.suffixes("character_writer") and suffix not in known.suffixes("motion_writer")


def _convert_character(arguments: Namespace) -> int:
    """Convert a character's file, or the actor of a capture, to a character in another format."""
    read = _character_of(arguments.source, import_options(arguments))
    written = format_for(arguments.target, "character_writer")
    written.write_character(arguments.target, read.character, lambda share, text: None)
    guesses = _sentences(read.guesses)
    body = read.character.morphology
    if arguments.json:
        print_json(
            {
                "ok": True,
                "source": str(arguments.source),
                "file": str(arguments.target),
                "format": written.name,
                "stature": body.stature,
                "vertices": len(read.character.skin.vertices),
                "assumptions": guesses,
                "repairs": list(read.repairs),
            }
        )
        return 0
    print(f"{arguments.target}: {written.name}, '{read.character.name}', {body.stature:.2f} m tall.")
    _print_changes(guesses, read.repairs)
    return 0


def _character_of(source: Path, options: ImportOptions) -> ReadCharacter:
    print_wait_reason()
    read = read_file(source, options)
    if isinstance(read, ReadCharacter):
        return read
    ready = ready_from_read(read, source)
    capture = ready.capture
    return ReadCharacter(actor_character(capture.name, ready.actor.morphology), capture.guesses, capture.repairs)
