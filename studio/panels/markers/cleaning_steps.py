"""List of cleaning steps of a trial, each with a report; the recorded data itself is never changed."""

from collections.abc import Callable
from functools import partial

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QHBoxLayout, QVBoxLayout, QWidget

from studio.core.markers.cleaning import FillLongGaps, FillShortGaps, LowPass, Step, StepReport, UndoSwaps
from studio.panels.fields import FIELD_ICON_PX, Choice, NumberField, Section, press_button, styled_label

CLEANING_STEP_KINDS: tuple[tuple[Callable[[], Step], str], ...] = (
    (UndoSwaps, "Fix marker swaps"),
    (FillShortGaps, "Fill short gaps"),
    (FillLongGaps, "Fill long gaps"),
    (LowPass, "Smooth"),
)


class StepList(QWidget):
    """Ordered list of cleaning steps, which can be added, removed, reordered and adjusted."""

    changed = Signal()

    def __init__(self, steps: tuple[Step, ...]) -> None:
        super().__init__()
        self.steps = steps
        self._reports: tuple[StepReport, ...] = ()
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        self._rows = QVBoxLayout()
        column.addLayout(self._rows)
        row = QHBoxLayout()
        row.setContentsMargins(FIELD_ICON_PX, FIELD_ICON_PX, FIELD_ICON_PX, 0)
        self.add = Choice("Add a step", list(CLEANING_STEP_KINDS))
        self.add.setPlaceholderText("Add a step")
        self.add.setCurrentIndex(-1)
        self.add.value_chosen.connect(self._add)
        row.addWidget(self.add)
        row.addStretch(1)
        column.addLayout(row)
        column.addStretch(1)
        self._show()

    def show_reports(self, reports: tuple[StepReport, ...]) -> None:
        """Show the report of each step, in order."""
        self._reports = reports
        self._show()

    def _add(self, make: object) -> None:
        assert callable(make)
        self.add.setCurrentIndex(-1)
        self._set((*self.steps, make()))

    def _set(self, steps: tuple[Step, ...]) -> None:
        self.steps, self._reports = steps, ()
        self._show()
        self.changed.emit()

    def _show(self) -> None:
        while self._rows.count():
            item = self._rows.takeAt(0)
            widget = item.widget() if item is not None else None
            if widget is not None:
                widget.deleteLater()
        for index, step in enumerate(self.steps):
            self._rows.addWidget(self._make_row(index, step))
        if not self.steps:
            note = styled_label("No cleaning: the recorded data is used.", "hint")
            note.setContentsMargins(FIELD_ICON_PX, FIELD_ICON_PX, FIELD_ICON_PX, 0)
            self._rows.addWidget(note)

    def _make_row(self, index: int, step: Step) -> Section:
        section = Section(f"{index + 1}  {step.title}")
        for text, to in (("Move up", index - 1), ("Move down", index + 1)):
            if 0 <= to < len(self.steps):
                section.head.addWidget(press_button(text, partial(self._move, index, to), "link"))
        section.head.addWidget(press_button("Remove", partial(self._remove, index), "link"))
        match step:
            case FillShortGaps():
                field = NumberField("Longest gap", "s", 0.01, 5.0, 0.01)
                self._number(
                    section, index, "Max. gap", field, step.longest, lambda value: FillShortGaps(longest=value)
                )
            case LowPass():
                field = NumberField("Cut-off", "Hz", 0.5, 500.0, 0.5, 1)
                self._number(section, index, "Cut-off", field, step.cutoff, lambda value: LowPass(cutoff=value))
        if index < len(self._reports):
            report = self._reports[index]
            section.add_wide(styled_label(report.summary, "value"))
            if report.details:
                section.add_wide(styled_label("; ".join(report.details), "hint"))
        return section

    def _number(
        self,
        section: Section,
        index: int,
        label: str,
        field: NumberField,
        value: float,
        make: Callable[[float], Step],
    ) -> None:
        field.show_value(value)

        def put(number: float) -> None:
            self.steps = (*self.steps[:index], make(number), *self.steps[index + 1 :])

        field.edited.connect(put)
        field.ended.connect(self.changed)
        section.add_row(label, field)

    def _move(self, index: int, to: int) -> None:
        steps = list(self.steps)
        steps.insert(to, steps.pop(index))
        self._set(tuple(steps))

    def _remove(self, index: int) -> None:
        self._set((*self.steps[:index], *self.steps[index + 1 :]))
