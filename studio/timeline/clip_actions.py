"""Edits of clips without a drag: by the context menu of their tracks, the keyboard, or a drop from the library."""

from collections.abc import Callable
from functools import partial

from PySide6.QtWidgets import QMenu

from studio.core.errors import StudioError
from studio.core.stage.clip_row import players_of, with_first_frame, with_last_frame
from studio.document import clip_edits
from studio.document.mnemonics import escaped_mnemonics
from studio.timeline.shown import Hit, ItemPart, RowContext


def performers_of_row(shown: RowContext, performer_id: str) -> tuple[str, ...]:
    """Ids of the performers that a clip track stands for: one, or all visible ones with the same clips."""
    performers = shown.project.performers
    if shown.rows_per_performer:
        return (performer_id,)
    row = performers[performer_id].all_clips
    return tuple(
        key for key, each in performers.items() if (each.visible and each.all_clips == row) or key == performer_id
    )


def add_clip(shown: RowContext, performer_id: str, motion_id: str, start: float | None) -> None:
    """Add a motion as a clip to a track at the stage time ``start``, or at the end of the track, and select it."""
    document = shown.document
    name = clip_edits.add_clip(document, performers_of_row(shown, performer_id), motion_id, start)
    document.selection.set(("performers", performer_id), ("clips", name))


def add_layer(shown: RowContext, performer_id: str, motion_id: str, start: float | None) -> None:
    """Add a motion as a layer at the stage time ``start``, or at the playhead, and select it."""
    document = shown.document
    begin = document.playhead.time if start is None else start
    name = clip_edits.add_layer(document, performers_of_row(shown, performer_id), motion_id, begin)
    document.selection.set(("performers", performer_id), ("clips", name))


def nudged_clip(shown: RowContext, clip_id: str, edge: ItemPart, frames: int) -> None:
    """Trim the first or last frame of a clip by a number of frames, as one undo step."""
    project = shown.project
    clip = project.clips[clip_id]
    rate, count = project.frame_rate_of(clip), project.captures[project.motions[clip.motion_id].capture_id].frame_count
    text = f"Trim {clip_edits.name_of(project, clip)}"
    if edge == ItemPart.FIRST:
        clip_edits.edit_clip(
            shown.document, clip_id, lambda each: (with_first_frame(each, rate, each.first + frames),), text
        )
    else:
        clip_edits.edit_clip(
            shown.document, clip_id, lambda each: (with_last_frame(each, each.last + frames, count),), text
        )


def offer_clip(menu: QMenu, shown: RowContext, hit: Hit) -> None:
    """Fill the context menu of a clip."""
    document, project = shown.document, shown.project

    def select(clip_id: str) -> None:
        document.selection.set(("performers", hit.performer_id), ("clips", clip_id))

    def split() -> None:
        select(clip_edits.split_clip(document, hit.id, document.playhead.time))

    def offer(text: str, run: Callable[[], None]) -> None:
        _offer(menu, shown, hit.performer_id, text, lambda: run() if hit.id in shown.project.clips else _refuse("clip"))

    offer("Split at playhead", split)
    offer("Mirror", lambda: clip_edits.mirror_clip(document, hit.id))
    offer("Duplicate", lambda: select(clip_edits.duplicate_clip(document, hit.id)))
    players = players_of(project, hit.id)
    if len(players) > 1:
        text = f"Make unique for {project.performers[hit.performer_id].name}"
        offer(text, lambda: select(clip_edits.detach_clip(document, hit.performer_id, hit.id)))
    text = f"Delete clip {clip_edits.name_of(project, project.clips[hit.id])}"
    offer("Delete", lambda: clip_edits.remove_clips(document, (hit.id,), text))


def offer_motions(menu: QMenu, shown: RowContext, performer_id: str, start: float | None) -> None:
    """Add submenus with every motion of the project, to be added as a clip or as a layer of a performer."""
    for text, add in (("Add clip", add_clip), ("Add layer", add_layer)):
        added = menu.addMenu(text)
        for motion_id, motion in shown.project.motions.items():
            if shown.project.captures[motion.capture_id].body_map is not None:
                _offer(added, shown, performer_id, motion.name, partial(add, shown, performer_id, motion_id, start))


def _offer(menu: QMenu, shown: RowContext, performer_id: str, text: str, run: Callable[[], None]) -> None:
    """Add a menu entry that does nothing if the performer was removed while the menu was open."""
    kept = partial(_run_on, shown, performer_id, run)
    menu.addAction(escaped_mnemonics(text)).triggered.connect(lambda: try_edit(shown, kept))


def _run_on(shown: RowContext, performer_id: str, run: Callable[[], None]) -> None:
    run() if performer_id in shown.project.performers else _refuse("performer")


def _refuse(what: str) -> None:
    raise StudioError(f"The {what} has been removed from the project. Choose another one.")


def try_edit(shown: RowContext, run: Callable[[], None]) -> None:
    """Run an edit of the document; an invalid one is reported as a message."""
    try:
        run()
    except StudioError as error:
        shown.document.problem_reported.emit(str(error))
