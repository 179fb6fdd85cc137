"""Import of a capture or a character from a file of any format, with the user's settings."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from studio.core.captures.annotations import Annotations
from studio.core.captures.capture import Capture
from studio.core.names import readable_name
from studio.io.registry import Progress, ReadCapture, ReadCharacter, format_of, recognise

if TYPE_CHECKING:
    from studio.core.markers.cleaning import Step
    from studio.core.markers.marker_map import MarkerMap


@dataclass(frozen=True)
class ImportOptions:
    """Import settings of the user; a value of None is guessed, and the guess is listed."""

    unit: str | None = None
    """Unit: ``m``, ``dm``, ``cm``, ``mm``, ``inch``, ``foot``, ``cmu``, ``unknown``, or metres per unit as a number."""
    up_axis: str | None = None
    """Up axis: ``X``, ``-Y`` and so on, or a direction of the file, such as ``0.1 -0.98 0.2``."""
    frame_rate: float | None = None
    floor: float | None = None
    """Height of the ground in metres."""
    body_map: Mapping[str, str] | None = None
    """Joints by part, as in ``BodyMap.to_json``, "" for a missing part; parts left out are guessed."""
    reference: str | Mapping[str, Sequence[float]] | None = None
    """Reference pose: ``zero``, the number of a frame, or local rotations (x, y, z, w) by joint."""
    clean: bool = False
    """True to remove spikes, exchanged limbs and tremble from a motion that was estimated from images or depth."""
    marker_map: "MarkerMap | None" = None
    """Markers of an optical capture by role."""
    marker_steps: "tuple[Step, ...] | None" = None
    """Cleaning steps of the markers; None for the default, which fills gaps."""


GUESS_ALL = ImportOptions()
"""Import options with which everything is guessed."""


def read_file(
    path: Path | str, options: ImportOptions = GUESS_ALL, progress: Progress | None = None
) -> ReadCapture | ReadCharacter:
    """Capture or character in the file at ``path``. Raises StudioError with file, line and what to do."""
    path = Path(path)
    found = recognise(path, "capture_reader", "character_reader")
    read = found.format.read(path, options, progress or _unheard)
    return read if isinstance(read, ReadCharacter) else _identified(read, found.digest)


def read_capture(path: Path | str, options: ImportOptions = GUESS_ALL, progress: Progress | None = None) -> ReadCapture:
    """Capture in the file at ``path`` with its annotations, read in one pass.

    ``progress`` is called with a fraction from 0 to 1 and a text. Raises StudioError with file, line and what to do if
    the file is damaged or the options do not fit it.
    """
    path = Path(path)
    found = recognise(path, "capture_reader")
    return _identified(found.format.read_capture(path, options, progress or _unheard), found.digest)


def _identified(read: ReadCapture, digest: str) -> ReadCapture:
    """Capture that was read, with the ``digest`` of its file, also when it is interpreted again."""
    inner = read.interpret

    def interpret(options: ImportOptions, progress: Progress) -> Capture:
        assert inner is not None  # Format.read gives one to every capture
        return _of_file(inner(options, progress), digest)

    return replace(read, capture=_of_file(read.capture, digest), interpret=interpret)


def _of_file(capture: Capture, digest: str) -> Capture:
    """Capture with the digest of its file, and with a file name that can be written as text."""
    return replace(
        capture, digest=digest, source=readable_name(capture.source), repairs=tuple(map(readable_name, capture.repairs))
    )


def load_capture(path: Path | str, options: ImportOptions = GUESS_ALL, progress: Progress | None = None) -> Capture:
    """Capture in the file at ``path``, without annotations. Raises StudioError with file, line and what to do."""
    return read_capture(path, options, progress).capture


def known_of_motion(capture: Capture, said: Annotations, motion_id: str) -> Annotations:
    """Annotations ``said`` by a motion's file; contacts are detected if the file has none."""
    from studio.core.normalized.normalize import detected_contacts  # late: it loads kernels

    said = said.of_motion(motion_id)
    return said if said.contacts is not None else replace(said, contacts=detected_contacts(capture, motion_id))


def load_character(
    path: Path | str, options: ImportOptions = GUESS_ALL, progress: Progress | None = None
) -> ReadCharacter:
    """Character in the file at ``path`` with the guesses about it. Raises StudioError with file, line and
    what to do.
    """
    path = Path(path)
    return format_of(path, "character_reader").read_character(path, options, progress or _unheard)


def _unheard(_share: float, _text: str) -> None:
    pass
