"""Form section of the worst residual of a constraint on each performer, while the constraint is fully active."""

from dataclasses import dataclass

from PySide6.QtCore import QSize, Qt
from PySide6.QtGui import QColor, QPainter, QPaintEvent, QResizeEvent
from PySide6.QtWidgets import QSizePolicy, QWidget

from studio.core.constraints.base import Constraint
from studio.core.stage.project import Project
from studio.document import colours
from studio.engine.live_interface import Live
from studio.engine.residuals import Inactive, Residual, inactivity, residuals_on, unsolved_words, worst_residual
from studio.panels.editor import Editor
from studio.panels.fields import Section

RESIDUAL_ROW_PX, RESIDUAL_COLUMNS, RESIDUAL_GAP_PX = 18, 2, 16
RESIDUAL_DOT_PX = 16
WIDEST_RESIDUAL_TEXT = "0000 mm*"
"""Text that sets the column width, so that the layout does not jump while residuals change."""


@dataclass(frozen=True)
class BodyResidual:
    """Performer and its worst residual, None if the constraint is inactive; ``unsolved`` is the reason if it is
    unknown.
    """

    name: str
    colour: str
    worst: Residual | None
    unsolved: str = ""
    inactive: Inactive = Inactive.ELSEWHERE

    @property
    def state(self) -> tuple[str, str]:
        """Text and colour of the state, since colour alone is not enough."""
        if self.unsolved:
            return self.unsolved, colours.TEXT_THIRD
        if self.worst is None:
            return self.inactive, self.inactive.colour
        if self.worst.is_invisible:
            return "met", colours.mixed_colour(colours.HELD, colours.TEXT, 0.35)
        if self.worst.is_hardly_visible:
            return "partly met", colours.PARTLY
        return "not met", colours.NOT_REACHED


def residuals_of(project: Project, live: Live, constraint_id: str) -> list[BodyResidual]:
    """Worst residual of each visible performer to which the constraint applies."""
    constraint = project.constraints[constraint_id]
    return [
        _residual_on(project, live, key, constraint_id)
        for key, performer in project.performers.items()
        if performer.visible
        and any(
            clip.motion_id == constraint.motion_id and constraint.scope.includes(key, clip.id)
            for clip in performer.clips
        )
    ]


def _residual_on(project: Project, live: Live, performer_id: str, constraint_id: str) -> BodyResidual:
    performer, motion = project.performers[performer_id], live.reported_motion(performer_id)
    name, colour = performer.name, project.characters[performer.character_id].colour
    worst = worst_residual(project, performer_id, motion, constraint_id)
    if worst is not None:
        return BodyResidual(name, colour, worst)
    is_unsolved = (
        project.constraints[constraint_id].enabled
        and residuals_on(project, performer_id, motion, constraint_id) is None
    )
    inactive = inactivity(project, performer_id, motion, constraint_id)
    return BodyResidual(name, colour, None, unsolved_words(live) if is_unsolved else "", inactive)


class ResidualTable(QWidget):
    """Performers with colour dot, name and residual; in two columns if the names fit."""

    def __init__(self) -> None:
        super().__init__()
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.residuals: list[BodyResidual] = []

    def show_residuals(self, residuals: list[BodyResidual]) -> None:
        """Show ``residuals``, one line each."""
        if residuals != self.residuals:
            before = self.sizeHint()
            self.residuals = residuals
            lines = [f"{each.name}: {words_of(each)}" for each in residuals]
            self.setAccessibleDescription("; ".join(lines))
            self.setToolTip("\n".join(lines))
            if self.sizeHint() != before:
                self.updateGeometry()
            self.update()

    @property
    def columns(self) -> int:
        """Number of columns in which all names fit."""
        metrics, room = self.fontMetrics(), (self.width() - RESIDUAL_GAP_PX) // RESIDUAL_COLUMNS
        names = max((metrics.horizontalAdvance(each.name) for each in self.residuals), default=0)
        return (
            RESIDUAL_COLUMNS
            if RESIDUAL_DOT_PX + names + 6 + metrics.horizontalAdvance(WIDEST_RESIDUAL_TEXT) <= room
            else 1
        )

    def sizeHint(self) -> QSize:
        return QSize(200, RESIDUAL_ROW_PX * max(-(-len(self.residuals) // self.columns), 1))

    def resizeEvent(self, _: QResizeEvent) -> None:
        self.updateGeometry()

    def paintEvent(self, _: QPaintEvent) -> None:
        with QPainter(self) as painter:
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            columns = self.columns
            width = (
                (self.width() - RESIDUAL_GAP_PX) // RESIDUAL_COLUMNS if columns == RESIDUAL_COLUMNS else self.width()
            )
            for index, residual in enumerate(self.residuals):
                self._paint(
                    painter,
                    index // columns * RESIDUAL_ROW_PX,
                    index % columns * (width + RESIDUAL_GAP_PX),
                    width,
                    residual,
                )

    def _paint(self, painter: QPainter, top: int, left: int, width: int, residual: BodyResidual) -> None:
        baseline, metrics = top + 13, painter.fontMetrics()
        painter.setPen(QColor(0, 0, 0, 0))
        painter.setBrush(QColor(residual.colour))
        painter.drawEllipse(left, top + 5, 8, 8)
        text, colour = short_words_of(residual), residual.state[1]
        start = left + width - metrics.horizontalAdvance(text)
        name = metrics.elidedText(residual.name, Qt.TextElideMode.ElideRight, start - left - 22)
        painter.setPen(QColor(colours.TEXT))
        painter.drawText(left + RESIDUAL_DOT_PX, baseline, name)
        painter.setPen(QColor(colour))
        painter.drawText(start, baseline, text)


def words_of(residual: BodyResidual) -> str:
    """Residual as text: ``not reached, 42 mm at 23``, or that the constraint is met or inactive."""
    word, _ = residual.state
    if residual.worst is None or word == "met":
        return word
    remark = f", {residual.worst.remark}" if residual.worst.remark else ""
    return f"{word}, {residual.worst.text} at {residual.worst.stage_frame}{remark}"


def short_words_of(residual: BodyResidual) -> str:
    """Residual as short text: ``42 mm``, or that the constraint is met or inactive; with a star if it is never fully
    active.
    """
    word, _ = residual.state
    if residual.unsolved:
        return "…"
    if residual.worst is None:
        return residual.inactive.short
    if word == "met":
        return word
    return f"{residual.worst.text}{'*' if residual.worst.remark else ''}"


class ResidualSection(Section):
    """Form section with the table of residuals, updated whenever new ones are solved."""

    def __init__(self, editor: Editor[Constraint]) -> None:
        super().__init__("Error")
        self._editor = editor
        self._table = ResidualTable()
        self._table.setAccessibleName("Error on each character")
        self.add_wide(self._table)
        editor.live.reported_changed.connect(self._reported_changed)

    def _reported_changed(self) -> None:
        if self._editor.entity is not None:
            self._show()

    def refresh(self) -> None:
        """Show the newest residuals; during a drag they are shown when the solver reports them."""
        if not self._editor.live.interactive:
            self._show()

    def _show(self) -> None:
        editor = self._editor
        self._table.show_residuals(residuals_of(editor.document.project, editor.live, editor.entity_id))
