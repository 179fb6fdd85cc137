"""Preparation of captures and characters for adaptation, shared by several verbs."""

from collections.abc import Container, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import chain, count
from pathlib import Path
from typing import TYPE_CHECKING

from studio.core.captures.annotations import Annotations
from studio.core.captures.capture import Capture
from studio.core.captures.contacts import CONTACT_POINTS, ContactInterval
from studio.core.errors import StudioError
from studio.core.grounds import Steps
from studio.core.markers.cleaning import cleaned_trial
from studio.core.markers.take import mapped_labels
from studio.core.mesh.character import Character
from studio.core.normalized.actor import SourceRig
from studio.core.normalized.motion import NormalizedMotion
from studio.core.normalized.normalize import captured_steps, detected_contacts, normalize_capture
from studio.core.solver.source import source_motion
from studio.io.importing import ImportOptions, known_of_motion, load_character, read_capture
from studio.io.json_text import JsonObject
from studio.io.project.character_file import bundled_characters
from studio.io.registry import ReadCapture, known_formats

if TYPE_CHECKING:
    from studio.core.quality.metrics import MotionPeaks

ADAPTED_MOTION_ID = "motion"


@dataclass(frozen=True, eq=False)
class ReadyCapture:
    """Capture that is ready for adaptation, with its normalised motion, its actor and its annotations."""

    capture: Capture
    motion: NormalizedMotion
    actor: SourceRig
    annotations: Annotations

    @property
    def contacts(self) -> tuple[ContactInterval, ...]:
        """Contacts of the file, else detected ones."""
        return self.annotations.contacts or ()

    @cached_property
    def source_peaks(self) -> "MotionPeaks":
        """Peaks of the motion on its own actor from its first frame on, with which those of adapted motions are
        compared.
        """
        from studio.core.quality.metrics import MotionPeaks  # late: what is told of a file need not wait for it

        played = source_motion(self.motion, self.actor)
        return MotionPeaks.of(played.frames(self.capture.first_frame, played.frame_count - 1))


def make_folder(folder: Path) -> None:
    """Make the folder and its parents. Raises StudioError if that fails."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise StudioError(f"The folder '{folder}' cannot be created: {error.strerror}. Choose another.") from error


def ready_capture(path: Path, options: ImportOptions, *, all_frames: bool = False) -> ReadyCapture:
    """Normalised humanoid capture of a file; ``all_frames`` keeps a calibration pose at its begin."""
    return ready_from_read(read_capture(path, options), path, all_frames=all_frames)


def ready_from_read(read: ReadCapture, path: Path, *, all_frames: bool = False) -> ReadyCapture:
    """Normalised humanoid capture of ``read``, which was read from ``path``."""
    capture = read.capture
    if capture.body_map is None:
        reasons = {guess.subject: guess.reason for guess in capture.guesses}
        if capture.markers is not None:
            raise StudioError(
                f"{path.name} cannot be adapted. {reasons.get('marker map', '')} Map its markers with --marker-map."
            )
        reason = reasons.get("body map", "")
        raise StudioError(f"{path.name} cannot be adapted. {reason} Map its joints with --body-map.")
    capture = capture.with_first_frame(0) if all_frames else capture
    return ready_from_capture(capture, known_of_motion(capture, read.annotations, ADAPTED_MOTION_ID))


def ready_from_capture(capture: Capture, annotations: Annotations | None = None) -> ReadyCapture:
    """Normalised capture; its contacts are detected if there are no ``annotations``."""
    annotations = annotations or Annotations(detected_contacts(capture, ADAPTED_MOTION_ID))
    return ReadyCapture(capture, *normalize_capture(capture), annotations)


def ready_on_steps(ready: ReadyCapture) -> tuple[ReadyCapture, Steps]:
    """Capture with its contacts on the steps on which it was recorded, and these steps. Raises StudioError if there are
    none.
    """
    steps = captured_steps(ready.capture)
    if steps is None:
        raise StudioError(
            f"'{ready.capture.name}' was not recorded on steps: its feet stand on one level, or at heights that are"
            " not evenly spaced. Leave out --on-steps."
        )
    contacts = detected_contacts(ready.capture, ADAPTED_MOTION_ID, on_steps=True)
    return replace(ready, annotations=replace(ready.annotations, contacts=contacts)), steps


def cleaning_records(capture: Capture) -> list[JsonObject]:
    """Records of the cleaning steps on the markers from which a body was solved; empty for a capture
    without markers.
    """
    if capture.markers is None or capture.body_map is None:
        return []
    take = capture.markers
    _, reports = cleaned_trial(take.trial.with_labels(mapped_labels(take)), take.steps)
    return [{"step": each.title, "summary": each.summary, "details": list(each.details)} for each in reports]


def spans_by_foot(contacts: Sequence[ContactInterval]) -> dict[str, list[list[int]]]:
    """Contacts for JSON: ``{"left_heel": [[first, last], ...], ...}``, with a key for every contact point and touch."""
    return {
        point.value: [[each.first, each.last] for each in contacts if each.point is point] for point in CONTACT_POINTS
    }


def chosen_characters(names: Sequence[str]) -> dict[str, Character]:
    """Bundled characters and character files by short name; all bundled ones if ``names`` is empty."""
    bundled = bundled_characters()
    if not names:
        return dict(bundled)
    twice = [name for index, name in enumerate(names) if name in names[:index]]
    if twice:
        raise StudioError(f"The character '{twice[0]}' is named twice. Name each one once.")
    chosen: dict[str, Character] = {}
    for name in names:
        character = bundled[name] if name in bundled else _character_file(name, tuple(bundled))
        chosen[_own_key(name if name in bundled else Path(name).stem, chosen)] = character
    return chosen


def _own_key(stem: str, taken: Container[str]) -> str:
    """Name ``stem``, or with a number (``hero_2``) if it is taken."""
    keys = chain([stem], (f"{stem}_{number}" for number in count(2)))
    return next(key for key in keys if key not in taken)


def _character_file(name: str, bundled: Sequence[str]) -> Character:
    path = Path(name)
    suffixes = known_formats().suffixes("character_reader")
    if path.suffix.lower() not in suffixes:
        raise StudioError(
            f"No character is called '{name}'. Bundled are {', '.join(bundled)}; or name a character's file"
            f" ({', '.join(suffixes)})."
        )
    return load_character(path).character
