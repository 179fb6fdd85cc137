"""Live play in the window: number keys and clicked clips start motions, and recorded takes become edits."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial

from PySide6.QtCore import QEvent, QObject, Qt
from PySide6.QtGui import QKeyEvent, QKeySequence
from PySide6.QtWidgets import QAbstractSpinBox, QApplication, QComboBox, QLineEdit, QPlainTextEdit, QTextEdit

from studio.app.workbench import Workbench
from studio.core.names import counted_noun
from studio.core.stage.clip import Clip
from studio.core.stage.clip_row import clips_until, copies_for_parts
from studio.core.stage.conditions import KeyCondition
from studio.core.stage.project import Entity, Performer, Project, new_id
from studio.document.clip_edits import add_copies
from studio.live.recorded_take import StageTake, edits_of
from studio.panels.fields import NumberField
from studio.panels.message_strip import Lifetime

TYPING_WIDGETS = (QLineEdit, QAbstractSpinBox, QComboBox, QTextEdit, QPlainTextEdit)
KEY_EVENTS = (QEvent.Type.ShortcutOverride, QEvent.Type.KeyPress)


LIVE_PLAY_MESSAGE = "Live play is on."


class LivePlayController(QObject):
    """Controller of live play: handles keys and clicks while the stage plays live, and inserts recorded takes."""

    def __init__(self, bench: Workbench, parent: QObject) -> None:
        super().__init__(parent)
        self._bench, self._play = bench, bench.live.play
        self._clips = bench.document.selection.of("clips")
        self._play.running_changed.connect(self._listen)
        self._play.recorded.connect(partial(insert_take, bench))
        bench.document.selection.changed.connect(self._start_chosen)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Handle the keys of live play before all shortcuts, but after a focused text field."""
        if event.type() not in KEY_EVENTS or not isinstance(event, QKeyEvent):
            return False
        focused = QApplication.focusWidget()
        if isinstance(focused, TYPING_WIDGETS) and not (isinstance(focused, NumberField) and focused.leaves(event)):
            return False
        if event.modifiers() & ~Qt.KeyboardModifier.KeypadModifier:
            return False
        means = self._meaning(event)
        if means is None:
            return False
        event.accept()
        if event.type() == QEvent.Type.KeyPress and not event.isAutoRepeat():
            means()
        return True

    def _meaning(self, event: QKeyEvent) -> Callable[[], object] | None:
        """Function that a key has during live play; None if the key keeps its usual function."""
        dragging = self._bench.has_viewport and self._bench.viewport.gesture is not None
        if event.key() == Qt.Key.Key_Escape:
            return None if dragging else self._play.end
        name, project = QKeySequence(event.key()).toString(), self._bench.document.project
        number = event.key() - Qt.Key.Key_1
        started = [
            (key, clips[number])
            for key in self._chosen()
            if 0 <= number < len(clips := clips_of(project, key)) and number < 9
        ]
        if not started and name not in keys_of(project):
            return None

        def run() -> None:
            self._play.press(name)
            for key, clip in started:
                self._play.start(key, clip)

        return run

    def _chosen(self) -> tuple[str, ...]:
        document = self._bench.document
        active = document.active_performer_id
        return tuple(document.selection.of("performers")) or ((active,) if active else ())

    def _listen(self, running: bool) -> None:
        application = QApplication.instance()
        if application is not None:
            (application.installEventFilter if running else application.removeEventFilter)(self)
        if not running and self._bench.window.strip.text.startswith(LIVE_PLAY_MESSAGE):
            self._bench.clear_message()

    def _start_chosen(self) -> None:
        """Play the clip that was clicked during live play on the active performer."""
        before, self._clips = self._clips, self._bench.document.selection.of("clips")
        if not self._play.running or self._clips == before or not self._clips:
            return
        key = self._bench.document.active_performer_id or ""
        performer = self._bench.document.project.performers.get(key)
        for clip in performer.clips if performer else ():
            if clip.id == self._clips[-1]:
                self._play.start(key, detached_clip(clip))


