"""Import of captures: read in the background, contacts detected, played by the visible bodies; one undo step."""

import math
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import Any

from studio.app.import_corrections import ReadAs, corrections_text, values_of, with_corrections
from studio.app.relinking import offer_relinking, source_finder
from studio.app.workbench import Workbench
from studio.core.captures.annotations import Annotations
from studio.core.captures.capture import Capture
from studio.core.captures.contacts import ContactInterval
from studio.core.captures.remarks import remarks_on
from studio.core.errors import StudioError
from studio.core.grounds import Steps
from studio.core.grounds.slope import direction_vector
from studio.core.markers.take import MarkerTake
from studio.core.solver.performers.rows import stage_span
from studio.core.stage.clip import Clip
from studio.core.stage.project import GROUND_ID, Motion, Project, new_id
from studio.core.stage.staging import (
    is_unarranged,
    performers_in_row,
    performers_side_by_side,
    swept_points,
    travel_heading,
)
from studio.document.document import Document
from studio.io.figure.kept_references import with_reference_kept
from studio.io.importing import GUESS_ALL, ImportOptions, known_of_motion, read_capture, read_file
from studio.io.registry import Progress, ReadCapture, ReadCharacter
from studio.io.source_files import SourceMissing
from studio.panels.message_strip import Lifetime

PROJECT_UNCHANGED = "Your project was not changed."
READING_FRACTION = 0.7


@dataclass(frozen=True)
class ReadMotion:
    """Result of the background task: a capture, its annotations, and the id that its motion will have."""

    capture: Capture
    annotations: Annotations
    read_as: ReadAs
    motion_id: str
    path: Path | None = None
    """File from which the capture was read; None if the body was solved again from markers stored in the project."""


def read_motion(
    path: Path,
    options: ImportOptions,
    progress: Progress,
    known: Mapping[str, dict[str, Any]] = MappingProxyType({}),
    expect: Callable[[Capture], object] = lambda _capture: None,
) -> ReadMotion:
    """Read a capture file and detect its contacts.

    Raises StudioError whose last sentence says that nothing was changed. ``known`` are the corrections of earlier
    files, by kind of file; ``expect`` is called with the capture as soon as it is read.
    """
    with project_unchanged_on_error():
        read = read_capture(path, options, _reading(progress))
        return read_motion_ready(read, path, options, progress, known, expect)


def read_capture_or_character(
    path: Path,
    progress: Progress,
    known: Mapping[str, dict[str, Any]],
    expect: Callable[[Capture], object],
) -> ReadMotion | ReadCharacter:
    """Read a file that holds a capture or a character. Arguments and errors are those of ``read_motion``."""
    with project_unchanged_on_error():
        read = read_file(path, GUESS_ALL, _reading(progress))
        return (
            read
            if isinstance(read, ReadCharacter)
            else read_motion_ready(read, path, GUESS_ALL, progress, known, expect)
        )


def read_motion_ready(
    read: ReadCapture,
    path: Path | None,
    options: ImportOptions,
    progress: Progress,
    known: Mapping[str, dict[str, Any]] = MappingProxyType({}),
    expect: Callable[[Capture], object] = lambda _capture: None,
) -> ReadMotion:
    """Motion to be added to a project, made from the capture just read: with corrections applied and contacts detected.
    Arguments are those of ``read_motion``.
    """
    from studio.core.normalized.floor_guesses import with_floor_reported  # what computes is loaded after the window

    capture, read_as = with_corrections(read, options, known, _reading(progress))
    capture = with_floor_reported(capture)
    capture = with_reference_kept(capture)
    expect(capture)
    progress(READING_FRACTION, "detecting contacts")
    remarks_on(capture)  # here, beside the window, whose views show them
    motion_id = new_id()
    return ReadMotion(capture, known_of_motion(capture, read.annotations, motion_id), read_as, motion_id, path)


@contextmanager
def project_unchanged_on_error() -> Iterator[None]:
    """Context that adds to every StudioError that the project is unchanged."""
    try:
        yield
    except StudioError as error:
        raise StudioError(f"{error} {PROJECT_UNCHANGED}") from error


def _reading(progress: Progress) -> Progress:
    return lambda share, text: progress(READING_FRACTION * share, text)


