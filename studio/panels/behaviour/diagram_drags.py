"""Mouse gestures in the diagram: move states, draw transitions, select in a rectangle, or pan."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QMouseEvent, QPainter, QPen

from studio.core.stage.behaviour import Behaviour
from studio.document import colours
from studio.document.behaviour_commands import state_key
from studio.panels.behaviour.diagram_items import StateItem, exit_point

if TYPE_CHECKING:
    from studio.panels.behaviour.diagram import Diagram

DIAGRAM_SNAP = 8.0
DRAG_START_PIXELS = 3
"""Distance in pixels from which a mouse movement counts as a drag."""


class DiagramGesture:
    """Base of mouse gestures, from the press to the release of a button."""

    def __init__(self, view: Diagram, event: QMouseEvent, position: QPointF) -> None:
        self.view, self.begin, self.now = view, position, position
        self._pressed = event.position()
        self.dragged = False

    def move(self, event: QMouseEvent, position: QPointF) -> None:
        """Handle a mouse move, which becomes a drag after ``DRAG_START_PIXELS`` pixels."""
        self.now = position
        self.dragged = self.dragged or (event.position() - self._pressed).manhattanLength() >= DRAG_START_PIXELS
        if self.dragged:
            self.drag(event)
        self.view.viewport().update()

    def drag(self, event: QMouseEvent) -> None:
        """Continue the drag to the position of ``event``."""

    def release(self, event: QMouseEvent, position: QPointF) -> None:
        """Finish the gesture."""

    def cancel(self) -> None:
        """Restore the state before the gesture."""

    def paint(self, painter: QPainter) -> None:
        """Draw a preview of the gesture."""


def gesture_at_press(view: Diagram, event: QMouseEvent, position: QPointF) -> DiagramGesture | None:
    """Gesture that a press at ``position`` starts; None if it starts none."""
    left = event.button() is Qt.MouseButton.LeftButton
    alt = bool(event.modifiers() & Qt.KeyboardModifier.AltModifier)
    if event.button() is Qt.MouseButton.MiddleButton or (left and alt):
        return PanDiagram(view, event, position)
    if not left:
        return None
    state = view.state_at(position)
    if state is not None and state.on_rim(position):
        return DrawTransition(view, event, position, state)
    item = view.item_at(position)
    if item is None:
        return SelectStates(view, event, position)
    if event.modifiers() & Qt.KeyboardModifier.ControlModifier:
        view.document.selection.toggle(item)
    elif item not in view.document.selection:
        view.select(item)
    return MoveStates(view, event, position) if state is not None else None


class MoveStates(DiagramGesture):
    """Drag of the selected states, snapped to a grid, as one undo step."""

    def __init__(self, view: Diagram, event: QMouseEvent, position: QPointF) -> None:
        super().__init__(view, event, position)
        assert view.behaviour is not None
        self._before: Behaviour = view.behaviour
        self._number = view.document.new_gesture()

    def drag(self, event: QMouseEvent) -> None:
        """Move the states by the displacement of the mouse."""
        way = self.now - self.begin
        selection, behaviour_id = self.view.document.selection, self.view.behaviour_id
        names = {e.name for e in self._before.states if ("states", state_key(behaviour_id, e.name)) in selection}
        places = {
            each.name: (_snapped(each.place[0] + way.x()), _snapped(each.place[1] + way.y()))
            for each in self._before.states
            if each.name in names
        }

        def moved(old: Behaviour) -> Behaviour:
            return replace(old, states=tuple(replace(s, place=places.get(s.name, s.place)) for s in old.states))

        text = f"Move {next(iter(names))}" if len(names) == 1 else f"Move {len(names)} states"
        self.view.edit(moved, text, self._number)

    def cancel(self) -> None:
        """Move the states back to their positions before the drag."""
        self.view.edit(lambda _: self._before, "Move", self._number)


class DrawTransition(DiagramGesture):
    """Drag of an arrow from the rim of a box. Released on another box it adds a transition, on the background also a
    new state.
    """

    def __init__(self, view: Diagram, event: QMouseEvent, position: QPointF, source: StateItem) -> None:
        super().__init__(view, event, position)
        self._source = source.box.name

    def release(self, event: QMouseEvent, position: QPointF) -> None:
        """Add the transition. A click on the rim, or a release on the same box, only selects the state."""
        target = self.view.state_at(position)
        if not self.dragged or (target is not None and target.box.name == self._source):
            self.view.select(("states", state_key(self.view.behaviour_id, self._source)))
            return
        if target is not None:
            self.view.connect_states(self._source, target.box.name)
            return
        document = self.view.document
        with document.group("Add state and transition"):
            name = self.view.add_state(position)
            self.view.connect_states(self._source, name)

    def paint(self, painter: QPainter) -> None:
        """Draw the arrow up to the mouse."""
        source, target = self.view.states[self._source], self.view.state_at(self.now)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(QPen(QColor(colours.SELECTED_HANDLE), 2.0, Qt.PenStyle.DashLine))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        end = self.now
        if target is not None and target is not source:
            end = exit_point(target.rect, source.rect.center())
            painter.drawRoundedRect(target.rect.adjusted(-3, -3, 3, 3), 7, 7)
        painter.drawLine(exit_point(source.rect, end), end)
        painter.setBrush(QColor(colours.SELECTED_HANDLE))
        painter.drawEllipse(end, 3.0, 3.0)


class SelectStates(DiagramGesture):
    """Drag of a selection rectangle; a click selects the whole behaviour."""

    def release(self, event: QMouseEvent, position: QPointF) -> None:
        """Select the states in the rectangle."""
        area = QRectF(self.begin, position).normalized()
        inside = [name for name, item in self.view.states.items() if self.dragged and area.intersects(item.rect)]
        self.view.select(*(("states", state_key(self.view.behaviour_id, name)) for name in inside))

    def paint(self, painter: QPainter) -> None:
        """Draw the rectangle."""
        if self.dragged:
            painter.setPen(QPen(QColor(colours.SELECTED_HANDLE), 1.0, Qt.PenStyle.DotLine))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.drawRect(QRectF(self.begin, self.now).normalized())


class PanDiagram(DiagramGesture):
    """Pan the view with the mouse."""

    def __init__(self, view: Diagram, event: QMouseEvent, position: QPointF) -> None:
        super().__init__(view, event, position)
        self._last = event.position()
        view.viewport().setCursor(Qt.CursorShape.ClosedHandCursor)

    def drag(self, event: QMouseEvent) -> None:
        """Pan by the displacement of the mouse."""
        self.view.pan((event.position() - self._last).toPoint())
        self._last = event.position()

    def release(self, event: QMouseEvent, position: QPointF) -> None:
        """Restore the cursor."""
        self.view.viewport().setCursor(Qt.CursorShape.ArrowCursor)


def _snapped(number: float) -> float:
    return DIAGRAM_SNAP * round(number / DIAGRAM_SNAP)
