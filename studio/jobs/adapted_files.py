"""Motion files of one capture, adapted to many characters, and the report on their quality."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from studio.core.errors import StudioError
from studio.core.grounds.ground import Ground
from studio.core.mesh.character import Character
from studio.core.solver.request import AdaptRequest
from studio.core.stage.placement import Placement
from studio.io.export import take_of_actor, take_of_adapted, write_take
from studio.io.export_options import ExportOptions
from studio.io.importing import ImportOptions
from studio.io.json_text import JsonObject
from studio.io.project.constraint_file import ConstraintFile, read_constraints
from studio.io.project.ground_file import read_ground
from studio.io.registry import known_formats
from studio.jobs.adapt_report import character_report, place_record
from studio.jobs.adaptation import (
    ADAPTED_MOTION_ID,
    ReadyCapture,
    chosen_characters,
    cleaning_records,
    make_folder,
    ready_capture,
    ready_on_steps,
)
from studio.jobs.run_tracks import with_tracks

ACTOR_WORD = "actor"
"""Name that stands for the body from which a capture was recorded."""


@dataclass(frozen=True)
class AdaptSettings:
    """Settings that apply to any capture: characters, constraints, ground, reading and writing.

    Files are named by their paths, so that another process can take the settings and read them.
    """

    characters: tuple[str, ...] = ()
    """Names of bundled characters, paths of character files, or ``ACTOR_WORD``; empty for all bundled characters."""
    places: Mapping[str, Placement] = field(default_factory=dict)
    """Placement of characters on the stage by name; by default the motion begins at its own position."""
    constraints: Path | None = None
    ground: Path | None = None
    """Path of the file of the ground; None for level ground at height 0."""
    on_steps: bool = False
    """True to stand on the steps on which a capture was recorded, instead of that ground."""
    suffix: str = ".bvh"
    reading: ImportOptions = field(default_factory=ImportOptions)
    writing: ExportOptions = field(default_factory=ExportOptions)
    all_frames: bool = False
    """True to keep a calibration pose at the begin of a file."""
    by_frame: bool = False
    """True to report each frame as well."""
    limited: bool = True
    """True to keep joints within the human range of motion."""
    eased: bool = True
    """True to smooth joints in time."""
    clears: bool = True
    """True to keep arms out of trunk, head and thighs."""

    @property
    def files(self) -> tuple[Path, ...]:
        """Files other than the capture on which a result depends."""
        named = tuple(Path(name) for name in self.characters if Path(name).is_file())
        return (*filter(None, (self.constraints, self.ground)), *named)

    @property
    def absolute(self) -> "AdaptSettings":
        """Settings with absolute paths, since another process may have another working folder."""
        return replace(
            self,
            characters=tuple(str(Path(name).resolve()) if Path(name).is_file() else name for name in self.characters),
            places={
                str(Path(name).resolve()) if Path(name).is_file() else name: each for name, each in self.places.items()
            },
            constraints=self.constraints and self.constraints.resolve(),
            ground=self.ground and self.ground.resolve(),
        )

    def cast(self) -> "Cast":
        """Load the characters and the ground. Raises StudioError for a character or format that does not exist."""
        known = known_formats().suffixes("motion_writer")
        if self.suffix not in known:
            raise StudioError(
                f"'{self.suffix.lstrip('.')}' is not a file format for motions: choose {', '.join(known)}."
            )
        self.writing.check(Path(f"motion{self.suffix}"))
        others = [name for name in self.characters if name != ACTOR_WORD]
        characters: dict[str, Character | None] = {ACTOR_WORD: None} if ACTOR_WORD in self.characters else {}
        if others or not characters:
            characters |= chosen_characters(others)
        ground = read_ground(self.ground) if self.ground else Ground()
        return Cast(characters, character_placements(self.places, characters), ground)


@dataclass(frozen=True)
class Cast:
    """Loaded characters of a run by name, their placements, and the ground on which they stand."""

    characters: Mapping[str, Character | None]
    """Characters by name; None for the body from which a capture was recorded."""
    places: Mapping[str, Placement]
    ground: Ground


def character_placements(places: Mapping[str, Placement], characters: Iterable[str]) -> dict[str, Placement]:
    """Placement of each of ``characters``. Raises StudioError for a placement of a character that is not among them."""
    found = dict.fromkeys(characters, Placement())
    for name, place in places.items():
        key = name if name in found else Path(name).stem
        if key not in found:
            raise StudioError(f"--place names '{name}', which is not among the characters: {', '.join(found)}.")
        found[key] = place
    return found


def file_name(capture: Path, key: str, suffix: str) -> str:
    """Name of the file of one character's motion."""
    return f"{capture.stem}_{key}{suffix}"


