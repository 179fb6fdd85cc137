"""The user's corrections of import settings, stored by kind of file and applied to the next file of the same kind."""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from studio.core.body.canonical import BodyPart
from studio.core.captures.capture import Capture
from studio.core.errors import StudioError
from studio.io.importing import ImportOptions
from studio.io.registry import Progress, ReadCapture

Options = dict[str, Any]
"""Fields of ImportOptions with their values, as JSON has them."""
_LASTING_REFERENCES = ("zero", "0")
"""Reference poses that exist in every file of a kind. A pose from another frame is stored as rotations, because frames
differ between files.
"""
_ABSENT = {part.value: "" for part in BodyPart if part not in (BodyPart.ABDOMEN, BodyPart.THORAX)}
"""Body map in which no joint is assigned to any part, the spine aside; the base of stored body maps."""
_SUBJECTS = {"unit": "unit", "up_axis": "up axis", "frame_rate": "frame rate", "floor": "floor", "body_map": "body map"}


@dataclass(frozen=True)
class ReadAs:
    """Options with which a capture was read, for telling the user's corrections from values of the file and guesses."""

    kind: str
    given: Options
    options: ImportOptions

    def corrections(self, capture: Capture) -> Options:
        """Options that the user has corrected on ``capture`` and that make sense for other files of the same kind."""
        guessed = {guess.subject for guess in capture.guesses}
        said = {
            option: value
            for option, value in values_of(capture).items()
            if _SUBJECTS[option] not in guessed and value != self.given[option]
        }
        reference = self.options.reference
        if reference is None or "reference pose" in guessed:
            return said
        pose = dict(zip(capture.skeleton.names, capture.reference_rotations.tolist(), strict=True))
        return said | {"reference": reference if reference in _LASTING_REFERENCES else pose}


def kind_of(capture: Capture) -> str:
    """Key shared by files of one program and skeleton: a hash of suffix, joint names, hierarchy and frame rate."""
    head = [Path(capture.source).suffix.lower(), capture.skeleton.names, capture.skeleton.parents.tolist()]
    return hashlib.sha256(json.dumps([*head, round(capture.frame_rate, 3)]).encode()).hexdigest()[:16]


def values_of(capture: Capture) -> Options:
    """Current value of every import option of a capture, whether guessed or not."""
    return {
        "unit": capture.unit,
        "up_axis": capture.up_axis,
        "frame_rate": capture.frame_rate,
        "floor": capture.floor,
        "body_map": _ABSENT | capture.body_map.to_json(capture.skeleton) if capture.body_map else None,
    }


def with_corrections(
    read: ReadCapture, options: ImportOptions, known: Mapping[str, Options], progress: Progress
) -> tuple[Capture, ReadAs]:
    """Capture of a file read with ``options``, to which the corrections of its kind of file are applied.

    ``known`` are the corrections by kind of file. Corrections that cannot be applied are listed among the capture's
    repairs.
    """
    capture = read.capture
    read_as = ReadAs(kind_of(capture), values_of(capture), options)
    wanted = known.get(read_as.kind)
    if not wanted or options != ImportOptions() or read.interpret is None:
        return capture, read_as
    try:
        corrected = ImportOptions(**wanted)
        return read.interpret(corrected, progress), replace(read_as, options=corrected)
    except (StudioError, TypeError) as error:
        sentence = (
            f"{capture.source}: import settings that you corrected for a similar file could not be applied. {error}"
        )
        return replace(capture, repairs=(*capture.repairs, sentence)), read_as


def corrections_text(corrections: Options) -> str:
    """Corrections as text, for example ``unit inch, floor 0.1``."""
    return ", ".join(
        option.replace("_", " ") + ("" if isinstance(value, dict) else f" {value}")
        for option, value in corrections.items()
    )