def import_motion(bench: Workbench, path: Path, options: ImportOptions = GUESS_ALL) -> int:
    """Read a capture file in the background, then play it on the visible characters. Returns the id of the task."""
    known = bench.settings.corrections

    def read(progress: Progress) -> ReadMotion:
        return read_motion(path, options, progress, known, bench.live.prefetch_capture)

    task: int = bench.runner.run(f"Opening {path.name}", read, lambda motion: show_import(bench, path, motion))
    return task


def show_import(bench: Workbench, path: Path, motion: ReadMotion) -> None:
    """Add a motion that was read from ``path`` to the project and the stage, and report repairs."""
    add_read_motion(bench.document, motion, f"Import {path.name}")
    capture_id = list(bench.document.project.captures)[-1]
    bench.sources[capture_id] = path
    bench.settings.remember_source(path)
    bench.read_as[capture_id] = motion.read_as
    report_repairs(bench, capture_id)
    report_corrections(bench, capture_id)


def add_read_motion(document: Document, read: ReadMotion, text: str) -> str:
    """Add capture, motion and contacts to the project, and the clip to the visible bodies: one undo step."""
    bodies = [] if document.project.performers else _bundled_bodies()
    with document.group(text):
        for character, performer in bodies:
            character_id = document.add("characters", character, text)
            document.add("performers", replace(performer, character_id=character_id), text)
        capture_id = add_motion(document, read, text)
        _perform(document, read.motion_id, text)
    if document.selection.of("captures"):
        document.selection.set(("captures", capture_id))
    show_motion(document)
    if read.capture.markers is not None and read.capture.body_map is None:
        _show_markers(document, capture_id)
    return read.motion_id


def add_motion(document: Document, read: ReadMotion, text: str) -> str:
    """Add a capture, its motion and annotations to the project, without a performer; returns the capture's id."""
    capture_id = document.add("captures", read.capture, text)
    document.put_all("motions", {read.motion_id: Motion(read.capture.name, capture_id)}, text)
    _annotate(document, read.annotations, text)
    return capture_id


def play_capture(bench: Workbench, capture_id: str) -> None:
    """Let the visible bodies play a capture of the project."""
    document = bench.document
    motions = document.project.motions
    motion_id = next((key for key, motion in motions.items() if motion.capture_id == capture_id), None)
    if motion_id is None:
        return
    text = f"Play {motions[motion_id].name}"
    with document.group(text):
        _perform(document, motion_id, text)
    show_motion(document)


def reimport(bench: Workbench, capture_id: str, option: dict[str, Any]) -> None:
    """Read the capture again with the user's options, and replace it in one undo step."""
    what, value = next(iter(option.items()))
    capture = bench.document.project.captures[capture_id]
    text = f"Clean {capture.name}" if what == "clean" else f"Set {what.replace('_', ' ')} of {capture.name} to {value}"
    reread_capture(bench, capture_id, ImportOptions(**user_options(bench, capture_id) | option), text)


def resolve_markers(bench: Workbench, capture_id: str, take: MarkerTake) -> int:
    """Solve the body again from the markers ``take`` of a capture. Returns the id of the task."""
    text = f"Re-solve {bench.document.project.captures[capture_id].name}"
    return reread_capture(bench, capture_id, ImportOptions(**user_options(bench, capture_id)), text, take)


def stand_on_steps(bench: Workbench, capture_id: str) -> int:
    """Make the steps on which a capture was recorded the ground, with foot contacts on them: one undo step. Returns the
    id of the task.
    """
    capture = bench.document.project.captures[capture_id]
    text = f"Use steps of {capture.name} as ground"

    def find(progress: Progress) -> tuple[Steps | None, tuple[ContactInterval, ...]]:
        from studio.core.normalized.normalize import captured_steps, detected_contacts  # late: it loads kernels

        progress(0.1, "detecting contacts")
        return captured_steps(capture), detected_contacts(capture, "", on_steps=True)

    def done(found: tuple[Steps | None, tuple[ContactInterval, ...]]) -> None:
        document, (steps, contacts) = bench.document, found
        if steps is None or document.project.captures.get(capture_id) is not capture:
            return
        with document.group(text):
            ground = _on_stage(steps, capture_id, document)
            document.replace("grounds", GROUND_ID, ground, text)
            replace_motion(document, capture_id, capture.without_guess("steps"), Annotations(contacts), text)

    task: int = bench.runner.run(text, find, done)
    return task


