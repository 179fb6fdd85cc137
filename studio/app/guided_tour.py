"""Guided tour of the sample: five steps of a first edit, explained one at a time while the user works."""

from collections.abc import Callable
from dataclasses import dataclass

from PySide6.QtCore import QMetaObject, QObject

from studio.app.sample import open_sample
from studio.app.workbench import Workbench
from studio.core.stage.project import Project
from studio.panels.message_strip import MessageStrip


@dataclass(frozen=True)
class StepStart:
    """State of the document at the start of a step of the tour."""

    project: Project
    time: float
    undo_index: int


@dataclass(frozen=True)
class Step:
    """Step of the tour: the instruction, and a test if it has been carried out since the step began."""

    sentence: str
    is_done: Callable[[Workbench, StepStart], bool]


def _has_played(bench: Workbench, start: StepStart) -> bool:
    playhead = bench.document.playhead
    return not playhead.playing and playhead.time != start.time


def _has_picked(bench: Workbench, start: StepStart) -> bool:
    return bench.viewport.joint_picked is not None


def _has_constrained(bench: Workbench, start: StepStart) -> bool:
    return bool(bench.document.project.constraints.keys() - start.project.constraints.keys())


def _has_moved_target(bench: Workbench, start: StepStart) -> bool:
    if bench.live.interactive:  # the drag has not ended
        return False
    before = _targets(start.project)
    now = _targets(bench.document.project)
    both = before.keys() & now.keys()
    return any(type(now[key]) is type(before[key]) and now[key] != before[key] for key in both)


def _has_undone(bench: Workbench, start: StepStart) -> bool:
    return bench.document.undo_stack.index() < start.undo_index


def _targets(project: Project) -> dict[str, object]:
    constraints = project.constraints.items()
    return {key: getattr(each, each.shown.held_by) if each.shown.held_by else each for key, each in constraints}


def _kinds_of_targets(project: Project) -> dict[str, type]:
    return {key: type(target) for key, target in _targets(project).items()}


TOUR_STEPS = (
    Step("Press Space to play the motion, and Space again to pause it where the foot kicks highest.", _has_played),
    Step("Click a joint of a character, such as the kicking foot, or press Shift+J to choose one.", _has_picked),
    Step("Press C to constrain the joint. A bar for the constraint appears in the timeline.", _has_constrained),
    Step("Drag the blue arrow of the target up until one of the characters can no longer reach it.", _has_moved_target),
    Step(
        "Read the strips below the bar: green is met, amber partly met, red not met. Press Ctrl+Z to undo the drag.",
        _has_undone,
    ),
)
END_SENTENCE = "The tour is over. Press F1 for the guide, or Ctrl+K to find any action by its name."


class GuidedTour(QObject):
    """Controller that shows the instructions one after the other, each until it is carried out or skipped."""

    def __init__(self, bench: Workbench, strip: MessageStrip, parent: QObject) -> None:
        super().__init__(parent)
        self._bench, self._strip = bench, strip
        self._connections: list[QMetaObject.Connection] = []

    def begin(self) -> None:
        """Start with the first step; opens the sample if the project is empty."""
        self.end()
        document, bench = self._bench.document, self._bench
        self._connections = [
            signal.connect(self._update)
            for signal in (
                document.playhead.playing_changed,
                document.undo_stack.indexChanged,
                bench.viewport.picked_changed,
                bench.live.interactive_changed,
            )
        ]
        self._connections.append(document.project_opened.connect(lambda: self._show(0)))
        self._show(0)
        if document.active_motion_id is None:
            open_sample(bench)

    def end(self) -> None:
        """Hide the instruction and end the tour."""
        for connection in self._connections:
            QObject.disconnect(connection)
        self._connections = []
        self._strip.clear()

    def _show(self, number: int) -> None:
        if number == len(TOUR_STEPS):
            self.end()
            self._strip.show_sentence(END_SENTENCE)
            return
        self._number, self._start = number, self._start_now()
        self._strip.show_sentence(
            f"Tour, step {number + 1} of {len(TOUR_STEPS)}. {TOUR_STEPS[number].sentence}",
            ("Skip", lambda: self._show(number + 1)),
            ("End tour", self.end),
        )
        self._update()  # a joint may have been picked before

    def _update(self, *_: object) -> None:
        if TOUR_STEPS[self._number].is_done(self._bench, self._start):
            self._show(self._number + 1)
        elif _kinds_of_targets(self._bench.document.project) != _kinds_of_targets(self._start.project):
            self._start = self._start_now()  # a target that comes, goes or becomes shared is where the step starts

    def _start_now(self) -> StepStart:
        document = self._bench.document
        return StepStart(document.project, document.playhead.time, document.undo_stack.index())
