"""Edits of clips without a drag: from the menu of their rows, by the keyboard, or dropped from the library."""

from collections.abc import Callable
from functools import partial

from PySide6.QtWidgets import QMenu

from studio.core.errors import StudioError
from studio.core.stage.clip_row import players_of, with_first_frame, with_last_frame
from studio.document import clip_edits
from studio.document.mnemonics import escaped_mnemonics
from studio.timeline.shown import Hit, ItemPart, RowContext


def performers_of_row(shown: RowContext, performer_id: str) -> tuple[str, ...]:
    """Performers of a row: one, or all visible ones with the same clips."""
    performers = shown.project.performers
    if shown.rows_per_performer:
        return (performer_id,)
    row = performers[performer_id].all_clips
    return tuple(
        key for key, each in performers.items() if (each.visible and each.all_clips == row) or key == performer_id
    )


def add_clip(shown: RowContext, performer_id: str, motion_id: str, start: float | None) -> None:
    """Add and select a clip in a row, from ``start`` or where the row ends."""
    document = shown.document
    name = clip_edits.add_clip(document, performers_of_row(shown, performer_id), motion_id, start)
    document.selection.set(("performers", performer_id), ("clips", name))


def add_layer(shown: RowContext, performer_id: str, motion_id: str, start: float | None) -> None:
    """As ``add_clip``, a layer: from ``start`` or the playhead."""
    document = shown.document
    begin = document.playhead.time if start is None else start
    name = clip_edits.add_layer(document, performers_of_row(shown, performer_id), motion_id, begin)
    document.selection.set(("performers", performer_id), ("clips", name))


def nudged_clip(shown: RowContext, clip_id: str, edge: ItemPart, frames: int) -> None:
    """Trim an end of a clip by whole frames: one undo step."""
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
    """Menu of a clip."""
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
    """Every motion of the project as a clip to add to a row, or as a layer over it."""
    for text, add in (("Add clip", add_clip), ("Add layer", add_layer)):
        added = menu.addMenu(text)
        for motion_id, motion in shown.project.motions.items():
            if shown.project.captures[motion.capture_id].body_map is not None:
                _offer(added, shown, performer_id, motion.name, partial(add, shown, performer_id, motion_id, start))


def _offer(menu: QMenu, shown: RowContext, performer_id: str, text: str, run: Callable[[], None]) -> None:
    """An entry about a performer's row, which may be removed while the menu is open."""
    kept = partial(_run_on, shown, performer_id, run)
    menu.addAction(escaped_mnemonics(text)).triggered.connect(lambda: try_edit(shown, kept))


def _run_on(shown: RowContext, performer_id: str, run: Callable[[], None]) -> None:
    run() if performer_id in shown.project.performers else _refuse("performer")


def _refuse(what: str) -> None:
    raise StudioError(f"The {what} has been removed from the project: choose another one.")


def try_edit(shown: RowContext, run: Callable[[], None]) -> None:
    """Run an edit of the document; the reason for a refusal is shown in the window."""
    try:
        run()
    except StudioError as error:
        shown.document.problem_reported.emit(str(error))
