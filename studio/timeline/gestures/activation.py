"""Drags on the bar of a constraint: one of the four times of its activation, or all of them."""

from dataclasses import replace

from PySide6.QtCore import QPointF

from studio.core.changed_records import with_fields
from studio.core.constraints.base import Constraint
from studio.core.curves.activation import ActivationCurve
from studio.core.curves.keyed import Keys
from studio.document.keyed_fields import with_times
from studio.timeline.gestures.gesture import DragHint, EditGesture
from studio.timeline.shown import HANDLE_PARTS, ItemPart, RowContext
from studio.timeline.snapping import Snapped


def with_time(curve: ActivationCurve, part: ItemPart, time: float) -> ActivationCurve:
    """Activation curve with one of its four times changed; the others are pushed along if necessary."""
    moved = with_times(curve, {HANDLE_PARTS.index(part): time})
    assert isinstance(moved, ActivationCurve)
    return moved


def time_of(curve: ActivationCurve, part: ItemPart) -> float:
    """Time in seconds of a handle of the activation curve."""
    return curve.times[HANDLE_PARTS.index(part)]


def moved(constraint: Constraint, seconds: float, keys_stay: bool) -> Constraint:
    """Constraint with its activation, and unless ``keys_stay`` its keys, moved by ``seconds``."""
    keys = {name: value for name, value in vars(constraint).items() if isinstance(value, Keys) and not keys_stay}
    times = {name: value.moved(seconds) for name, value in keys.items()}
    return with_fields(constraint, activation=constraint.activation.moved(seconds), **times)


class DragHandle(EditGesture[Constraint]):
    """Drag of one of the four times of an activation, within the length of the motion."""

    collection = "constraints"

    def __init__(self, shown: RowContext, entity_id: str, part: ItemPart, press: QPointF) -> None:
        super().__init__(shown, entity_id, press)
        self.part = part
        self.text = f"Move {part} of {self.words}"

    def update(self, position: QPointF, free: bool) -> None:
        """Set the time to the one under the mouse, snapped."""
        subject, old = self.shown.subject, time_of(self.original.activation, self.part)
        caught = self.snap(subject.to_stage(old) + self.moved(position), free)
        seconds = subject.to_motion(caught.time) - old

        def moved(constraint: Constraint) -> ActivationCurve:
            curve = constraint.activation
            last = max(subject.last_frame / subject.frame_rate, curve.end)
            time = time_of(curve, self.part) + seconds
            return with_time(curve, self.part, min(max(time, min(0.0, curve.start)), last))

        self.show_all_edited(lambda _, each: replace(each, activation=moved(each)))
        time = time_of(moved(self.original), self.part)
        text = f"{self.part}  {self.shown.moment(time * subject.frame_rate)}"
        self.mark = DragHint(subject.to_stage(time), text, caught.magnet)


class MoveActivation(EditGesture[Constraint]):
    """Drag of a constraint's bar: its activation and keys move together, and each of the four times may snap.

    ``free`` leaves the keys in place and turns snapping off.
    """

    collection = "constraints"

    def __init__(self, shown: RowContext, entity_id: str, press: QPointF) -> None:
        super().__init__(shown, entity_id, press)
        self.text = f"Move {self.words}"

    def update(self, position: QPointF, free: bool) -> None:
        """Move all four times by the displacement of the mouse."""
        curve, subject = self.original.activation, self.shown.subject
        begin = subject.to_stage(curve.start)
        caught = self._catch(begin + self.moved(position), free)
        seconds = caught.time - begin
        # At least a frame of each stays within the motion.
        curves = [each.activation for each in self.originals.values()]
        last = subject.last_frame / subject.frame_rate
        seconds = min(max(seconds, *(-each.end for each in curves)), *(last - each.start for each in curves))
        self.show_all_edited(lambda _, each: moved(each, seconds, free))
        start = curve.start + seconds
        text = f"{seconds:+.3f} s  starts {self.shown.moment(start * subject.frame_rate)}"
        self.mark = DragHint(subject.to_stage(start), text, caught.magnet)

    def _catch(self, begin: float, free: bool) -> Snapped:
        """Snapped start time, moved so that one of the four times is at a magnet, or else to a frame."""
        curve = self.original.activation
        for part in HANDLE_PARTS:
            ahead = time_of(curve, part) - curve.start
            caught = self.snap(begin + ahead, free)
            if caught.magnet is not None:
                return Snapped(caught.time - ahead, caught.magnet)
        return self.snap(begin, free)
