"""How well a constraint holds on each body: the worst distance while it is fully active."""

from dataclasses import dataclass

import numpy as np
from PySide6.QtCore import QSize
from PySide6.QtGui import QColor, QPainter, QPaintEvent
from PySide6.QtWidgets import QSizePolicy, QWidget

from studio.core.project import Project
from studio.document import colours
from studio.panels.editor import Editor
from studio.panels.fields import Section
from studio.panels.live import Live

HELD_BELOW = 0.001
PARTLY_BELOW = 0.020
FULLY_ACTIVE = 1.0 - 1e-6
ROW = 20
MILLIMETRES = 1000.0


@dataclass(frozen=True)
class Residual:
    """The worst distance in metres on one body, and the frame where it is; None while it is not known."""

    name: str
    colour: str
    metres: float | None
    frame: int

    @property
    def state(self) -> tuple[str, str]:
        """(word, colour): so that neither stands alone."""
        if self.metres is None:
            return "not active", colours.TEXT_THIRD
        if self.metres < HELD_BELOW:
            return "held", colours.mixed(colours.HELD, "#ffffff", 0.35)
        if self.metres < PARTLY_BELOW:
            return "partly", colours.PARTLY
        return "short", colours.NOT_REACHED


def residuals_of(project: Project, live: Live, constraint_id: str) -> list[Residual]:
    """One for each visible performer that plays the constraint's motion."""
    constraint = project.constraints[constraint_id]
    asked = [key for key, each in project.constraints_of(constraint.motion_id).items() if each.enabled]
    found = []
    for key, performer in project.performers.items():
        if not performer.visible or not any(c.motion_id == constraint.motion_id for c in performer.clips):
            continue
        colour = project.characters[performer.character_id].colour
        result = live.result(key)
        metres, frame = None, 0
        if result is not None and constraint_id in asked and len(result.residuals) == len(asked):
            times = (result.first_frame + np.arange(result.frame_count)) / result.frame_rate
            full = constraint.activation.at(times) >= FULLY_ACTIVE
            row = np.where(full, result.residuals[asked.index(constraint_id)], np.nan)
            if np.isfinite(row).any():
                place = int(np.nanargmax(row))
                metres, frame = float(row[place]), result.first_frame + place
        found.append(Residual(performer.name, colour, metres, frame))
    return found


class ResidualTable(QWidget):
    """A line a body: dot, name, a bar that grows with the error, millimetres and the frame."""

    def __init__(self) -> None:
        super().__init__()
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.residuals: list[Residual] = []

    def show_residuals(self, residuals: list[Residual]) -> None:
        """Show these lines."""
        if residuals != self.residuals:
            resized = len(residuals) != len(self.residuals)
            self.residuals = residuals
            self.setAccessibleDescription("; ".join(f"{each.name} {words_of(each)}" for each in residuals))
            if resized:
                self.updateGeometry()
            self.update()

    def sizeHint(self) -> QSize:
        return QSize(200, ROW * max(len(self.residuals), 1))

    def paintEvent(self, _: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        for place, residual in enumerate(self.residuals):
            self._paint(painter, place * ROW, residual)
        painter.end()

    def _paint(self, painter: QPainter, top: int, residual: Residual) -> None:
        baseline = top + 14
        painter.setPen(QColor(0, 0, 0, 0))
        painter.setBrush(QColor(residual.colour))
        painter.drawEllipse(0, top + 6, 8, 8)
        painter.setPen(QColor(colours.TEXT))
        painter.drawText(16, baseline, residual.name)
        text, colour = words_of(residual), residual.state[1]
        painter.setPen(QColor(colour))
        painter.drawText(self.width() - painter.fontMetrics().horizontalAdvance(text), baseline, text)


def words_of(residual: Residual) -> str:
    """``42 mm at 23``, or that it holds, or that it is not active."""
    word, _ = residual.state
    if residual.metres is None or word == "held":
        return word
    return f"{word} by {residual.metres * MILLIMETRES:.3g} mm at {residual.frame}"


class ResidualSection(Section):
    """The table, kept fresh by the engine's answers."""

    def __init__(self, editor: Editor) -> None:
        super().__init__("Reached")
        self._editor = editor
        self._table = ResidualTable()
        self._table.setAccessibleName("How well it holds on each body")
        self.add_wide(self._table)
        editor.live.adapted.connect(self._adapted)

    def _adapted(self, _: str) -> None:
        if self._editor.entity is not None:
            self.refresh()

    def refresh(self) -> None:
        """Fetch the engine's newest residuals."""
        editor = self._editor
        self._table.show_residuals(residuals_of(editor.document.project, editor.live, editor.entity_id))