def _on_stage(steps: Steps, capture_id: str, document: Document) -> Steps:
    """``steps`` moved from the space of their motion to the stage: to the active performer if it plays the motion, else
    to the first one that does.
    """
    project, active = document.project, document.active_performer_id
    playing = [
        key
        for key, each in project.performers.items()
        if each.clips and project.motions[each.clips[0].motion_id].capture_id == capture_id
    ]
    if not playing:
        return steps
    performer = project.performers[active if active in playing else playing[0]]
    turned = math.hypot(*steps.start) * direction_vector(math.atan2(*steps.start[::-1]) + performer.heading)
    start = tuple((turned + performer.position).tolist())
    return replace(steps, start=start, direction=steps.direction + performer.heading)


def reread_capture(
    bench: Workbench, capture_id: str, options: ImportOptions, text: str, take: MarkerTake | None = None
) -> int:
    """Read a capture again with other import options, from its markers if it has some, else from its file. Returns the
    id of the task.
    """
    capture = bench.document.project.captures[capture_id]
    markers = take or capture.markers
    find = source_finder(bench, capture_id)

    def read(progress: Progress) -> ReadMotion:
        if markers is None:
            return read_motion(find(progress).path, options, progress)
        from studio.io.markers.capture import capture_of_take  # late: it loads kernels

        chosen = replace(options, body_map=None, marker_map=None)
        with project_unchanged_on_error():
            solved = capture_of_take(markers, chosen, capture.repairs, _reading(progress))
            return read_motion_ready(ReadCapture(solved), None, chosen, progress)

    def done(motion: ReadMotion) -> None:
        if capture_id in bench.document.project.captures:
            old = bench.document.project.captures[capture_id]
            if capture_id in bench.read_as:
                bench.read_as[capture_id] = replace(bench.read_as[capture_id], options=options)
            replace_motion(bench.document, capture_id, motion.capture, motion.annotations, text)
            report_repairs(bench, capture_id)
            if motion.path is not None:
                bench.sources[capture_id] = motion.path
                if old.digest not in ("", motion.capture.digest):
                    bench.post_message(
                        f"The content of {motion.path} has changed since it was imported.",
                        until=Lifetime.PROJECT_OPENED,
                    )

    def missed(error: StudioError) -> None:
        if isinstance(error, SourceMissing):
            again = partial(reread_capture, bench, capture_id, options, text)
            offer_relinking(bench, capture_id, error, again)

    task: int = bench.runner.run(text, read, done, missed)
    return task


def report_repairs(bench: Workbench, capture_id: str) -> None:
    """Show a message about repairs made while reading, with a link to the import report. Without repairs, the last
    message is removed.
    """
    capture = bench.document.project.captures[capture_id]
    if capture.markers is not None and capture.body_map is None:
        ask = ("Markers…", lambda: bench.window.inspector.markers_requested.emit(capture_id))
        held = next(guess.reason for guess in capture.guesses if guess.subject == "marker map").partition(".")[0]
        bench.post_message(
            f"No skeleton was found in {capture.source}. {held}: assign its markers.", ask, until=Lifetime.EDITED
        )
        return
    if not capture.repairs:
        bench.clear_message()
        return
    report = ("Import report", lambda: bench.document.selection.set(("captures", capture_id)))
    bench.post_message(repair_words(capture), report, ("Close", bench.clear_message), until=Lifetime.PROJECT_OPENED)


def repair_words(capture: Capture) -> str:
    """Sentence about the repairs of a capture, for example ``walk.bvh was read with 2 repairs: line 214: the last row
    is cut off and was dropped.``
    """
    count, first = len(capture.repairs), capture.repairs[0].removeprefix(capture.source).lstrip(",: ")
    return f"{capture.source} was read with {count} repair{'' if count == 1 else 's'}: {first}"


def user_options(bench: Workbench, capture_id: str) -> dict[str, Any]:
    """Import options that keep what the user set on a capture: every value that is not listed as a guess."""
    capture = bench.document.project.captures[capture_id]
    guessed = {guess.subject.replace(" ", "_") for guess in capture.guesses}
    said = {option: value for option, value in values_of(capture).items() if option not in guessed}
    read_as = bench.read_as.get(capture_id)
    if read_as is None:
        return said
    said["clean"] = read_as.options.clean
    return said | ({"reference": read_as.options.reference} if "reference_pose" not in guessed else {})


