"""Registry of file formats for captures, characters and motions, and recognition of a file's format.

A format is one file: functions to ``sniff``, ``read`` or ``write``, named by a ``Format`` here for the built-in ones,
or by an entry point of the group ``morpho_studio.formats`` for others (example: ``examples/formats/trace_format.py``).
"""

import hashlib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path
from pkgutil import resolve_name
from typing import TYPE_CHECKING, Any

from studio.core.captures.annotations import Annotations
from studio.core.errors import StudioError
from studio.core.plausible import BONE_RANGE, TRAVEL_RANGE
from studio.io import plug_ins
from studio.io.referenced_files import SNIFFED_BYTES, refuse_archive, refuse_devices, refuse_other_kind, refuse_stand_in

if TYPE_CHECKING:
    from studio.core.captures.capture import Capture, Guess
    from studio.core.mesh.character import Character
    from studio.io.export import Take
    from studio.io.importing import ImportOptions
    from studio.io.takes.exported_stage import ExportedStage

Progress = Callable[[float, str], None]
"""Callback for a fraction from 0 to 1 and the current activity; it may raise an exception to cancel."""

_EARLIER = "It was written for an earlier version of the studio: docs/formats.md tells what a format is now."


@dataclass(frozen=True)
class ImportReport:
    """Assumptions and repairs made while reading a file."""

    guesses: tuple["Guess", ...] = ()
    repairs: tuple[str, ...] = ()


@dataclass(frozen=True)
class ReadCapture:
    """Capture read from a file with all its annotations, in one pass."""

    capture: "Capture"
    """Capture in world axes and metres."""
    annotations: Annotations = Annotations()
    """Contacts, constraints and labels in the file; they refer to no motion yet."""
    interpret: "Callable[[ImportOptions, Progress], Capture] | None" = None
    """Function that makes the capture again with other options, without reading the file; None if the file
    is needed.
    """

    @property
    def report(self) -> ImportReport:
        """Assumptions and repairs of the capture."""
        return ImportReport(self.capture.guesses, self.capture.repairs)


@dataclass(frozen=True)
class ReadCharacter:
    """Character read from a file, with the assumptions and repairs made."""

    character: "Character"
    guesses: tuple["Guess", ...] = ()
    repairs: tuple[str, ...] = ()
    joints: Mapping[str, str] = field(default_factory=dict)
    """Names of the file's own joints by part, if it has joints."""
    moves: bool = False
    """True if the file also holds a motion, which can be read as a capture."""


@dataclass(frozen=True)
class Format:
    """File format: its suffixes, and the functions that recognise, read and write it.

    Each function is given as ``module:function``, and imported when first needed; an empty text is for none. All raise
    StudioError with file, place and what to do. A reader returns its guesses and repairs with the content; a writer
    writes the whole file or none (``studio.io.atomic_write``).
    """

    name: str
    suffixes: tuple[str, ...]
    """Suffixes in lower case, with their dot."""
    sniff: str = ""
    """``(head: bytes) -> bool``: True if a file that begins with these bytes has this format; in a module that is light
    to import.
    """
    capture_reader: str = ""
    """``(path, options: ImportOptions, progress: Progress) -> ReadCapture``."""
    character_reader: str = ""
    """``(path, options: ImportOptions, progress: Progress) -> ReadCharacter``."""
    reader: str = ""
    """``(path, options, progress) -> ReadCapture | ReadCharacter``, for a format with both readers: the content of the
    file decides. Without it every file of such a format is read as a character.
    """
    motion_writer: str = ""
    """``(path, take: Take, progress: Progress) -> None``."""
    stage_writer: str = ""
    """``(path, stage: ExportedStage, progress: Progress) -> None``: all performers and props in one file."""
    character_writer: str = ""
    """``(path, character: Character, progress: Progress) -> None``."""
    packed: str = ""
    """Kind of archive, ``gzip`` or ``ZIP``, that files of this format may be; its reader reports what is wrong with
    one.
    """

    @property
    def reads(self) -> list[str]:
        """Kinds of content that can be read: ``capture``, ``character``."""
        return [what for what in ("capture", "character") if getattr(self, f"{what}_reader")]

    @property
    def writes(self) -> list[str]:
        """Kinds of content that can be written: ``motion``, ``stage``, ``character``."""
        return [what for what in ("motion", "stage", "character") if getattr(self, f"{what}_writer")]

    def recognises(self, head: bytes) -> bool:
        """True if a file that begins with ``head`` has this format."""
        return bool(self.sniff) and bool(self._function("sniff")(head))

    def read(self, path: Path, options: "ImportOptions", progress: Progress) -> ReadCapture | ReadCharacter:
        """Capture or character in the file at ``path``. Raises StudioError."""
        if not self.reader:
            return (self.read_character if self.character_reader else self.read_capture)(path, options, progress)
        read: ReadCapture | ReadCharacter = self._function("reader")(path, options, progress)
        return read if isinstance(read, ReadCharacter) else self._checked(read, path)

    def read_capture(self, path: Path, options: "ImportOptions", progress: Progress) -> ReadCapture:
        """Capture in the file at ``path`` with its annotations. Raises StudioError."""
        return self._checked(self._function("capture_reader")(path, options, progress), path)

    def read_character(self, path: Path, options: "ImportOptions", progress: Progress) -> ReadCharacter:
        """Character in the file at ``path``. Raises StudioError."""
        read: ReadCharacter = self._function("character_reader")(path, options, progress)
        return read

    def _checked(self, read: ReadCapture, path: Path) -> ReadCapture:
        """``read`` with a check of the capture's size, also when interpreted again; raises StudioError."""
        if not isinstance(read, ReadCapture):
            kind = type(read).__name__
            raise StudioError(f"{path.name}: the reader of {self.name} returns a {kind}, not a ReadCapture. {_EARLIER}")
        _check_size(read.capture, path)

        def interpret(options: "ImportOptions", progress: Progress) -> "Capture":
            if read.interpret is None:
                return self.read_capture(path, options, progress).capture
            capture = read.interpret(options, progress)
            _check_size(capture, path)
            return capture

        return replace(read, interpret=interpret)

    def write_motion(self, path: Path, take: "Take", progress: Progress) -> None:
        """Write the motion of a take, the whole file or none of it. Raises StudioError."""
        self._function("motion_writer")(path, take, progress)

    def write_stage(self, path: Path, stage: "ExportedStage", progress: Progress) -> None:
        """Write a stage, the whole file or none of it. Raises StudioError."""
        self._function("stage_writer")(path, stage, progress)

    def write_character(self, path: Path, character: "Character", progress: Progress) -> None:
        """Write a character, the whole file or none of it. Raises StudioError."""
        self._function("character_writer")(path, character, progress)

    def _function(self, job: str) -> Callable[..., Any]:
        name = getattr(self, job)
        if not name:
            raise StudioError(f"The studio has no {job.replace('_', ' ')} for {self.name}.")
        try:
            function: Callable[..., Any] = resolve_name(name)
        except Exception as error:  # a module may raise anything while it is imported
            raise StudioError(f"The {job.replace('_', ' ')} of {self.name} could not be loaded: {error}.") from error
        return function