def adapt_file(path: Path, settings: AdaptSettings, cast: Cast, folder: Path) -> JsonObject:
    """Adapt one capture to all characters of the cast, write their files into ``folder``, and return the report.

    Raises StudioError if the bodies shall stand on the capture's steps and it has none.
    """
    own = None if settings.constraints is None else read_constraints(settings.constraints, ADAPTED_MOTION_ID)
    ready = ready_capture(path, settings.reading, all_frames=settings.all_frames)
    if settings.on_steps:
        ready, steps = ready_on_steps(ready)
        cast = replace(cast, ground=steps)
    given = own or ConstraintFile(ready.annotations.constraints, None)
    if settings.constraints is not None:
        check_frames(given, ready, settings.constraints)
    make_folder(folder)
    return {
        "source": str(path),
        "frames": ready.capture.frame_count - ready.capture.first_frame,
        "first_frame": ready.capture.first_frame,
        "frame_rate": ready.capture.frame_rate,
        "contacts": "detected" if given.contacts is None else "given",
        "cleaning": cleaning_records(ready.capture),
        "characters": [
            _adapt_to(cast, key, ready, request, settings, folder / file_name(path, key, settings.suffix))
            for key, request in _requests(ready, given, settings, cast).items()
        ],
    }


def _requests(
    ready: ReadyCapture, given: ConstraintFile, settings: AdaptSettings, cast: Cast
) -> dict[str, AdaptRequest]:
    """Request of each character, with the tracks of the objects that it follows."""
    rate, count, actor = ready.motion.frame_rate, ready.motion.frame_count, ready.actor.morphology
    requests = {
        key: AdaptRequest(
            ready.motion,
            character.body_over(0.0, rate, count) if character else actor,
            ready.contacts if given.contacts is None else given.contacts,
            tuple(each for each in given.constraints if each.enabled),
            cast.ground.seen_from(cast.places[key].position, cast.places[key].heading),
            volume=character.volume if character else None,
            actor=actor,
            limited=settings.limited,
            eased=settings.eased,
            clears=settings.clears,
        )
        for key, character in cast.characters.items()
    }
    return with_tracks(requests, ready.capture, given.props, cast.places)


def _adapt_to(
    cast: Cast, key: str, ready: ReadyCapture, request: AdaptRequest, settings: AdaptSettings, path: Path
) -> JsonObject:
    """Write the file of one character, and return its part of the report."""
    place, character = cast.places[key], cast.characters[key]
    adapted, record = character_report(
        request, ready.source_peaks, ready.capture.first_frame, by_frame=settings.by_frame
    )
    if character is None:
        take = take_of_actor(adapted, ready.actor, ready.capture, request, place)
    else:
        along = (ready.capture, ready.actor) if settings.writing.carries(path) else None
        take = replace(take_of_adapted(character.name, adapted, character, request, along), place=place)
    written = settings.writing.applied_to(take, path)
    write_take(written, path)
    about = {
        "name": key,
        "file": str(path),
        "place": place_record(place),
        "carried_joints": sorted({*take.carried_joints} & {*written.skeleton.names}),
    }
    return {**about, **record}


def check_frames(given: ConstraintFile, ready: ReadyCapture, path: Path) -> None:
    """Raise StudioError for a contact beyond the end of the motion."""
    last = ready.capture.frame_count - 1
    for contact in given.contacts or ():
        if contact.last > last:
            raise StudioError(f"{path}, contacts, {contact.point}: frame {contact.last} is after the last, {last}.")
