"""Indexing of folders of captures and S4D files into a catalogue; only changed files are read, one at a time.

A file that cannot be used is stored with the reason. A missing folder is reported, and the others are indexed.
"""

import os
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

from studio.core.body.morphology import Morphology
from studio.core.errors import StudioError
from studio.core.normalized.motion import NormalizedMotion
from studio.core.normalized.normalize import normalize_capture
from studio.core.normalized.realize import realize_motion
from studio.io.figure.kept_references import skeleton_digest, with_reference_kept
from studio.io.importing import known_of_motion, read_capture
from studio.io.registry import known_formats
from studio.library.catalogue import Catalogue, FileState
from studio.library.clip_labels import ClipLabel
from studio.library.hit_paths import HitPath, hit_path
from studio.library.library import Library
from studio.library.proposed_strikes import proposed_labels
from studio.resources_folder import bundled_strikes_folder

Progress = Callable[[float, str], object]
"""Callback for the fraction done (0 to 1) and the current activity; it may raise an exception to cancel."""


@dataclass(frozen=True)
class IndexReport:
    """Numbers of files that were ``read`` now, ``kept`` unchanged and ``forgotten``; ``problems`` by file or folder."""

    read: int
    kept: int
    forgotten: int
    problems: dict[str, str]


def index_folders(
    catalogue: Catalogue, folders: Iterable[Path], progress: Progress = lambda share, text: None
) -> IndexReport:
    """Index the captures in ``folders`` and their subfolders into the catalogue; entries of other folders stay.

    If ``progress`` cancels the work, files already read are kept. A missing folder keeps its entries.
    """
    roots = [folder.resolve() for folder in folders]
    problems = {str(root): "The folder is not there." for root in roots if not root.is_dir()}
    present = [root for root in roots if root.is_dir()]
    paths = sorted({path for root in present for path in captures_in(root)})
    known, read = catalogue.files(), 0
    gone = [name for name in catalogue.paths() if _below(name, present) and not os.path.exists(name)]
    if gone:
        with catalogue.write_transaction():
            for name in gone:
                catalogue.forget(name)
    for index, path in enumerate(paths):
        progress(index / len(paths), path.name)
        state, before = _state(path), known.get(str(path))
        if before is None or (before.size, before.changed) != (state.size, state.changed):
            before, read = _read(catalogue, path, state), read + 1
        if before.problem:
            problems[str(path)] = before.problem
    progress(1.0, "")
    return IndexReport(read, len(paths) - read, len(gone), problems)


def load_library(catalogue: Catalogue, progress: Progress = lambda share, text: None) -> Library:
    """Library of a catalogue; existing files whose entries are damaged are read again first."""
    if not catalogue.read_only:
        whole = catalogue.files()
        damaged = [Path(path) for path in catalogue.paths() if path not in whole and os.path.isfile(path)]
        for index, path in enumerate(damaged):
            progress(index / len(damaged), path.name)
            _read(catalogue, path, _state(path))
    return Library.of(catalogue)


def bundled_library() -> Library:
    """Library of the strikes that come with the studio; they are indexed in a temporary folder."""
    with TemporaryDirectory(ignore_cleanup_errors=True) as place, Catalogue(Path(place)) as catalogue:
        index_folders(catalogue, [bundled_strikes_folder()])
        return Library.of(catalogue)


def captures_in(folder: Path) -> list[Path]:
    """Paths of all files with the suffix of a capture in ``folder`` and its subfolders."""
    suffixes = known_formats().suffixes("capture_reader")
    return [path for path in folder.rglob("*") if path.suffix.lower() in suffixes and path.is_file()]


def correct_label(catalogue: Catalogue, clip_number: int, label: ClipLabel) -> None:
    """Replace the label of a clip by ``label``, confirmed by a person. Raises StudioError if the clip is gone."""
    clip = next((each for each in catalogue.clips() if each.number == clip_number), None)
    if clip is None:
        raise StudioError(
            "That clip is no longer in the motion library: its file went or was read again. Search again."
        )
    take = catalogue.takes().get(clip.take)
    if take is None or label.last >= take.motion.frame_count:
        raise StudioError(
            "The motion of that clip cannot be read any more. Search again, and it is read from its file."
        )
    path = _path_of(take.motion, catalogue.actors()[take.actor].body, label)
    with catalogue.write_transaction():
        catalogue.change_clip(clip_number, replace(label, confirmed=True), path)


def _read(catalogue: Catalogue, path: Path, state: FileState) -> FileState:
    try:
        file = read_capture(path)
        capture = file.capture
        if capture.body_map is None:
            raise StudioError("No human body was found in it.")
        with_reference_kept(capture)
        motion, performer = normalize_capture(capture)
        contacts = known_of_motion(capture, file.annotations, "").contacts or ()
    except StudioError as error:
        state = replace(state, problem=str(error))
        with catalogue.write_transaction():
            catalogue.store_file_state(str(path), state)
        return state
    with catalogue.write_transaction():
        said = catalogue.confirmed_labels(str(path))
        catalogue.store_file_state(str(path), state)
        actor = catalogue.actor(skeleton_digest(capture.skeleton), f"Actor of {capture.name}", performer.morphology)
        take = catalogue.add_take(str(path), actor, motion, contacts)
        proposed = _proposed(motion, performer.morphology, capture.first_frame)
        for label in said + labels_without_confirmed(said, proposed):
            if label.last < motion.frame_count:
                catalogue.add_clip(take, label, _path_of(motion, actor.body, label))
    return state


def labels_without_confirmed(said: list[ClipLabel], proposed: list[ClipLabel]) -> list[ClipLabel]:
    """Labels of ``proposed`` that no label of ``said`` replaces.

    Each label of ``said``, given by a person, replaces the nearest proposal that hits within its frames.
    """
    left = list(proposed)
    for label in said:
        meant = [each for each in left if label.first <= each.hit <= label.last]
        if meant:
            left.remove(min(meant, key=lambda each: (each.limb is not label.limb, abs(each.hit - label.hit))))
    return left


def _proposed(motion: NormalizedMotion, body: Morphology, first_frame: int) -> list[ClipLabel]:
    return proposed_labels(*realize_motion(motion, body, play=True), body, motion.frame_rate, first_frame)


def _path_of(motion: NormalizedMotion, body: Morphology, label: ClipLabel) -> HitPath:
    return hit_path(*realize_motion(motion, body), body, motion.frame_rate, label)


def _state(path: Path) -> FileState:
    try:
        found = path.stat()
    except OSError:
        return FileState(-1, -1)  # it was removed just now: reading it will report that
    return FileState(found.st_size, found.st_mtime_ns)


def _below(path: str, roots: list[Path]) -> bool:
    return any(Path(path).is_relative_to(root) for root in roots)
