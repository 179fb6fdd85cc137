"""Actions on the selected clips, and new clips of the project's motions."""

from collections.abc import Callable
from functools import partial

from studio.app.workbench import Workbench
from studio.core.errors import StudioError
from studio.document import clip_edits


def chosen_clip(bench: Workbench) -> str | None:
    """Id of the selected clip, else of the active performer's only one."""
    document = bench.document
    selected = [key for key in document.selection.of("clips") if key in document.project.clips]
    if selected:
        return selected[-1]
    performer = document.project.performers.get(document.active_performer_id or "")
    return performer.clips[0].id if performer and len(performer.clips) == 1 else None


def add(bench: Workbench) -> None:
    """Let the user choose a motion, and append it to the tracks of the selected performers, or of all visible ones."""
    _choose(
        bench, "Choose a capture to add", lambda keys, motion_id: clip_edits.add_clip(bench.document, keys, motion_id)
    )


def add_layer(bench: Workbench) -> None:
    """Let the user choose a motion, and add it from the playhead on as a layer over the upper body."""
    now = bench.document.playhead.time
    _choose(
        bench,
        "Choose a capture to add as a layer",
        lambda keys, motion_id: clip_edits.add_layer(bench.document, keys, motion_id, now),
    )


def _choose(bench: Workbench, text: str, put: Callable[[list[str], str], str]) -> None:
    project = bench.document.project
    choices = [
        ((motion.name, f"{project.captures[motion.capture_id].duration:.1f} s"), partial(_add, bench, put, motion_id))
        for motion_id, motion in project.motions.items()
        if project.captures[motion.capture_id].body_map is not None
    ]
    if not choices:
        raise StudioError("There is no capture to add yet. Drop one on the window first.")
    bench.window.choose(text, choices)


def _add(bench: Workbench, put: Callable[[list[str], str], str], motion_id: str) -> None:
    document = bench.document
    performers = document.project.performers
    chosen = [key for key in document.selection.of("performers") if key in performers]
    keys = chosen or [key for key, each in performers.items() if each.visible]
    if keys:
        name = put(keys, motion_id)
        document.selection.set(*(("performers", key) for key in keys), ("clips", name))


def split(bench: Workbench) -> None:
    """Split the clip at the playhead."""
    clip_id = _clip(bench)
    _select(bench, clip_edits.split_clip(bench.document, clip_id, bench.document.playhead.time))


def toggle_mirrored(bench: Workbench) -> None:
    """Toggle the mirroring of the selected clips."""
    document = bench.document
    keys = document.selection.of("clips") or (_clip(bench),)
    if len(keys) == 1:
        clip_edits.mirror_clip(document, keys[0])
        return
    with document.group(f"Mirror {len(keys)} clips"):
        for key in keys:
            clip_edits.mirror_clip(document, key)


def duplicate(bench: Workbench) -> None:
    """Add a copy of the clip after it."""
    _select(bench, clip_edits.duplicate_clip(bench.document, _clip(bench)))


def make_own(bench: Workbench) -> None:
    """Give the active performer its own copy of a shared clip."""
    performer_id, clip_id = bench.document.active_performer_id, _clip(bench)
    if performer_id is not None:
        _select(bench, clip_edits.detach_clip(bench.document, performer_id, clip_id))


def _clip(bench: Workbench) -> str:
    clip_id = chosen_clip(bench)
    if clip_id is None:
        raise StudioError("Select a clip on the timeline first.")
    return clip_id


def _select(bench: Workbench, clip_id: str) -> None:
    document = bench.document
    document.selection.set(("performers", document.active_performer_id or ""), ("clips", clip_id))
