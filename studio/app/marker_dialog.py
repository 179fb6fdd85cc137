"""Dialog for the markers of a capture: marker map, cleaning and signals. Applied changes can be undone."""

from collections.abc import Callable, Collection
from dataclasses import replace

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QDialog, QHBoxLayout, QTabWidget, QVBoxLayout

from studio.app.capture_import import resolve_markers
from studio.app.workbench import Workbench
from studio.core.captures.capture import Capture
from studio.core.errors import StudioError
from studio.core.markers.cleaning import StepReport, cleaned_trial
from studio.core.markers.take import MarkerTake, mapped_labels
from studio.panels.fields import FIELD_ICON_PX, press_button, styled_label
from studio.panels.markers.assistant import MarkerAssistant
from studio.panels.markers.cleaning_steps import StepList

MARKER_DIALOG_SIZE = (1120, 680)


def open_markers(bench: Workbench, capture_id: str | None = None) -> "MarkerDialog":
    """Show the markers of a capture, by default of the selected or playing one. Raises StudioError if there are
    none.
    """
    capture_id = capture_id or _shown_capture(bench)
    capture = bench.document.project.captures.get(capture_id or "")
    if capture_id is None or capture is None or capture.markers is None:
        raise StudioError("No optical capture is selected. Import a C3D file, or select one in the outliner.")
    dialog = MarkerDialog(bench, capture_id, capture)
    dialog.show()
    return dialog


def has_markers(bench: Workbench) -> bool:
    """True if the selected or the playing capture has markers."""
    capture = bench.document.project.captures.get(_shown_capture(bench) or "")
    return capture is not None and capture.markers is not None


def _shown_capture(bench: Workbench) -> str | None:
    selected = bench.document.selection.of("captures")
    if selected:
        return str(selected[0])
    motion = bench.document.project.motions.get(bench.document.active_motion_id or "")
    return motion.capture_id if motion else None


class MarkerDialog(QDialog):
    """Non-modal marker dialog. Its settings are applied by a button, as one undo step."""

    def __init__(self, bench: Workbench, capture_id: str, capture: Capture) -> None:
        super().__init__(bench.window)
        assert capture.markers is not None
        self._bench, self._capture_id, self._take = bench, capture_id, capture.markers
        self._is_open = True  # Qt's part of it is deleted when it closes
        self.setWindowTitle(f"Markers of {capture.name}")
        self.setObjectName("marker_dialog")
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self.resize(*MARKER_DIALOG_SIZE)
        self.assistant = MarkerAssistant(self._take, capture.up_axis)
        self.steps = StepList(self._take.steps)
        from studio.panels.markers.signals import SignalPlot  # late: pyqtgraph is the views', which come later

        self.signals = SignalPlot(self._take.trial, self._seek)
        self.tabs = QTabWidget()
        self.tabs.setDocumentMode(True)
        for widget, title in ((self.assistant, "Map"), (self.steps, "Cleaning"), (self.signals, "Signals")):
            self.tabs.addTab(widget, title)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, FIELD_ICON_PX)
        column.addWidget(self.tabs, 1)
        column.addLayout(self._make_foot())
        self.assistant.changed.connect(self._refresh)
        for part in (self.assistant, self.signals):
            part.marked.connect(self._mark)
        self.finished.connect(self._end)
        self.steps.changed.connect(self._clean)
        bench.document.playhead.changed.connect(self._show_time)
        bench.document.entity_changed.connect(self._entity_changed)
        bench.document.project_opened.connect(self.close)  # its capture is in the other project
        self._show_time(bench.document.playhead.time)
        self._clean()

    def _make_foot(self) -> QHBoxLayout:
        row = QHBoxLayout()
        row.setContentsMargins(FIELD_ICON_PX, FIELD_ICON_PX, FIELD_ICON_PX, 0)
        self.words = styled_label("", "hint")
        self.apply = press_button("Apply", self.solve, "main")
        self.apply.setToolTip("Re-solve the skeleton with this marker map and these cleaning steps")
        row.addWidget(self.words, 1)
        row.addWidget(self.apply)
        row.addWidget(press_button("Close", self.close))
        return row

    @property
    def take(self) -> MarkerTake:
        """Marker take with the dialog's current settings."""
        return replace(
            self._take,
            marker_map=self.assistant.marker_map,
            subject=self.assistant.subject,
            steps=self.steps.steps,
        )

    def solve(self) -> None:
        """Solve the capture again with the current settings."""
        self.apply.setEnabled(False)
        resolve_markers(self._bench, self._capture_id, self.take)

    def _clean(self) -> None:
        """Run the cleaning steps in the background and show their reports as a preview."""
        take = self.take

        def work(progress: Callable[[float, str], None]) -> tuple[StepReport, ...]:
            progress(0.0, "Cleaning")
            return cleaned_trial(take.trial.with_labels(mapped_labels(take)), take.steps)[1]

        def done(reports: tuple[StepReport, ...]) -> None:
            if self._is_open and self.steps.steps == take.steps:
                self.steps.show_reports(reports)

        self._bench.runner.run("Previewing cleaning steps", work, done)
        self._refresh()

    def _refresh(self) -> None:
        self.words.setText(self.assistant.summary)
        now, shown = self.take, self._take
        same = (now.marker_map, now.subject, now.steps) == (shown.marker_map, shown.subject, shown.steps)
        self.apply.setEnabled(not same)

    def _entity_changed(self, collection: str, entity_id: str) -> None:
        if (collection, entity_id) != ("captures", self._capture_id):
            return
        capture = self._bench.document.project.captures.get(entity_id)
        if capture is None or capture.markers is None:
            self.close()
            return
        self._take = capture.markers
        self._refresh()

    def _end(self) -> None:
        self._is_open = False
        self._mark(())

    def _mark(self, labels: Collection[str]) -> None:
        """Highlight markers in the 3D view."""
        if self._bench.has_viewport:
            self._bench.viewport.recording.set_marked(labels)

    def _show_time(self, seconds: float) -> None:
        self.signals.show_time(seconds)
        self.assistant.cloud.show_time(seconds)

    def _seek(self, seconds: float) -> None:
        self._bench.document.playhead.set_time(seconds)
