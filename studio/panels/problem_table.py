"""Table of all constraints by character, and of foot sliding, penetration and pops; a click goes to the worst frame."""

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QColor, QHideEvent, QShowEvent
from PySide6.QtWidgets import QAbstractItemView, QHeaderView, QTableWidget, QTableWidgetItem, QVBoxLayout, QWidget

from studio.document import colours
from studio.engine.problem_search import ProblemSearch
from studio.engine.quality_summary import ASPECT_HINTS, ASPECT_TITLES, ASPECTS, Finding, SummaryRow
from studio.panels.fields import styled_label

PROBLEM_COLUMNS = ("Character", "Constraint", *ASPECT_TITLES.values())
NO_ROWS_HINT = "Nothing is adapted yet. Drop a capture and add constraints; their errors are listed here."
ROW_ROLE, ASPECT_ROLE, BADNESS_ROLE = (
    Qt.ItemDataRole.UserRole,
    Qt.ItemDataRole.UserRole + 1,
    Qt.ItemDataRole.UserRole + 2,
)


class _Cell(QTableWidgetItem):
    """Table cell that is sorted by its badness if it has one, else by its text."""

    def __lt__(self, other: QTableWidgetItem) -> bool:
        own, theirs = self.data(BADNESS_ROLE), other.data(BADNESS_ROLE)
        if own is None or theirs is None:
            return self.text().lower() < other.text().lower()
        return bool(own < theirs)


class ProblemTable(QWidget):
    """Sortable problem table; ``problem_chosen`` is emitted with a row and the aspect of the clicked cell."""

    problem_chosen = Signal(object, str)

    def __init__(self, search: ProblemSearch) -> None:
        super().__init__()
        self.setObjectName("panel")
        self.setAttribute(Qt.WidgetAttribute.WA_StyledBackground)
        self._search = search
        self.table = QTableWidget(0, len(PROBLEM_COLUMNS))
        self.table.setAccessibleName("Constraints by character")
        self.table.setHorizontalHeaderLabels(PROBLEM_COLUMNS)
        for index, aspect in enumerate(ASPECTS):
            header = self.table.horizontalHeaderItem(index + 2)
            assert header is not None
            header.setToolTip(ASPECT_HINTS[aspect])
        self.table.verticalHeader().hide()
        self.table.setShowGrid(False)
        self.table.setEditTriggers(QAbstractItemView.EditTrigger.NoEditTriggers)
        self.table.setSelectionMode(QAbstractItemView.SelectionMode.SingleSelection)
        self.table.horizontalHeader().setSectionResizeMode(QHeaderView.ResizeMode.Stretch)
        self.table.setSortingEnabled(True)
        self.table.sortByColumn(2, Qt.SortOrder.DescendingOrder)
        self.table.cellClicked.connect(self._choose)
        self.table.cellActivated.connect(self._choose)
        self._hint = styled_label(NO_ROWS_HINT, "hint")
        self._hint.setContentsMargins(12, 8, 12, 8)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(self._hint)
        column.addWidget(self.table)
        search.found.connect(self.refresh)
        self.refresh()

    def refresh(self) -> None:
        """Show the newest rows of the problem search."""
        rows = self._search.rows
        self._hint.setVisible(not rows)
        self.table.setVisible(bool(rows))
        self.table.setSortingEnabled(False)
        self.table.setRowCount(len(rows))
        for line, row in enumerate(rows):
            for column, text in enumerate((row.body, row.name)):
                self._put(line, column, row, ASPECTS[0], text, None)
            for index, aspect in enumerate(ASPECTS):
                self._put(line, index + 2, row, aspect, "", row.findings.get(aspect))
        self.table.setSortingEnabled(True)

    def _put(self, line: int, column: int, row: SummaryRow, aspect: str, text: str, finding: Finding | None) -> None:
        cell = _Cell(text if column < 2 else finding.text if finding else "–")
        cell.setData(ROW_ROLE, row)
        cell.setData(ASPECT_ROLE, aspect)
        if column >= 2:
            cell.setData(BADNESS_ROLE, finding.weight if finding else -1.0)
            cell.setTextAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
            if finding is not None and finding.amount > finding.measure.worth_saying:
                missed = finding.amount > finding.measure.partly_below
                cell.setForeground(QColor(colours.NOT_REACHED if missed else colours.PARTLY))
        self.table.setItem(line, column, cell)

    def _choose(self, line: int, column: int) -> None:
        cell = self.table.item(line, column)
        if cell is not None:
            self.problem_chosen.emit(cell.data(ROW_ROLE), cell.data(ASPECT_ROLE))

    def showEvent(self, event: QShowEvent) -> None:
        """Resume updates while the table is visible."""
        super().showEvent(event)
        self._search.set_continuous(True)

    def hideEvent(self, event: QHideEvent) -> None:
        """Stop updates while the table is hidden."""
        super().hideEvent(event)
        self._search.set_continuous(False)