OWN_FORMATS = (
    Format(
        name="BVH",
        suffixes=(".bvh",),
        sniff="studio.io.bvh.format:is_bvh",
        capture_reader="studio.io.bvh.capture:load_bvh",
        motion_writer="studio.io.bvh.format:write_take",
    ),
    Format(
        name="FBX",
        suffixes=(".fbx",),
        sniff="studio.io.fbx.reading:is_fbx",
        capture_reader="studio.io.fbx.format:load_capture",
        character_reader="studio.io.fbx.format:load_character",
        reader="studio.io.fbx.format:load_either",
        motion_writer="studio.io.fbx.take_writer:write_take",
        stage_writer="studio.io.fbx.stage_writer:write_stage",
    ),
    Format(
        name="S4D",
        suffixes=(".s4d",),
        sniff="studio.io.s4d.format:is_s4d",
        capture_reader="studio.io.s4d.format:load_s4d",
        motion_writer="studio.io.s4d.format:write_take",
        packed="ZIP",
    ),
    Format(
        name="glTF",
        suffixes=(".glb", ".gltf"),
        sniff="studio.io.gltf.container:is_gltf",
        capture_reader="studio.io.gltf.capture:load_gltf",
        character_reader="studio.io.gltf.character:load_character",
        reader="studio.io.gltf.format:load_either",
        motion_writer="studio.io.gltf.take_writer:write_take",
        stage_writer="studio.io.gltf.take_writer:write_stage",
    ),
    Format(
        name="VRM",
        suffixes=(".vrm",),
        sniff="studio.io.gltf.container:is_gltf",
        character_reader="studio.io.gltf.character:load_character",
    ),
    Format(
        name="VRM animation",
        suffixes=(".vrma",),
        sniff="studio.io.gltf.container:is_gltf",
        capture_reader="studio.io.gltf.capture:load_gltf",
        motion_writer="studio.io.gltf.vrma_writer:write_take",
    ),
    Format(
        name="USD",
        suffixes=(".usd", ".usda", ".usdc", ".usdz"),
        sniff="studio.io.usd.format:is_usd",
        capture_reader="studio.io.usd.format:load_capture",
        character_reader="studio.io.usd.format:load_character",
        reader="studio.io.usd.format:load_either",
        motion_writer="studio.io.usd.writer:write_take",
        stage_writer="studio.io.usd.writer:write_stage",
    ),
    Format(
        name="Table of joints",
        suffixes=(".csv",),
        motion_writer="studio.io.joint_tables:write_csv",
    ),
    Format(
        name="NumPy arrays of joints",
        suffixes=(".npz",),
        motion_writer="studio.io.joint_tables:write_npz",
    ),
    Format(
        name="X3D",
        suffixes=(".x3d",),
        sniff="studio.io.hanim:is_x3d",
        character_reader="studio.io.hanim.character:load_x3d",
    ),
    Format(
        name="VRML",
        suffixes=(".wrl", ".x3dv", ".vrml"),
        sniff="studio.io.hanim:is_vrml",
        character_reader="studio.io.hanim.character:load_vrml",
        packed="gzip",
    ),
    Format(
        name="C3D",
        suffixes=(".c3d",),
        sniff="studio.io.c3d.format:is_c3d",
        capture_reader="studio.io.c3d.capture:load_c3d",
        motion_writer="studio.io.c3d.format:write_take",
    ),
    Format(
        name="TRC",
        suffixes=(".trc",),
        sniff="studio.io.trc.format:is_trc",
        capture_reader="studio.io.trc.capture:load_trc",
    ),
    Format(
        name="AMC with ASF",
        suffixes=(".amc",),
        sniff="studio.io.acclaim.format:is_acclaim",
        capture_reader="studio.io.acclaim.capture:load_acclaim",
    ),
    Format(
        name="Morpho Studio character",
        suffixes=(".json",),
        sniff="studio.io.project.character_file:is_character",
        character_reader="studio.io.project.character_file:load_character",
        character_writer="studio.io.project.character_file:save_character",
    ),
)


