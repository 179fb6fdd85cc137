"""Drags on clips: move, trim, or change the speed, for all performers of the clip in one undo step."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from PySide6.QtCore import QPointF

from studio.core.curves.keyed import KeyedNumber
from studio.core.curves.retiming import scaled_speed
from studio.core.stage.clip import Clip
from studio.core.stage.clip_row import (
    ClipEdit,
    frame_at,
    players_of,
    with_clip_edited,
    with_first_frame,
    with_last_frame,
)
from studio.core.stage.project import Performer
from studio.document.clip_edits import name_of
from studio.timeline.gestures.gesture import DragHint, EditGesture
from studio.timeline.shown import ItemPart, RowContext
from studio.timeline.snapping import Snapped
from studio.timeline.time_words import time_text

MIN_STRETCH_SECONDS = 1e-6
"""Minimum length in seconds of a stretched clip, before its speed is clamped."""


class ClipGesture(EditGesture[Clip]):
    """Base of drags that edit clips in the tracks of all their performers."""

    collection = "clips"

    def __init__(self, shown: RowContext, clip_id: str, press: QPointF) -> None:
        self.clip_ids = self._dragged(shown, clip_id)
        super().__init__(shown, clip_id, press)
        self._performers = {
            key: each for clip in self.clip_ids for key, each in players_of(shown.project, clip).items()
        }

    def _dragged(self, shown: RowContext, clip_id: str) -> Sequence[str]:
        """Ids of the clips to be edited: all selected ones if ``clip_id`` is selected, else only that one."""
        selected = [key for key in shown.document.selection.of("clips") if key in shown.project.clips]
        return selected if clip_id in selected else (clip_id,)

    @property
    def words(self) -> str:
        """Name of the dragged clips: ``Walk``, or ``2 clips``."""
        return super().words if len(self.clip_ids) > 1 else name_of(self.shown.project, self.original)

    @property
    def is_there(self) -> bool:
        """True if all dragged clips still exist; a key press may have deleted them."""
        return all(clip_id in self.shown.project.clips for clip_id in self.clip_ids)

    def update(self, position: QPointF, free: bool) -> None:
        """Drag the clips; does nothing if one no longer exists."""
        if self.is_there:
            self.drag(position, free)

    def drag(self, position: QPointF, free: bool) -> None:
        """Drag the clips to ``position``; called only while all of them exist."""

    def show_clips_edited(self, edit: ClipEdit) -> None:
        """Show the dragged clips as changed by ``edit`` from their state at the start of the drag."""
        document = self.shown.document
        with document.group(self.text, self._number):
            for key, performer in self._performers.items():
                if key in document.project.performers:
                    document.replace("performers", key, self._with_edit(performer, edit), self.text)

    def _with_edit(self, performer: Performer, edit: ClipEdit) -> Performer:
        for clip_id in self.clip_ids:
            performer = with_clip_edited(performer, clip_id, edit)
        return performer

    def cancel(self) -> None:
        """Restore the clips as they were before the drag, without an undo step."""
        if self.is_there:
            self.show_clips_edited(lambda clip: (clip,))
        self.finish()

    def _find_magnets(self) -> tuple[float, ...]:
        """Stage times to snap to, in seconds: the playhead, and both ends of all other clips."""
        project = self.shown.project
        others: Mapping[str, Clip] = {key: clip for key, clip in project.clips.items() if key not in self.clip_ids}
        ends = {time for clip in others.values() for time in (clip.start, end_of(self.shown, clip))}
        return (self.shown.document.playhead.time, *ends)


class MoveClips(ClipGesture):
    """Drag of clips in time; their ends snap to those of other clips."""

    def __init__(self, shown: RowContext, clip_id: str, press: QPointF) -> None:
        super().__init__(shown, clip_id, press)
        self.text = f"Move {self.words}"

    def drag(self, position: QPointF, free: bool) -> None:
        """Move all dragged clips by the displacement of the grabbed one."""
        begin, length = self.original.start, end_of(self.shown, self.original) - self.original.start
        caught = self.snap(begin + self.moved(position), free)
        end = self.snap(begin + length + self.moved(position), free)
        if caught.magnet is None and end.magnet is not None:
            caught = Snapped(end.time - length, end.magnet)
        seconds = caught.time - begin
        self.show_clips_edited(lambda clip: (replace(clip, start=clip.start + seconds),))
        start = begin + seconds
        text = f"{seconds:+.3f} s  starts {time_text(start * self.shown.axis.frame_rate, start)}"
        self.mark = DragHint(start, text, caught.magnet)


class TrimClip(ClipGesture):
    """Drag of an end of a clip; the remaining frames keep their stage times."""

    def __init__(self, shown: RowContext, clip_id: str, part: ItemPart, press: QPointF) -> None:
        super().__init__(shown, clip_id, press)
        self.part = part
        self.text = f"Trim {self.words}"

    def drag(self, position: QPointF, free: bool) -> None:
        """Trim by whole frames; ``free`` turns snapping to magnets off."""
        clip, first = self.original, self.part == ItemPart.FIRST
        grabbed = clip.start if first else end_of(self.shown, clip)
        caught = self.snap(grabbed + self.moved(position), free)
        seconds = caught.time - grabbed
        self.show_clips_edited(lambda each: (self._trimmed(each, seconds),))
        trimmed = self._trimmed(clip, seconds)
        place = caught.time if caught.magnet is not None else grabbed + self.moved(position)
        self.mark = DragHint(
            place, f"{self.part} {trimmed.first if first else trimmed.last} of the clip", caught.magnet
        )

    def _trimmed(self, clip: Clip, seconds: float) -> Clip:
        """Clip with one end moved by ``seconds`` on the stage, rounded to a whole frame of its motion."""
        project = self.shown.project
        rate = project.frame_rate_of(clip)
        if self.part == ItemPart.FIRST:
            return with_first_frame(
                clip, rate, min(max(round(frame_at(clip, rate, clip.start + seconds)), 0), clip.last)
            )
        count = project.captures[project.motions[clip.motion_id].capture_id].poses.frame_count
        once = clip.length(rate) / clip.repeats
        last = round(frame_at(clip, rate, clip.start + once + seconds / clip.repeats))
        return with_last_frame(clip, max(min(last, count - 1), clip.first), count)


class StretchClip(ClipGesture):
    """Drag of an end of a clip to change its speed: the same frames play in more or less time.

    The other end is fixed; later clips of the track move with the dragged end.
    """

    def __init__(self, shown: RowContext, clip_id: str, part: ItemPart, press: QPointF) -> None:
        self.part = part
        super().__init__(shown, clip_id, press)
        self.text = f"Set speed of {name_of(shown.project, self.original)}"

    def _dragged(self, shown: RowContext, clip_id: str) -> Sequence[str]:
        rows = (performer.clips for performer in players_of(shown.project, clip_id).values())
        start = shown.project.clips[clip_id].start
        beyond = (
            clip.id
            for row in rows
            for clip in row
            if (clip.start < start if self.part == ItemPart.FIRST else clip.start > start)
        )
        return tuple(dict.fromkeys((clip_id, *beyond)))

    def drag(self, position: QPointF, free: bool) -> None:
        """Move the dragged end with the mouse, within the range of allowed speeds."""
        old, first = self.original, self.part == ItemPart.FIRST
        end = end_of(self.shown, old)
        grabbed = old.start if first else end
        caught = self.snap(grabbed + self.moved(position), free)
        wanted = end - caught.time if first else caught.time - old.start
        length = end - old.start
        speed = scaled_speed(old.speed, length / max(wanted, MIN_STRETCH_SECONDS))
        change = replace(old, speed=speed).length(self.shown.project.frame_rate_of(old)) - length
        shift = -change if first else change

        def edit(clip: Clip) -> tuple[Clip, ...]:
            if clip.id != self.entity_id:
                return (replace(clip, start=clip.start + shift),)
            return (replace(clip, speed=speed, start=clip.start + (shift if first else 0.0)),)

        self.show_clips_edited(edit)
        words = f"{length / max(length + change, MIN_STRETCH_SECONDS):.3g} × previous speed"
        if not isinstance(speed, KeyedNumber):
            words = f"Speed × {speed:.3g}"
        self.mark = DragHint(grabbed + shift, f"{words}  {length + change:.3f} s", caught.magnet)


def end_of(shown: RowContext, clip: Clip) -> float:
    """Stage time in seconds at which a clip ends."""
    return clip.start + clip.length(shown.project.frame_rate_of(clip))
