"""``adapt``: adapt a capture to many characters, write the motions as files, and report their quality."""

import math
from argparse import Namespace
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from studio.cli.adapt_stage import run_stage
from studio.cli.batch_summary import rows_of, write_rows
from studio.cli.export_arguments import export_options
from studio.cli.import_arguments import import_options
from studio.cli.outputs import refuse_replacing
from studio.cli.printing import QUALITY_TITLES, print_json, print_table
from studio.core.body.character import Character
from studio.core.errors import StudioError
from studio.core.grounds.ground import Ground
from studio.core.plausible import PLACE_RANGE
from studio.core.solver.request import AdaptRequest
from studio.core.stage.placement import Placement
from studio.io.export import take_of_actor, take_of_adapted, write_take
from studio.io.export_options import ExportOptions
from studio.io.importing import ImportOptions
from studio.io.json_text import write_json
from studio.io.project.constraint_file import ConstraintFile, read_constraints
from studio.io.project.ground_file import read_ground
from studio.io.registry import known_formats
from studio.jobs.adapt_report import Record, character_report, place_record
from studio.jobs.adaptation import (
    ADAPTED_MOTION_ID,
    ReadyCapture,
    chosen_characters,
    cleaning_records,
    make_folder,
    ready_capture,
)
from studio.jobs.run_tracks import with_tracks
from studio.startup.kernel_warm_up import compile_first

ACTOR_WORD = "actor"


def run(arguments: Namespace) -> int:
    """Adapt, export and report."""
    if arguments.stage is not None:
        return run_stage(arguments)
    if arguments.one_file:
        raise StudioError("--one-file holds a whole stage: name a project or a scene with --stage.")
    if arguments.capture is None:
        raise StudioError("Name a capture to adapt, or a project with --stage.")
    asked = asked_by(arguments)
    told = [arguments.out / name for name in ("report.json", "report.csv")]
    motions = [arguments.out / file_name(arguments.capture, key, asked) for key in asked.characters]
    refuse_replacing([*motions, *told], arguments.capture, arguments.overwrite)
    report = adapt_file(arguments.capture, import_options(arguments), asked, arguments.out)
    write_json(told[0], report)
    write_rows(told[1], rows_of([{**report, "name": arguments.capture.stem}]))
    if arguments.json:
        print_json(report)
    else:
        print_report(report)
        print("\nWritten:", *motions, *told, sep="\n  ")
    return 0


def file_name(capture: Path, key: str, asked: "AdaptSettings") -> str:
    """Name of the file of one character's motion."""
    return f"{capture.stem}_{key}{asked.suffix}"


@dataclass(frozen=True)
class AdaptSettings:
    """Settings of the command line that apply to any capture: characters, constraints, ground and output."""

    characters: Mapping[str, Character | None]
    """Characters by their names; None is the body that a capture was recorded from, whatever the capture."""
    places: Mapping[str, Placement]
    constraints: Path | None
    ground: Ground
    suffix: str
    options: ExportOptions
    all_frames: bool
    by_frame: bool
    limited: bool
    eased: bool
    clears: bool


def asked_by(arguments: Namespace) -> AdaptSettings:
    """Settings from the arguments of ``adapt``. Raises StudioError for a character or format that does not exist."""
    suffix = f".{arguments.format.lower().lstrip('.')}"
    known = known_formats().suffixes("motion_writer")
    if suffix not in known:
        raise StudioError(f"'{arguments.format}' is not a kind of file for motions: choose {', '.join(known)}.")
    others = [name for name in arguments.character if name != ACTOR_WORD]
    characters: dict[str, Character | None] = {ACTOR_WORD: None} if ACTOR_WORD in arguments.character else {}
    if others or not characters:
        characters |= chosen_characters(others)
    options = export_options(arguments)
    options.check(Path(f"motion{suffix}"))
    return AdaptSettings(
        characters,
        placed(arguments.place, characters),
        arguments.constraints,
        read_ground(arguments.ground) if arguments.ground else Ground(),
        suffix,
        options,
        arguments.all_frames,
        arguments.by_frame,
        not arguments.free_joints,
        not arguments.exact,
        not arguments.through_body,
    )


def placed(said: Sequence[Sequence[str]], characters: Iterable[str]) -> dict[str, Placement]:
    """Placement of each of ``characters``, from the arguments ``said`` (name, x, y, degrees); by default where the
    motion begins.

    Raises StudioError for a character that does not take part, and for invalid numbers.
    """
    places = dict.fromkeys(characters, Placement())
    for name, *numbers in said:
        key = name if name in places else Path(name).stem
        if key not in places:
            raise StudioError(f"--place {name}: no such character takes part. Those that do: {', '.join(places)}.")
        try:
            x, y, degrees = map(float, numbers)
        except ValueError:
            x = y = degrees = math.nan
        if not all(abs(number) <= PLACE_RANGE.most for number in (x, y, degrees)):
            raise StudioError(f"--place {name} {' '.join(numbers)}: say two lengths in metres and degrees.")
        places[key] = Placement((x, y), math.radians(degrees))
    return places