def toggle(bench: Workbench) -> None:
    """Start or stop live play."""
    if bench.live.play.running:
        bench.live.play.end()
        return
    if not bench.live.play.begin():
        bench.post_message(
            "The solver is still being prepared. Start live play when the progress bar below is gone.",
            until=Lifetime.EDITED,
        )
        return
    active = bench.document.active_performer_id or ""
    names = [_name(bench.document.project, clip) for clip in clips_of(bench.document.project, active)]
    own = [f"{number}: {name} (selected character)." for number, name in enumerate(names[:9], 1)]
    heard = [f"{key}: {'; '.join(words)}." for key, words in keys_of(bench.document.project).items()]
    record_keys = bench.window.actions_by_id.by_id["record_take"].shortcut().toString()
    recording = [f"{record_keys}: record."] if record_keys else []
    bench.inform(" ".join([LIVE_PLAY_MESSAGE, *own, *heard, *recording, "Esc: stop."]))


def record(bench: Workbench) -> None:
    """Start or stop the recording of live play."""
    bench.live.play.record()


def insert_take(bench: Workbench, take: StageTake) -> None:
    """Add a recorded take to the clip tracks of its performers, at the playhead, as one undo step."""
    document = bench.document
    project, begin = document.project, document.playhead.time
    if abs(begin - take.begin) < 0.5 / document.playhead.frame_rate:
        begin = take.begin
    made = edits_of(take, project, bench.live.motion, iter(new_id, ""), begin)
    if begin != take.begin:
        made = [_after(project, *edit, begin) for edit in made]
    rows = [entity for _, _, entity in made if isinstance(entity, Performer)]
    with document.group("Record take"):
        for collection, key, entity in made:
            if key in getattr(document.project, collection):
                document.replace(collection, key, entity, "Record take")
            else:
                document.put_all(collection, {key: entity}, "Record take")
        for _, key, entity in made if begin != take.begin else ():
            if isinstance(entity, Performer):
                kept = [clip for clip in entity.clips if clip.start < begin]
                add_copies(document, copies_for_parts(document.project, project.performers[key], kept), "Record take")
    rate = document.playhead.frame_rate
    document.playhead.set_range(round(begin * rate), round((begin + take.end - take.begin) * rate))
    document.playhead.set_time(begin)
    clips = sum(len(each.clips) for each in rows)
    bench.inform(
        f"Recorded {take.end - take.begin:.1f} s: the clips of {counted_noun(len(rows), 'character')} are replaced by"
        f" {clips}. Undo restores them.",
        until=Lifetime.EDITED,
    )


def _after(project: Project, collection: str, key: str, entity: Entity, begin: float) -> tuple[str, str, Entity]:
    """Edit of a recorded take, changed so that clips before ``begin`` are kept."""
    if not isinstance(entity, Performer):
        return collection, key, entity
    before = project.performers[key]
    rates = {each.motion_id: project.frame_rate_of(each) for each in before.clips}
    return collection, key, replace(entity, clips=(*clips_until(before, begin, rates), *entity.clips))


def clips_of(project: Project, performer_id: str) -> list[Clip]:
    """Clips of a performer that the keys 1 to 9 start: each clip of its track once."""
    performer = project.performers.get(performer_id)
    clips = performer.clips if performer else ()
    return list({(clip.motion_id, clip.first, clip.last): detached_clip(clip) for clip in reversed(clips)}.values())[
        ::-1
    ]


def detached_clip(clip: Clip) -> Clip:
    """Copy of a clip that no longer aligns to the previous clip and may start at any time."""
    return replace(clip, joined=True, turn=0.0, offset=(0.0, 0.0))


def keys_of(project: Project) -> dict[str, list[str]]:
    """Keys that start transitions of behaviours, each with the names of the target states and of the characters."""
    keys: dict[str, dict[str, None]] = {}
    for behaviour in project.behaviours.values():
        names = [project.performers[each.performer_id].name for each in behaviour.cast]
        concerned = names[0] if len(names) == 1 else counted_noun(len(names), "character")
        for transition in behaviour.transitions:
            for condition in transition.conditions:
                if isinstance(condition, KeyCondition):
                    keys.setdefault(condition.key, {})[f"{transition.target.lower()} ({concerned})"] = None
    return {key: list(words) for key, words in keys.items()}


def _name(project: Project, clip: Clip) -> str:
    return project.motions[clip.motion_id].name
