"""Main window: assembles bar, docks, views and strips, and takes drops."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from PySide6.QtCore import QEvent, QPoint, Qt, QTimer, Signal
from PySide6.QtGui import (
    QAction,
    QCloseEvent,
    QDragEnterEvent,
    QDragLeaveEvent,
    QDropEvent,
    QKeyEvent,
    QMouseEvent,
    QResizeEvent,
    QShowEvent,
)
from PySide6.QtWidgets import (
    QAbstractButton,
    QDockWidget,
    QGridLayout,
    QMainWindow,
    QRubberBand,
    QTabWidget,
    QVBoxLayout,
    QWidget,
)

from studio.app import capture_import, character_import
from studio.app.action_set import ActionSet
from studio.app.footage_playback import FootagePlayback
from studio.app.guided_tour import GuidedTour
from studio.app.live_control import LiveControl
from studio.app.marker_dialog import open_markers
from studio.app.playing_live import LivePlayController
from studio.app.plug_in_panels import add_panel_actions
from studio.app.pose_library import PoseLibrary
from studio.app.preferences import FITTED, Preferences, key_map_of, save_preferences
from studio.app.problem_tour import ProblemTour
from studio.app.sound_playback import SoundPlayback
from studio.app.strike_search import StrikeSearchController
from studio.app.top_bar import TopBar
from studio.app.verbs import editing, files
from studio.app.verbs.behaviours import READY_MADE_PARTS
from studio.app.workbench import Workbench
from studio.core.errors import StudioError
from studio.engine.problem_search import ProblemSearch
from studio.panels.behaviour.panel import BehaviourPanel
from studio.panels.command_palette import CommandPalette, ShortcutSheet
from studio.panels.console import Console
from studio.panels.fields import styled_label
from studio.panels.history import History
from studio.panels.inspector import Inspector
from studio.panels.library_drops import BODY_COLLECTIONS, LibraryDrops
from studio.panels.library_panel import LibraryPanel
from studio.panels.library_rows import SCENE_COLLECTIONS
from studio.panels.message_strip import Lifetime, MessageStrip, RecoveryBar
from studio.panels.problem_table import ProblemTable
from studio.panels.status_line import StatusLine

if TYPE_CHECKING:
    from studio.timeline.timeline import Timeline
    from studio.viewport.widget import Viewport

MAIN_WINDOW_SIZE = (1680, 1050)
LIBRARY_WIDTH, INSPECTOR_WIDTH = 236, 316
TIMELINE_FRACTION, MAX_TIMELINE_FRACTION = 0.35, 0.45
HISTORY_HEIGHT_PX, HISTORY_FRACTION = 160, 0.24
TITLE_BAR_PX = 36
"""Pixels reserved for the title bar that a window manager puts above the window."""
CHIP_STRIP_PX = 48
"""Pixels at the upper and lower edge of the 3D view that are left to its chips, so that no message covers them."""

Area = Qt.DockWidgetArea
TABBED_PANELS = {
    "Inspector": ("Strikes", "Live", "Poses"),
    "Timeline": ("Behaviour", "Pose map", "Console", "Problems"),
}
"""Panels that share the dock area of another panel as tabs once they are shown."""


class MainWindow(QMainWindow):
    """Main window. The 3D view and the timeline are added later by ``show_viewport`` and ``show_timeline``."""

    closed = Signal()

    def __init__(self, bench: Workbench) -> None:
        super().__init__()
        self.bench = bench
        bench.setParent(self)
        bench.window = self
        self.arranging: bool = False
        self._leaving = False
        self._after_save: Callable[[], object] | None = None
        self.setAcceptDrops(True)
        self.drop_frame = QRubberBand(QRubberBand.Shape.Rectangle, self)
        self.drop_frame.setObjectName("drop_frame")
        self.setDockNestingEnabled(True)
        self.actions_by_id = ActionSet(bench, self)
        self.actions_by_id.apply_keys()
        self.addActions(list(self.actions_by_id.by_id.values()))
        self._autosave = QTimer(self)
        self._autosave.timeout.connect(self._save_now_and_then)
        self._make_bars()
        self._make_centre()
        self._make_docks()
        add_panel_actions(self)
        self.palette_panel = CommandPalette(self, self.actions_by_id.in_menus())
        self.choice_panel = CommandPalette(self, [])
        self._connect()
        self._apply_preferences()
        self.resize(*MAIN_WINDOW_SIZE)
        self.setFocus()  # else the first button of the bar has the keyboard, which is seen
        self._restore_layout()
        self._stay_on_screen()
        self._show_title()
        self.actions_by_id.refresh()

    def show_viewport(self, viewport: "Viewport") -> None:
        """Add the 3D view."""
        self._stage_layout.replaceWidget(self._waiting, viewport)
        self._waiting.hide()
        for note in (self.recovery, self.question, self.tour_strip, self.strip):
            note.raise_()
        viewport.strike_drops.dropped.connect(self.striking.play)
        viewport.pose_drops.dropped.connect(self.pose_library.apply_to)
        LibraryDrops(viewport, ("captures", *BODY_COLLECTIONS, *SCENE_COLLECTIONS)).dropped.connect(
            self.library.open_item
        )
        viewport.options_changed.connect(self.actions_by_id.refresh)
        viewport.covered_below = self._covered_below
        self.bench.set_viewport(viewport)
        self._apply_preferences()
        self._show_progress(*self.status.progress.now)
        viewport.setFocus()
        self.bench.views_changed.emit()

    def _covered_below(self) -> float:
        """Height in pixels of the lower part of the 3D view that the message strip covers."""
        self._stage_layout.activate()
        return 0.0 if self.strip.isHidden() else float(self._stage_layout.geometry().height() - self.strip.y())

    def show_timeline(self, timeline: "Timeline") -> None:
        """Add the timeline to its dock."""
        self.docks["Timeline"].setWidget(timeline)
        timeline.message_posted.connect(self.status.show_hint)
        timeline.action_requested.connect(lambda key: self.actions_by_id.by_id[key].trigger())
        timeline.tracks.strike_dropped.connect(self.striking.play)
        LibraryDrops(timeline.tracks, BODY_COLLECTIONS).dropped.connect(self.library.open_item)
        self.bench.set_timeline(timeline)
        self._show_progress(*self.status.progress.now)
        self.bench.views_changed.emit()

    def show_dock(self, name: str) -> None:
        """Show a panel, in front of the other tabs of its area."""
        self.docks[name].show()
        self.docks[name].raise_()

    def search_library(self) -> None:
        """Show the library with the focus in its search field."""
        self.show_dock("Outliner")
        self.library.search_field.setFocus()
        self.library.search_field.selectAll()

    def show_console(self) -> None:
        """Show the Python console with the focus in it."""
        self.show_dock("Console")
        self.console.setFocus()

    def choose(self, title: str, choices: Sequence[tuple[tuple[str, str], Callable[[], object]]]) -> None:
        """Show a searchable list of choices ((text, detail), function) and call the function of the chosen one."""
        actions = []
        for (text, detail), run in choices:
            action = QAction(text, self.choice_panel)
            action.setData(detail)
            action.triggered.connect(lambda _=False, run=run: run())
            actions.append(action)
        self.choice_panel.offer(title, actions)

    def set_preferences(self, preferences: Preferences) -> None:
        """Apply and store ``preferences``."""
        self.bench.preferences = preferences
        save_preferences(self.bench.settings, preferences)
        self.actions_by_id.apply_keys()
        self._apply_preferences()

    def _apply_preferences(self) -> None:
        minutes = self.bench.preferences.autosave_minutes
        if minutes:
            self._autosave.start(60_000 * minutes)
        else:
            self._autosave.stop()
        if self.bench.has_viewport:
            self.bench.viewport.snap_steps = self.bench.preferences.snap_steps
            self.bench.viewport.navigation = key_map_of(self.bench.preferences).navigation
            self.bench.viewport.fits_activation = self.bench.preferences.activation == FITTED
            self.bench.viewport.set_onion_skins(self.bench.preferences.onion_skins)

    def _save_now_and_then(self) -> None:
        document = self.bench.document
        if document.dirty and document.path is not None and not self.bench.live.interactive:
            files.save(self.bench)

    def show_shortcuts(self) -> None:
        """Show the list of all shortcuts."""
        self._sheet = ShortcutSheet(self, self.actions_by_id.by_menu())
        self._sheet.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self._sheet.show()

    def set_dock_titles_shown(self, on: bool) -> None:
        """Show or hide the title bars by which panels are moved."""
        self.arranging = on
        for dock in self.docks.values():
            dock.setTitleBarWidget(None if on else QWidget(dock))  # type: ignore[arg-type]
        self.history.head.setHidden(on)

    def reset_layout(self) -> None:
        """Move all panels to their default places."""
        self.bench.settings.forget_layout()
        self.restoreState(self._first_state)
        self._size_docks()

    def run_when_saved(self, then: Callable[[], object]) -> None:
        """Run ``then`` now if nothing is unsaved, else after the user has saved or chosen not to; never after Cancel.

        Unsaved edits stay in the journal.
        """
        document = self.bench.document
        if not document.dirty:
            then()
            return

        def save_first() -> None:
            self._after_save = then
            files.save(self.bench)

        self.question.ask_user(
            f"{self._document_name()} has unsaved changes.",
            ("Save", save_first),
            ("Don't save", then),
            ("Cancel", self._forget_after_save),
        )

    def _forget_after_save(self) -> None:
        self._after_save = None

    # How it is made

    def _make_bars(self) -> None:
        self.top_bar = TopBar(self.bench.document, self.actions_by_id)
        self.setMenuWidget(self.top_bar)
        self.status = StatusLine(self.bench.document)
        self.setStatusBar(self.status)

    def _make_centre(self) -> None:
        self.strip, self.question, self.recovery = MessageStrip(), MessageStrip("recovery_bar"), RecoveryBar()
        self.tour_strip = MessageStrip("recovery_bar")
        self.tour = GuidedTour(self.bench, self.tour_strip, self)
        centre = QWidget()
        self._stage_layout = QGridLayout(centre)
        self._stage_layout.setContentsMargins(0, 0, 0, 0)
        self._waiting = styled_label("Starting the 3D view", "hint")
        self._waiting.setAlignment(Qt.AlignmentFlag.AlignCenter)
        self._stage_layout.addWidget(self._waiting, 0, 0)
        notes = QVBoxLayout()  # over the view, whose size is the same with them and without
        notes.setContentsMargins(12, CHIP_STRIP_PX, 12, CHIP_STRIP_PX)
        notes.setSpacing(8)
        notes.addWidget(self.recovery)
        notes.addWidget(self.question)
        notes.addWidget(self.tour_strip)
        notes.addStretch(1)
        notes.addWidget(self.strip)
        self._stage_layout.addLayout(notes, 0, 0)
        self.setCentralWidget(centre)

    def _make_docks(self) -> None:
        self.setCorner(Qt.Corner.BottomLeftCorner, Area.BottomDockWidgetArea)
        self.setCorner(Qt.Corner.BottomRightCorner, Area.BottomDockWidgetArea)
        self.library = LibraryPanel(self.bench.document, self.bench.settings.recent)
        self.inspector = Inspector(self.bench.document, self.bench.live)
        self.history = History(self.bench.document.undo_stack)
        self.striking = StrikeSearchController(self.bench)
        self.live_control = LiveControl(self.bench)
        self.pose_library = PoseLibrary(self.bench)
        self.footage_playback = FootagePlayback(self.bench, self)
        ready_made = [(key, text, tip) for key, (text, tip, _) in READY_MADE_PARTS.items()]
        self.behaviour = BehaviourPanel(self.bench.document, ready_made)
        self.behaviour.action_requested.connect(lambda key: self.actions_by_id.by_id[key].trigger())
        self.console = Console(self.bench.document)
        self.problem_search = ProblemSearch(self.bench.document, self.bench.live, self)
        self.problem_search.failed.connect(self.bench.post_message)
        self.problem_tour = ProblemTour(self.bench, self.problem_search, self)
        self.problems = ProblemTable(self.problem_search)
        self.problems.problem_chosen.connect(self.problem_tour.show)
        self.docks: dict[str, QDockWidget] = {}
        for name, widget, area in (
            ("Outliner", self.library, Area.LeftDockWidgetArea),
            ("History", self.history, Area.LeftDockWidgetArea),
            ("Strikes", self.striking.pages, Area.RightDockWidgetArea),
            ("Live", self.live_control.panel, Area.RightDockWidgetArea),
            ("Poses", self.pose_library.panel, Area.RightDockWidgetArea),
            ("Inspector", self.inspector, Area.RightDockWidgetArea),
            ("Footage", self.footage_playback.view, Area.RightDockWidgetArea),
            ("Timeline", QWidget(), Area.BottomDockWidgetArea),
            ("Behaviour", self.behaviour, Area.BottomDockWidgetArea),
            ("Pose map", self.striking.mapping.view, Area.BottomDockWidgetArea),
            ("Console", self.console, Area.BottomDockWidgetArea),
            ("Problems", self.problems, Area.BottomDockWidgetArea),
        ):
            dock = QDockWidget(name, self)
            dock.setObjectName("Library" if name == "Outliner" else name)  # as in the layouts of earlier versions
            dock.setWidget(widget)
            # Until it is asked for.
            dock.setHidden(name == "Footage" or any(name in others for others in TABBED_PANELS.values()))
            self.addDockWidget(area, dock)
            self.docks[name] = dock
            self._add_dock_action(dock)
        for area in (Area.RightDockWidgetArea, Area.BottomDockWidgetArea):
            self.setTabPosition(area, QTabWidget.TabPosition.North)
        for first, others in TABBED_PANELS.items():
            for second in others:
                self.tabifyDockWidget(self.docks[first], self.docks[second])
        self.set_dock_titles_shown(False)
        self._first_state = self.saveState()

    def _add_dock_action(self, dock: QDockWidget) -> None:
        action: QAction = dock.toggleViewAction()
        action.setText(f"{dock.windowTitle()} panel")
        action.triggered.connect(lambda shown: dock.raise_() if shown else None)  # else it is behind others
        self.actions_by_id.menus["View"].addAction(action)

    def _size_docks(self) -> None:
        docks = self.docks
        self.resizeDocks(
            [docks["Outliner"], docks["Inspector"]], [LIBRARY_WIDTH, INSPECTOR_WIDTH], Qt.Orientation.Horizontal
        )
        height = round(self.height() * TIMELINE_FRACTION)
        self.resizeDocks([docks["Timeline"]], [height], Qt.Orientation.Vertical)
        left = self.height() - height
        history = min(HISTORY_HEIGHT_PX, round(left * HISTORY_FRACTION))
        self.resizeDocks([docks["Outliner"], docks["History"]], [left - history, history], Qt.Orientation.Vertical)

    def _connect(self) -> None:
        bench, document, runner = self.bench, self.bench.document, self.bench.runner
        bench.message_posted.connect(self.strip.show_message)
        for event, signal in (
            (Lifetime.PROJECT_OPENED, document.project_opened),
            (Lifetime.EDITED, document.undo_stack.indexChanged),
            (Lifetime.SELECTED, document.selection.changed),
        ):
            signal.connect(lambda *_, event=event: self.strip.clear_at(event))
        self.live_playing = LivePlayController(bench, self)
        self.sound_playback: SoundPlayback = SoundPlayback(bench, self)
        bench.live.play.state_changed.connect(self.behaviour.show_running)
        document.saved_state_changed.connect(self._saved_state_changed)
        document.project_opened.connect(self._show_title)
        for changed in (document.project_opened, document.entity_changed):
            changed.connect(self.choice_panel.hide)  # what it offers is of the project as it was
        runner.started.connect(self.status.progress.begin)
        runner.progressed.connect(self.status.progress.show_share)
        for over in (runner.finished, runner.failed, runner.cancelled):
            over.connect(lambda task, *_: self.status.progress.end(task))
        self.status.progress.cancel_requested.connect(runner.cancel)
        self.status.report_requested.connect(lambda: editing.select_capture(bench))
        self.status.progress.message_posted.connect(self._show_progress)
        self.library.performance_requested.connect(lambda capture: capture_import.play_capture(bench, capture))
        self.library.scene_requested.connect(lambda key: self.actions_by_id.by_id[f"scene_{key}"].trigger())
        self.library.project_requested.connect(lambda path: self.open_paths([path]))
        self.inspector.reimport_requested.connect(self._reimport)
        self.inspector.steps_requested.connect(lambda capture: capture_import.stand_on_steps(bench, capture))
        self.inspector.markers_requested.connect(lambda capture: open_markers(bench, capture))
        self.inspector.character_requested.connect(
            lambda capture: character_import.make_actor_character(bench, capture)
        )
        self.inspector.remap_requested.connect(lambda *wanted: character_import.remap_character(bench, *wanted))
        document.entity_changed.connect(lambda collection, key: capture_import.keep_corrections(bench, collection, key))

    def _restore_layout(self) -> None:
        layout = self.bench.settings.layout()
        if layout is not None:
            self.restoreGeometry(layout[0])
            self.restoreState(layout[1])

    def _stay_on_screen(self) -> None:
        """Limit size and position of the window to the screen."""
        room = self.screen().availableGeometry().adjusted(0, TITLE_BAR_PX, 0, 0)
        self.resize(self.size().boundedTo(room.size()))
        if not room.contains(self.geometry()):
            self.move(room.topLeft() - QPoint(0, TITLE_BAR_PX))

    # What it answers to

    def _show_progress(self, words: str, share: float) -> None:
        if self.bench.has_viewport:
            self.bench.viewport.show_progress(words, share)
        if self.bench.has_timeline:
            self.bench.timeline.show_progress(words, share)

    def _saved_state_changed(self) -> None:
        self._show_title()
        if not self.bench.document.dirty and self._after_save is not None:
            then, self._after_save = self._after_save, None
            then()

    def _show_title(self) -> None:
        document = self.bench.document
        name = self._document_name()
        self.setWindowTitle(f"{'• ' if document.dirty else ''}{name} - Morpho Studio")
        state = "not saved" if document.dirty else "saved" if document.path else "new"
        self.top_bar.refresh(name, state)

    def _document_name(self) -> str:
        path = self.bench.document.path
        return path.name if path else "Untitled"

    def _reimport(self, capture_id: str, option: dict[str, Any]) -> None:
        try:
            capture_import.reimport(self.bench, capture_id, option)
        except StudioError as error:
            self.bench.post_message(str(error))

    def event(self, event: QEvent) -> bool:
        """Leave Space to a focused button: only Tab gives a button the focus."""
        pressed = event.type() == QEvent.Type.ShortcutOverride and cast(QKeyEvent, event).key() == Qt.Key.Key_Space
        if pressed and isinstance(self.focusWidget(), QAbstractButton):
            event.accept()
            return True
        return bool(super().event(event))

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Pass keys that no panel uses to the gizmo, so that it works without focus in the 3D view."""
        if not (self.bench.has_viewport and self.bench.viewport.nudge_by_key(event)):
            super().keyPressEvent(event)

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Take the focus from a text field when the user clicks outside of it."""
        self.setFocus()
        super().mousePressEvent(event)

    def dragEnterEvent(self, event: QDragEnterEvent) -> None:
        """Accept any dropped file; an unreadable one is reported by a message."""
        if _dropped(event):
            event.acceptProposedAction()
            self.drop_frame.setGeometry(self.rect())
            self.drop_frame.show()

    def dragLeaveEvent(self, event: QDragLeaveEvent) -> None:
        """Remove the highlight of the drop target."""
        self.drop_frame.hide()
        super().dragLeaveEvent(event)

    def dropEvent(self, event: QDropEvent) -> None:
        """Open or import the dropped files without a dialog."""
        self.drop_frame.hide()
        event.acceptProposedAction()
        self.open_paths(_dropped(event))

    def open_paths(self, paths: list[Path]) -> None:
        """Open a project or import captures; errors are shown as messages."""
        for path in paths:
            try:
                files.open_path(self.bench, path)
            except StudioError as error:
                self.bench.post_message(str(error))

    def showEvent(self, event: QShowEvent) -> None:
        """Set the sizes of the panels, which is possible only in a visible window."""
        super().showEvent(event)
        if self.bench.settings.layout() is None:
            self._size_docks()

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Limit the timeline to less than half of a small window."""
        super().resizeEvent(event)
        QTimer.singleShot(0, self, self._bound_timeline)

    def _bound_timeline(self) -> None:
        most, dock = round(self.height() * MAX_TIMELINE_FRACTION), self.docks["Timeline"]
        # One that was dragged out onto another, as its tab, floats with that one and not by itself.
        placed = self.dockWidgetArea(dock) is not Qt.DockWidgetArea.NoDockWidgetArea and not dock.isFloating()
        if dock.height() > most and placed:
            self.resizeDocks([dock], [most], Qt.Orientation.Vertical)

    def closeEvent(self, event: QCloseEvent) -> None:
        """Ask about unsaved changes in the message strip; then stop all work, views first."""
        if self.bench.document.dirty and not self._leaving:
            event.ignore()
            self.run_when_saved(self.close_without_saving)
            return
        self.bench.settings.remember_layout(self.saveGeometry(), self.saveState())
        if self.bench.has_viewport:
            self.bench.viewport.stop()
        if self.bench.has_timeline:
            self.bench.timeline.close()
        self._autosave.stop()
        self.live_control.close()
        self.problem_search.close()
        self.library.thumbnails.close()
        self.sound_playback.close()
        self.footage_playback.close()
        self.console.close_session()
        self.hide()  # workers may take a moment to end
        self.bench.close()
        event.accept()
        self.closed.emit()

    def close_without_saving(self) -> None:
        """Close without saving; unsaved edits stay in the journal."""
        self._leaving = True
        self.close()


def _dropped(event: QDragEnterEvent | QDropEvent) -> list[Path]:
    names = [url.toLocalFile() for url in event.mimeData().urls() if url.isLocalFile()]
    return [Path(name) for name in names if not Path(name).is_dir()]
