"""Plot of signals recorded beside the markers: force plates, analog channels and events, over time."""

from collections.abc import Callable
from functools import partial

import numpy as np
import pyqtgraph as pg
from numpy.typing import NDArray
from PySide6.QtCore import QSignalBlocker, Qt, Signal
from PySide6.QtGui import QColor
from PySide6.QtWidgets import QHBoxLayout, QTreeWidget, QTreeWidgetItem, QVBoxLayout, QWidget

from studio.core.markers.force_plates import plate_force, sample_times
from studio.core.markers.trial import MARKER_KIND, VIRTUAL_KIND, ForcePlate, Trial, label_without_subject
from studio.document import colours
from studio.panels.fields import FIELD_ICON_PX, styled_label

FloatArray = NDArray[np.float64]
SignalCurves = list[tuple[str, FloatArray, FloatArray]]
"""Name, times (N,) and values (N,) of several curves."""

SIGNAL_LIST_WIDTH_PX = 210
SIGNAL_AXES = ("x", "y", "z")


class SignalPlot(QWidget):
    """Plot of the ticked signals, with lines for events and the playhead."""

    marked = Signal(object)
    """Emitted with the labels, without subject, of the markers that are selected or ticked in the list."""

    def __init__(self, trial: Trial, seek: Callable[[float], object]) -> None:
        super().__init__()
        self._trial, self._seek = trial, seek
        row = QHBoxLayout(self)
        row.setContentsMargins(FIELD_ICON_PX, FIELD_ICON_PX, FIELD_ICON_PX, 0)
        self.list = QTreeWidget()
        self.list.setHeaderHidden(True)
        self.list.setFixedWidth(SIGNAL_LIST_WIDTH_PX)
        self.list.setAccessibleName("Analog channels of the trial; select to show their graph")
        row.addWidget(self.list)
        column = QVBoxLayout()
        row.addLayout(column, 1)
        self.plot = pg.PlotWidget(self, background=colours.WELL)
        self.plot.setAccessibleName("Graph of the selected signals over time")
        self.plot.showGrid(x=True, y=True, alpha=0.15)
        self.plot.setLabel("bottom", "Time (s)")
        self.plot.setMouseEnabled(x=True, y=False)
        self.plot.enableAutoRange(axis="y")
        self.plot.setAutoVisible(y=True)
        self.plot.getPlotItem().setMenuEnabled(False)
        self.plot.getPlotItem().hideButtons()
        self.plot.addLegend(offset=(-8, -8), colCount=3, brush=colours.BAR, labelTextColor=colours.TEXT_SECOND)
        self._playhead = pg.InfiniteLine(angle=90, pen=pg.mkPen(colours.PLAYHEAD, width=1))
        self.plot.scene().sigMouseClicked.connect(self._clicked)
        column.addWidget(self.plot, 1)
        self.note = styled_label(_events_words(trial), "hint")
        column.addWidget(self.note)
        self._sources: list[tuple[QTreeWidgetItem, Callable[[], SignalCurves], str]] = []
        self._markers: dict[str, QTreeWidgetItem] = {}
        self._fill()
        self.list.itemChanged.connect(lambda *_: self.refresh())
        for signal in (self.list.itemChanged, self.list.currentItemChanged):
            signal.connect(lambda *_: self._mark())
        self.refresh()
        self.plot.setXRange(0.0, trial.frame_count / trial.frame_rate, padding=0.01)

    def show_time(self, seconds: float) -> None:
        """Move the line of the playhead."""
        self._playhead.setValue(seconds)

    def plotted_names(self) -> list[str]:
        """Names of the plotted signals."""
        return [item.text(0) for item, _, _ in self._sources if item.checkState(0) is Qt.CheckState.Checked]

    def tick(self, name: str, on: bool = True) -> None:
        """Tick or untick a signal."""
        for item, _, _ in self._sources:
            if item.text(0) == name:
                item.setCheckState(0, Qt.CheckState.Checked if on else Qt.CheckState.Unchecked)

    def refresh(self) -> None:
        """Plot the ticked signals again."""
        self.plot.clear()
        units, number = [], 0
        for item, make, unit in self._sources:
            if item.checkState(0) is Qt.CheckState.Checked:
                units.append(unit)
                for name, times, values in make():
                    pen = pg.mkPen(QColor(colours.character_colour(number)), width=1.3)
                    curve = self.plot.plot(times, values, pen=pen, name=name, connect="finite")
                    curve.setDownsampling(auto=True, method="peak")
                    curve.setClipToView(True)
                    number += 1
        self.plot.setLabel("left", " · ".join(dict.fromkeys(filter(None, units))))
        for event in self._trial.events:
            self._draw_event(event.label, event.context, self._trial.event_frame(event) / self._trial.frame_rate)
        self.plot.addItem(self._playhead)

    def _mark(self) -> None:
        current = self.list.currentItem()
        chosen = [
            label_without_subject(label)
            for label, item in self._markers.items()
            if item is current or item.checkState(0) is Qt.CheckState.Checked
        ]
        self.marked.emit(tuple(chosen))

    def _draw_event(self, label: str, context: str, seconds: float) -> None:
        colour = {"Left": colours.CHARACTER_COLOURS[3], "Right": colours.CHARACTER_COLOURS[2]}.get(
            context, colours.TEXT_THIRD
        )
        line = pg.InfiniteLine(
            seconds,
            angle=90,
            pen=pg.mkPen(QColor(colour), width=1, style=Qt.PenStyle.DashLine),
            label=f"{context[:1]} {label}".strip(),
            labelOpts={"position": 0.97, "rotateAxis": (1, 0), "anchors": [(1, 0), (1, 1)], "color": colour},
        )
        self.plot.addItem(line)

    def _fill(self) -> None:
        trial = self._trial
        with QSignalBlocker(self.list):
            measuring = [(place, plate) for place, plate in enumerate(trial.plates) if plate.channels]
            plates = self._group("Force plates", bool(measuring))
            for place, plate in measuring:
                name = f"Plate {place + 1}"
                unit = trial.analog.units[plate.channels[0]]
                self._add(plates, name, partial(self._force, name, plate), unit, ticked=True)
            markers = self._group("Markers", bool(trial.markers))
            analog = self._group("Signals", bool(trial.analog.labels))
            times = sample_times(trial)
            for column, (label, unit) in enumerate(zip(trial.analog.labels, trial.analog.units, strict=True)):
                samples = trial.analog.samples[:, column]
                self._add(analog, label, partial(_one, label, times, samples), unit)
            points = self._group("Model outputs", any(kind not in (MARKER_KIND, VIRTUAL_KIND) for kind in trial.kinds))
            frames = np.arange(trial.frame_count) / trial.frame_rate
            for column, (label, kind) in enumerate(zip(trial.labels, trial.kinds, strict=True)):
                track = trial.points[:, column]
                if kind == MARKER_KIND and trial.ever_seen[column]:
                    self._markers[label] = self._add(markers, label, partial(_axes, label, frames, track), trial.unit)
                elif kind not in (MARKER_KIND, VIRTUAL_KIND):
                    self._add(points, label, partial(_axes, label, frames, track), kind)
        for group in (plates, markers, analog, points):
            group.setExpanded(group.childCount() <= 24)

    def _group(self, name: str, shown: bool) -> QTreeWidgetItem:
        group = QTreeWidgetItem([name])
        group.setFlags(Qt.ItemFlag.ItemIsEnabled)
        self.list.addTopLevelItem(group)
        group.setHidden(not shown)
        return group

    def _add(
        self, group: QTreeWidgetItem, name: str, make: Callable[[], SignalCurves], unit: str, ticked: bool = False
    ) -> QTreeWidgetItem:
        item = QTreeWidgetItem([name])
        item.setFlags(Qt.ItemFlag.ItemIsEnabled | Qt.ItemFlag.ItemIsSelectable | Qt.ItemFlag.ItemIsUserCheckable)
        item.setCheckState(0, Qt.CheckState.Checked if ticked else Qt.CheckState.Unchecked)
        group.addChild(item)
        self._sources.append((item, make, unit))
        return item

    def _force(self, name: str, plate: ForcePlate) -> SignalCurves:
        return _axes(name, sample_times(self._trial), plate_force(self._trial, plate))

    def _clicked(self, event: object) -> None:
        place = self.plot.getPlotItem().vb.mapSceneToView(event.scenePos())  # type: ignore[attr-defined]
        self._seek(float(place.x()))


def _one(name: str, times: FloatArray, values: FloatArray) -> SignalCurves:
    return [(name, times, values)]


def _axes(name: str, times: FloatArray, values: FloatArray) -> SignalCurves:
    return [(f"{name} {axis}", times, values[:, index]) for index, axis in enumerate(SIGNAL_AXES)]


def _events_words(trial: Trial) -> str:
    if not (trial.analog.labels or trial.events):
        return "This trial has no analog signals or events."
    return f"{len(trial.events)} events. Wheel zooms, drag pans, click sets the time."
