"""Drags on clips: all selected ones in time, or an end of one; wherever they are played, as one undo step."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from PySide6.QtCore import QPointF

from studio.core.project import Performer
from studio.core.stage.clip import Clip
from studio.core.stage.clip_row import ClipEdit, begun_at, edited, ended_at, frame_at, players_of
from studio.document.clips import name_of
from studio.timeline.figures import moment
from studio.timeline.gestures.gesture import EditGesture, Mark
from studio.timeline.shown import Part, Shown
from studio.timeline.snapping import Snapped


class ClipGesture(EditGesture):
    """A drag that edits clips in the rows of all who play them."""

    collection = "clips"

    def __init__(self, shown: Shown, clip_id: str, press: QPointF, clip_ids: Sequence[str] = ()) -> None:
        self.clip_ids = clip_ids or (clip_id,)
        super().__init__(shown, clip_id, press)
        self.frame_rate = shown.project.frame_rate_of(self.original)
        self._performers = {
            key: each for clip in self.clip_ids for key, each in players_of(shown.project, clip).items()
        }

    @property
    def is_there(self) -> bool:
        """Whether the clips have not been removed meanwhile, as by a key."""
        return all(clip_id in self.shown.project.clips for clip_id in self.clip_ids)

    def update(self, position: QPointF, free: bool) -> None:
        """Nothing when a clip has been removed meanwhile."""
        if self.is_there:
            self.drag(position, free)

    def drag(self, position: QPointF, free: bool) -> None:
        """As ``update``, while the clips are there."""

    def put_each(self, edit: ClipEdit) -> None:
        """Show the rows with the dragged clips edited from what they were; not of performers that are gone."""
        document = self.shown.document
        with document.group(self.text, self._number):
            for key, performer in self._performers.items():
                if key in document.project.performers:
                    document.replace("performers", key, self._row(performer, edit), self.text)

    def _row(self, performer: Performer, edit: ClipEdit) -> Performer:
        for clip_id in self.clip_ids:
            performer = edited(performer, clip_id, edit)
        return performer

    def cancel(self) -> None:
        """Put the rows back; the step vanishes."""
        if self.is_there:
            self.put_each(lambda clip: (clip,))
        self.finish()

    def _find_magnets(self) -> tuple[float, ...]:
        """The playhead, and both ends of every other clip on the stage."""
        project = self.shown.project
        others: Mapping[str, Clip] = {key: clip for key, clip in project.clips.items() if key not in self.clip_ids}
        ends = {time for clip in others.values() for time in (clip.start, end_of(self.shown, clip))}
        return (self.shown.document.playhead.time, *ends)


class MoveClips(ClipGesture):
    """Drag bars in time: one that begins where another ends catches there."""

    def __init__(self, shown: Shown, clip_id: str, press: QPointF) -> None:
        selected = [key for key in shown.document.selection.of("clips") if key in shown.project.clips]
        super().__init__(shown, clip_id, press, selected if clip_id in selected else ())
        many = len(self.clip_ids)
        self.text = f"Move {f'{many} clips' if many > 1 else name_of(shown.project, self.original)} in time"

    def drag(self, position: QPointF, free: bool) -> None:
        """All by as much as the one that is held."""
        begin, length = self.original.start, end_of(self.shown, self.original) - self.original.start
        caught = self.snap(begin + self.moved(position), free)
        end = self.snap(begin + length + self.moved(position), free)
        if caught.caught is None and end.caught is not None:
            caught = Snapped(end.time - length, end.caught)
        seconds = caught.time - begin
        self.put_each(lambda clip: (replace(clip, start=clip.start + seconds),))
        start = begin + seconds
        text = f"{seconds:+.3f} s  starts {moment(start * self.shown.axis.frame_rate, start)}"
        self.mark = Mark(start, text, caught.caught)


class TrimClip(ClipGesture):
    """Drag an end: the frames that are left play when they did."""

    def __init__(self, shown: Shown, clip_id: str, part: Part, press: QPointF) -> None:
        super().__init__(shown, clip_id, press)
        self.part = part
        self.text = f"Trim {name_of(shown.project, self.original)}"

    def drag(self, position: QPointF, free: bool) -> None:
        """Whole frames always; ``free`` only keeps it from catching on what lies near."""
        clip, project = self.original, self.shown.project
        grabbed = clip.start if self.part == Part.FIRST else end_of(self.shown, clip)
        caught = self.snap(grabbed + self.moved(position), free)
        first = self.part == Part.FIRST
        if first:
            frame = min(max(round(frame_at(clip, self.frame_rate, caught.time)), 0), clip.last)
            self.put_each(lambda each: (begun_at(each, self.frame_rate, frame),))
        else:
            count = project.captures[project.motions[clip.motion_id].capture_id].poses.frame_count
            way = (caught.time - grabbed) * self.frame_rate * clip.speed / clip.repeats
            frame = max(min(clip.last + round(way), count - 1), clip.first)
            self.put_each(lambda each: (ended_at(each, frame, count),))
        place = caught.time if caught.caught is not None else grabbed + self.moved(position)
        self.mark = Mark(place, f"{self.part} {frame} of the motion", caught.caught)


def end_of(shown: Shown, clip: Clip) -> float:
    """Seconds at which a clip ends."""
    return clip.start + clip.length(shown.project.frame_rate_of(clip))