def keep_corrections(bench: Workbench, collection: str, capture_id: str) -> None:
    """Store the user's corrections of a capture for the next file of the same kind; corrections that were undone are
    removed.
    """
    read_as = bench.read_as.get(capture_id) if collection == "captures" else None
    capture = bench.document.project.captures.get(capture_id)
    if read_as and capture:
        bench.settings.correct(read_as.kind, read_as.corrections(capture))


def report_corrections(bench: Workbench, capture_id: str) -> None:
    """Report that a file was read with corrections of earlier files of the same kind, with a button to detect the
    settings again.
    """
    read_as, capture = bench.read_as[capture_id], bench.document.project.captures[capture_id]
    corrections = read_as.corrections(capture)
    if not corrections:
        return

    def guess() -> None:
        bench.settings.correct(read_as.kind, {})
        if capture_id in bench.document.project.captures:
            reread_capture(bench, capture_id, GUESS_ALL, f"Re-import {capture.name} with detected settings")

    applied = corrections_text(corrections)
    sentence = f"{capture.source} was imported with your earlier corrections for this kind of file: {applied}."
    bench.inform(sentence, ("Keep", bench.clear_message), ("Detect again", guess), until=Lifetime.PROJECT_OPENED)


def show_motion(document: Document) -> None:
    """Set the play range to the whole stage and the playhead to the start of the active clip."""
    span, clip = stage_span(document.project), document.active_clip
    if span is not None and clip is not None:
        document.playhead.set_range(span.first, span.last)
        document.playhead.set_time(clip.start)


def _show_markers(document: Document, capture_id: str) -> None:
    """Select a capture that has markers but no body, so that the markers are visible; without performers they can still
    be played.
    """
    document.selection.set(("captures", capture_id))
    if document.active_motion_id is None:
        capture = document.project.captures[capture_id]
        document.playhead.frame_rate = capture.frame_rate
        document.playhead.set_range(0, capture.frame_count - 1)
        document.playhead.set_frame(0)


def replace_motion(document: Document, capture_id: str, capture: Capture, known: Annotations, text: str) -> None:
    """Replace a capture and its contacts by those of another reading. If the capture had no body before, visible
    performers play it.
    """
    old = document.project.captures[capture_id]
    with document.group(text):
        digest = capture.digest or old.digest
        if (capture.name, capture.digest) != (old.name, digest):
            capture = replace(capture, name=old.name, digest=digest)
        document.replace("captures", capture_id, capture, text)
        for motion_id, motion in document.project.motions.items():
            if motion.capture_id == capture_id:
                for key in document.project.contacts_of(motion_id):
                    document.remove("contacts", key, text)
                contacts = Annotations(known.contacts)  # the constraints are the user's by now
                _annotate(document, contacts.of_motion(motion_id), text)
                if old.body_map is None:
                    _perform(document, motion_id, text)


def _annotate(document: Document, annotations: Annotations, text: str) -> None:
    document.add_all("contacts", annotations.contacts or (), text)
    document.add_all("constraints", annotations.constraints, text)
    document.add_all("labels", annotations.labels, text)


def _perform(document: Document, motion_id: str, text: str) -> None:
    project: Project = document.project
    capture = project.captures[project.motions[motion_id].capture_id]
    if capture.body_map is None:
        return
    clip = Clip(motion_id, capture.first_frame, capture.frame_count - 1, id=new_id())
    performers = project.performers
    shown = {key for key, each in performers.items() if each.visible} or set(performers)
    playing = {key: replace(each, clips=(clip,)) for key, each in performers.items() if key in shown}
    travel = travel_heading(capture, clip.first, clip.last)
    row = {**performers, **playing} if is_unarranged(performers) else playing
    swept = swept_points(capture, clip.first, clip.last)
    if swept is not None and is_unarranged(row):
        legs = {key: project.characters[row[key].character_id].morphology.leg_length for key in playing}
        playing = performers_in_row(row, travel or 0.0, {key: leg * swept for key, leg in legs.items()})
    for key, performer in playing.items():
        document.replace("performers", key, performer, text)


def _bundled_bodies() -> list[Any]:
    from studio.io.project.character_file import bundled_characters

    characters = bundled_characters()
    return list(zip(characters.values(), performers_side_by_side(characters).values(), strict=True))