def _check_size(capture: "Capture", path: Path) -> None:
    try:
        BONE_RANGE.check(capture.skeleton.offsets[1:])
        BONE_RANGE.check(capture.poses.local_translations[:, 1:])
        TRAVEL_RANGE.check(capture.poses.local_translations[:, 0])
    except ValueError as error:
        raise StudioError(f"{path.name}: {error} Export it in the right unit, or set its unit.") from error


@dataclass(frozen=True)
class KnownFormats:
    """All known formats, and one error message for each entry point that failed."""

    formats: tuple[Format, ...]
    failures: tuple[str, ...]

    def that_can(self, job: str) -> tuple[Format, ...]:
        """Formats with a function for ``job``, which is a field of ``Format`` such as ``capture_reader``."""
        return tuple(known for known in self.formats if getattr(known, job))

    def suffixes(self, *jobs: str) -> tuple[str, ...]:
        """Unique suffixes of all formats that support one of ``jobs``."""
        found = (suffix for job in jobs for known in self.that_can(job) for suffix in known.suffixes)
        return tuple(dict.fromkeys(found))


@lru_cache(maxsize=1)
def known_formats() -> KnownFormats:
    """Built-in and installed formats; failures are listed, never raised."""
    names = {known.name for known in OWN_FORMATS}

    def accepted(added: object) -> Format:
        if not isinstance(added, Format):
            raise StudioError(f"{added!r:.60} is not a studio.io.registry.Format.")
        if added.name in names:
            raise StudioError(f"there is already a format called {added.name}.")
        names.add(added.name)
        return added

    loaded = plug_ins.load_all(plug_ins.FORMATS_GROUP, accepted)
    failures = (f"{each} {_EARLIER}" if "Format.__init__" in each else each for each in loaded.failures)
    return KnownFormats((*OWN_FORMATS, *loaded.found), tuple(failures))


@dataclass(frozen=True)
class Recognised:
    """Format of a file, and the SHA-256 of its content in hexadecimal digits."""

    format: Format
    digest: str


def format_of(path: Path, *jobs: str) -> Format:
    """Format of a file that supports one of ``jobs``, recognised by its first bytes, else by its suffix.

    Formats of the suffix are tried first, so that no other one is imported needlessly. Raises StudioError if there is
    none.
    """
    return recognise(path, *jobs).format


def recognise(path: Path, *jobs: str) -> Recognised:
    """Format of a file that supports one of ``jobs``, and the digest of its content, from one pass over its bytes."""
    head, digest = _head_and_digest(path)
    return Recognised(_format_of(path, head, jobs), digest)


def _format_of(path: Path, head: bytes, jobs: tuple[str, ...]) -> Format:
    known = known_formats()
    candidates = [each for each in known.formats if any(getattr(each, job) for job in jobs)]
    by_suffix = [each for each in candidates if path.suffix.lower() in each.suffixes]
    others = (each for each in candidates if each not in by_suffix)
    found = next(_recognising([*by_suffix, *others], head), None)
    if found is None:
        refuse_stand_in(path.name, head)
        refuse_archive(path.name, head, {each.packed for each in by_suffix})
        refuse_other_kind(path.name, head)
        found = next(iter(by_suffix), None)
    if found is None:
        kinds = " or ".join(job.removesuffix("_reader") for job in jobs)
        names = ", ".join(each.name for each in candidates)
        raise StudioError(
            " ".join((f"{path.name} is not a {kinds} the studio reads. It reads {names}.", *known.failures))
        )
    return found


def _recognising(candidates: list[Format], head: bytes) -> Iterator[Format]:
    return (each for each in candidates if each.recognises(head))


def _head_and_digest(path: Path) -> tuple[bytes, str]:
    refuse_devices(path)
    try:
        with path.open("rb") as file:
            head = file.read(SNIFFED_BYTES)
            file.seek(0)
            return head, hashlib.file_digest(file, "sha256").hexdigest()
    except OSError as error:
        raise StudioError(f"{path.name} could not be read: {error.strerror}. Check the file and try again.") from error