def adapt_file(path: Path, options: ImportOptions, asked: AdaptSettings, folder: Path) -> Record:
    """Adapt one capture to all characters of the settings, write their files into ``folder``, and return the report."""
    own = None if asked.constraints is None else read_constraints(asked.constraints, ADAPTED_MOTION_ID)
    compile_first()
    ready = ready_capture(path, options, all_frames=asked.all_frames)
    given = own or ConstraintFile(ready.annotations.constraints, None)
    if asked.constraints is not None:
        check_frames(given, ready, asked.constraints)
    contacts = ready.contacts if given.contacts is None else given.contacts
    constraints = tuple(each for each in given.constraints if each.enabled)
    rate, count = ready.motion.frame_rate, ready.motion.frame_count
    bodies = {
        key: each.body_over(0.0, rate, count) if each else ready.actor.morphology
        for key, each in asked.characters.items()
    }
    volumes = {key: each.volume if each else None for key, each in asked.characters.items()}
    actor = ready.actor.morphology
    requests = with_tracks(
        {
            key: AdaptRequest(
                ready.motion,
                body,
                contacts,
                constraints,
                asked.ground.seen_from(asked.places[key].position, asked.places[key].heading),
                volume=volumes[key],
                actor=actor,
                limited=asked.limited,
                eased=asked.eased,
                clears=asked.clears,
            )
            for key, body in bodies.items()
        },
        ready.capture,
        given.props,
        asked.places,
    )
    make_folder(folder)
    return {
        "source": str(path),
        "frames": ready.capture.frame_count - ready.capture.first_frame,
        "first_frame": ready.capture.first_frame,
        "frame_rate": ready.capture.frame_rate,
        "contacts": "detected" if given.contacts is None else "given",
        "cleaning": cleaning_records(ready.capture),
        "characters": [
            adapt_to(character, key, ready, requests[key], asked, folder / file_name(path, key, asked))
            for key, character in asked.characters.items()
        ],
    }


def adapt_to(
    character: Character | None, key: str, ready: ReadyCapture, request: AdaptRequest, asked: AdaptSettings, path: Path
) -> Record:
    """Write the file of one character, or of the actor for None, and return its part of the report."""
    place = asked.places[key]
    adapted, record = character_report(request, ready.source, ready.capture.first_frame, by_frame=asked.by_frame)
    if character is None:
        take = take_of_actor(adapted, ready.actor, ready.capture, request, place)
    else:
        along = (ready.capture, ready.actor) if asked.options.carries(path) else None
        take = replace(take_of_adapted(character.name, adapted, character, request, along), place=place)
    written = asked.options.applied_to(take, path)
    write_take(written, path)
    about = {
        "name": key,
        "file": str(path),
        "place": place_record(place),
        "carried_joints": sorted({*take.carried} & {*written.skeleton.names}),
    }
    return {**about, **record}


def check_frames(asked: ConstraintFile, ready: ReadyCapture, path: Path) -> None:
    """Raise StudioError for a contact beyond the end of the motion."""
    last = ready.capture.frame_count - 1
    for contact in asked.contacts or ():
        if contact.last > last:
            raise StudioError(f"{path}, contacts, {contact.point}: frame {contact.last} is after the last, {last}.")


def print_report(report: Record) -> None:
    """Print the report as tables: one line a character, one line a constraint and character."""
    print(f"{report['source']}: {report['frames']} frames at {report['frame_rate']:g} Hz\n")
    titles = ("character", *QUALITY_TITLES.values(), "us/frame")
    keys = (*QUALITY_TITLES, "microseconds_per_frame")
    rows = [[record["name"], *(f"{record[key]:.2f}" for key in keys)] for record in report["characters"]]
    print_table(titles, rows)
    lines = [
        [
            *(each["name"], record["name"], _residual(each), _yes(each["reached"])),
            *(f"{each['frames_held']} of {each['frames_asked']}", ", ".join(each["kept_by"]) or "-"),
        ]
        for record in report["characters"]
        for each in record["constraints"]
    ]
    if lines:
        print()
        print_table(("constraint", "character", "residual", "reached", "frames held", "kept off by"), lines)


def _residual(record: Record) -> str:
    if record["residual_deg"] is not None:
        return f"{record['residual_deg']:.3f} deg"
    return "-" if record["residual_mm"] is None else f"{record['residual_mm']:.3f} mm"


def _yes(reached: bool | None) -> str:
    return "never fully active" if reached is None else "yes" if reached else "no"
