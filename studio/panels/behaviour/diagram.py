"""Diagram of a behaviour: states are boxes that can be dragged, transitions are arrows drawn from their edges. Every
change is an undo step.
"""

from collections.abc import Callable
from dataclasses import replace

from PySide6.QtCore import QEvent, QPoint, QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QContextMenuEvent, QKeyEvent, QMouseEvent, QPainter, QPen, QResizeEvent, QWheelEvent
from PySide6.QtWidgets import QFrame, QGraphicsScene, QGraphicsView, QLineEdit, QMenu

from studio.core.errors import StudioError
from studio.core.stage import behaviour_edits as edits
from studio.core.stage.behaviour import Behaviour, State
from studio.core.stage.project import Project
from studio.document import colours
from studio.document.behaviour_commands import BehaviourEdit, edit_behaviour, state_key, transition_key
from studio.document.document import Document
from studio.document.mnemonics import escaped_mnemonics
from studio.document.selection import Item
from studio.panels.behaviour import diagram_drags
from studio.panels.behaviour.diagram_items import Arrow, StateBox, StateItem, TransitionItem, bow_of
from studio.panels.behaviour.words import clip_words, condition_words, manner_words

SCENE_RECT = QRectF(-4000.0, -4000.0, 8000.0, 8000.0)
DIAGRAM_GRID = 24.0
ZOOM_PER_STEP, MIN_ZOOM, MAX_ZOOM = 1.0015, 0.25, 2.5
DIAGRAM_MARGIN = 16.0


class Diagram(QGraphicsView):
    """View of one behaviour; it keeps no copy of it."""

    def __init__(self, document: Document) -> None:
        super().__init__()
        self.document, self.behaviour_id = document, ""
        self.running: dict[str, str] = {}
        """State of each performer, by performer id, while the stage runs."""
        self.states: dict[str, StateItem] = {}
        self.arrows: list[TransitionItem] = []
        self.gesture: diagram_drags.DiagramGesture | None = None
        self._renaming: QLineEdit | None = None
        self._whole = True
        """True while the view is fitted to the whole diagram: until the user zooms or pans."""
        self.setScene(QGraphicsScene(SCENE_RECT, self))
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setBackgroundBrush(QColor(colours.WELL))
        self.setAccessibleName("Diagram of the behaviour")
        for bars in (self.setHorizontalScrollBarPolicy, self.setVerticalScrollBarPolicy):
            bars(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setTransformationAnchor(QGraphicsView.ViewportAnchor.NoAnchor)
        self.setViewportUpdateMode(QGraphicsView.ViewportUpdateMode.FullViewportUpdate)
        self.setMouseTracking(True)
        self.viewport().setMouseTracking(True)
        self.setFocusPolicy(Qt.FocusPolicy.ClickFocus)

    @property
    def behaviour(self) -> Behaviour | None:
        """Shown behaviour in the current project; None if it was deleted."""
        return self.document.project.behaviours.get(self.behaviour_id)

    def show_behaviour(self, behaviour_id: str) -> None:
        """Draw a behaviour; fit the view if another one was shown before."""
        other = behaviour_id != self.behaviour_id
        if other:
            self.leave_gesture()
        self.behaviour_id = behaviour_id
        self.refresh()
        if other:
            self.fit()

    def refresh(self) -> None:
        """Draw all states and transitions again."""
        scene, behaviour = self.scene(), self.behaviour
        for item in (*self.states.values(), *self.arrows, *(each.words for each in self.arrows)):
            scene.removeItem(item)
        self.states, self.arrows = {}, []
        if behaviour is None:
            return
        for state in behaviour.states:
            self.states[state.name] = StateItem(self._box(behaviour, state))
        self.arrows = [TransitionItem(arrow) for arrow in self._arrows(behaviour)]
        for item in (*self.arrows, *(each.words for each in self.arrows), *self.states.values()):
            scene.addItem(item)

    def fit(self) -> None:
        """Fit the whole diagram into the view, without magnifying it."""
        area = QRectF()
        for item in (*self.states.values(), *self.arrows, *(each.words for each in self.arrows)):
            area = area.united(item.boundingRect())
        room = self.viewport().rect().adjusted(0, 0, -1, -1)
        area.adjust(-DIAGRAM_MARGIN, -DIAGRAM_MARGIN, DIAGRAM_MARGIN, DIAGRAM_MARGIN)
        scale = min(room.width() / area.width(), room.height() / area.height(), 1.0)
        self.resetTransform()
        self.scale(max(scale, MIN_ZOOM), max(scale, MIN_ZOOM))
        self.centerOn(area.center())
        self._whole = True

    def edit(self, edit: BehaviourEdit, text: str, gesture: int | None = None) -> bool:
        """Change the behaviour by ``edit``; False if it was deleted or the edit is invalid, which is reported as a
        message.
        """
        if self.behaviour is None:
            return False
        try:
            edit_behaviour(self.document, self.behaviour_id, edit, text, gesture)
        except StudioError as error:
            self.document.problem_reported.emit(str(error))
            return False
        return True

    def add_state(self, position: QPointF | None = None) -> str:
        """Add and select a state at ``position``, or at a free place in view. Returns its name, or an empty text if the
        edit was refused.
        """
        found = position or self._free_place()
        before = self.behaviour
        if before is None:
            return ""
        new = State("State", place=(round(found.x(), 1), round(found.y(), 1)))
        if not self.edit(lambda old: edits.with_state(old, new), "Add state"):
            return ""
        name = self.document.project.behaviours[self.behaviour_id].states[-1].name
        self.select(("states", state_key(self.behaviour_id, name)))
        return name

    def connect_states(self, source: str, target: str) -> None:
        """Add a transition between two states and select it, so that its form is shown."""
        if self.edit(lambda old: edits.with_new_transition(old, source, target), f"Add transition to {target}"):
            last = len(self.document.project.behaviours[self.behaviour_id].transitions) - 1
            self.select(("transitions", transition_key(self.behaviour_id, last)))

    def select(self, *items: Item) -> None:
        """Select parts of the behaviour together with the active performer; without ``items``, the whole behaviour."""
        document = self.document
        active = document.active_performer_id
        bodies = [("performers", active)] if active else []
        document.selection.set(*bodies, *(items or [("behaviours", self.behaviour_id)]))

    def rename(self, name: str) -> None:
        """Let the user edit the name of a state in its box."""
        self._end_renaming()
        if name not in self.states:
            return
        rect = self.mapFromScene(self.states[name].rect).boundingRect()
        field = QLineEdit(name, self.viewport())
        field.setAccessibleName("Name of the state")
        field.setGeometry(rect.left(), rect.top(), max(rect.width(), 120), 26)
        field.selectAll()
        field.show()
        field.setFocus()
        self._renaming = field
        field.editingFinished.connect(lambda: self._renamed(name, field))

    def _renamed(self, name: str, field: QLineEdit) -> None:
        if self._renaming is not field:
            return
        self._end_renaming()
        new, behaviour = field.text().strip(), self.behaviour
        state = behaviour.state(name) if behaviour else None
        if state is not None and new and new != name:
            renamed = self.edit(lambda old: edits.with_state_put(old, name, replace(state, name=new)), f"Rename {name}")
            if renamed:
                self.select(("states", state_key(self.behaviour_id, new)))

    def _end_renaming(self) -> None:
        field, self._renaming = self._renaming, None
        if field is not None:
            field.hide()
            field.deleteLater()

    # Items under the mouse

    def state_at(self, position: QPointF) -> StateItem | None:
        """Box at a scene position; None if there is none."""
        return next((item for item in reversed(self.states.values()) if item.contains_point(position)), None)

    def arrow_at(self, position: QPointF) -> TransitionItem | None:
        """Arrow at a scene position, labels first; None if there is none."""
        arrows = sorted(self.arrows, key=lambda item: not item.label.contains(position))
        return next((item for item in arrows if item.contains_point(position)), None)

    def item_at(self, position: QPointF) -> Item | None:
        """Selection item of the box or arrow at ``position``; None if there is none."""
        state = self.state_at(position)
        if state is not None:
            return "states", state_key(self.behaviour_id, state.box.name)
        arrow = self.arrow_at(position)
        return ("transitions", transition_key(self.behaviour_id, arrow.arrow.place)) if arrow else None

    # Mouse

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Start a gesture: move states, draw a transition, select a rectangle, or pan."""
        self._end_renaming()
        if self.behaviour is None or self.gesture is not None:
            return
        place = self.mapToScene(event.position().toPoint())
        self.gesture = diagram_drags.gesture_at_press(self, event, place)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Continue the current gesture; without one, highlight the item under the mouse."""
        place = self.mapToScene(event.position().toPoint())
        if self.gesture is not None:
            self.gesture.move(event, place)
            return
        over, arrow = self.state_at(place), self.arrow_at(place)
        for item in self.states.values():
            item.ready = item is over and item.on_rim(place)
        for each in self.arrows:
            each.hovered = over is None and each is arrow
        ready = over is not None and over.ready
        shape = Qt.CursorShape.CrossCursor if ready else Qt.CursorShape.ArrowCursor
        self.viewport().setCursor(shape)
        self.viewport().setToolTip("Drag to another state to make a transition" if ready else "")
        self.viewport().update()

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """Finish the current gesture."""
        gesture, self.gesture = self.gesture, None
        if gesture is not None:
            gesture.release(event, self.mapToScene(event.position().toPoint()))
        self.viewport().update()

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        """Rename the state under the mouse, or add a state on the empty background."""
        if event.button() is not Qt.MouseButton.LeftButton or self.behaviour is None:
            return
        place = self.mapToScene(event.position().toPoint())
        state = self.state_at(place)
        if state is not None:
            self.rename(state.box.name)
        elif self.arrow_at(place) is None and (name := self.add_state(place)):
            self.rename(name)

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Zoom about the mouse; with Shift or a sideways wheel, pan."""
        turned = event.angleDelta()
        if turned.x() or event.modifiers() & Qt.KeyboardModifier.ShiftModifier:
            self.pan(QPoint((turned.x() or turned.y()) // 2, 0))
            return
        factor = (
            min(max(ZOOM_PER_STEP ** turned.y() * self.transform().m11(), MIN_ZOOM), MAX_ZOOM) / self.transform().m11()
        )
        mouse = event.position().toPoint()
        before = self.mapToScene(mouse)
        self.scale(factor, factor)
        moved = self.mapFromScene(before) - mouse
        self.pan(-moved)

    def pan(self, pixels: QPoint) -> None:
        """Scroll the view by ``pixels``."""
        self._whole = False
        for bar, way in ((self.horizontalScrollBar(), pixels.x()), (self.verticalScrollBar(), pixels.y())):
            bar.setValue(bar.value() - way)

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Fit the diagram again if all of it was in view."""
        super().resizeEvent(event)
        if self._whole:
            self.fit()

    def leave_gesture(self) -> bool:
        """Cancel the current gesture; True if there was one."""
        gesture, self.gesture = self.gesture, None
        if gesture is not None:
            gesture.cancel()
            self.viewport().update()
        return gesture is not None

    def contextMenuEvent(self, event: QContextMenuEvent) -> None:
        """Show a menu of the actions on the item under the mouse."""
        if self.behaviour is None:
            return
        place = self.mapToScene(event.pos())
        item = self.item_at(place)
        if item is not None and item not in self.document.selection:
            self.select(item)
        menu = QMenu(self)
        for text, run in self._choices(place):
            menu.addAction(escaped_mnemonics(text)).triggered.connect(lambda _=False, run=run: run())
        menu.exec(event.globalPos())

    def _choices(self, position: QPointF) -> list[tuple[str, Callable[[], object]]]:
        state, arrow = self.state_at(position), self.arrow_at(position)
        if state is not None:
            name = state.box.name
            begin = lambda: self.edit(lambda old: replace(old, start=name), f"Set {name} as start state")  # noqa: E731
            gone = lambda: self.edit(lambda old: edits.without_states(old, {name}), f"Delete {name}")  # noqa: E731
            return [("Set as start state", begin), ("Rename", lambda: self.rename(name)), ("Delete", gone)]
        if arrow is not None:
            number, target = arrow.arrow.place, self.document.project.behaviours[self.behaviour_id]
            text = f"Delete transition to {target.transitions[number].target}"
            return [("Delete", lambda: self.edit(lambda old: edits.without_transitions(old, {number}), text))]
        return [("Add state here", lambda: self.add_state(position)), ("Show all", self.fit)]

    def event(self, event: QEvent) -> bool:
        """Reserve Esc for cancelling a drag, so that no shortcut of the window takes it."""
        mine = isinstance(event, QKeyEvent) and self.gesture is not None and event.key() == Qt.Key.Key_Escape
        if mine and event.type() == QEvent.Type.ShortcutOverride:
            event.accept()
            return True
        return bool(super().event(event))

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Cancel a gesture with Esc, rename a state with F2, and leave all other keys to the window."""
        chosen = [item for item in self.states.values() if item.box.selected]
        if event.key() == Qt.Key.Key_Escape and self.leave_gesture():
            return
        if event.key() == Qt.Key.Key_F2 and len(chosen) == 1:
            self.rename(chosen[0].box.name)
            return
        event.ignore()

    # Drawing

    def drawBackground(self, painter: QPainter, area: QRectF | object) -> None:
        """Draw a grid of dots, unless the view is zoomed out below half size."""
        super().drawBackground(painter, area)  # type: ignore[arg-type]
        if self.transform().m11() < 0.5:
            return
        seen = self.mapToScene(self.viewport().rect()).boundingRect()
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(QPen(QColor(colours.CONTROL), 1.8))
        across = range(int(seen.left() // DIAGRAM_GRID), int(seen.right() // DIAGRAM_GRID) + 1)
        for row in range(int(seen.top() // DIAGRAM_GRID), int(seen.bottom() // DIAGRAM_GRID) + 1):
            painter.drawPoints([QPointF(column * DIAGRAM_GRID, row * DIAGRAM_GRID) for column in across])

    def drawForeground(self, painter: QPainter, area: QRectF | object) -> None:
        """Draw the preview of the current gesture."""
        if self.gesture is not None:
            self.gesture.paint(painter)

    def _box(self, behaviour: Behaviour, state: State) -> StateBox:
        project = self.document.project
        active = self.document.active_performer_id
        inside = [role.performer_id for role in behaviour.cast if self.running.get(role.performer_id) == state.name]
        own = active if active in inside else None
        return StateBox(
            state.name,
            clip_words(state, project),
            tuple(manner_words(each, project) for each in state.manners),
            state.place,
            state.name == behaviour.start,
            ("states", state_key(self.behaviour_id, state.name)) in self.document.selection,
            colour_of(project, own) if own else "",
            tuple(colour_of(project, key) for key in inside if key != own),
        )

    def _arrows(self, behaviour: Behaviour) -> list[Arrow]:
        ways = [(each.source, each.target) for each in behaviour.transitions]
        arrows = []
        for index, each in enumerate(behaviour.transitions):
            order, count = edits.transition_rank(behaviour, index)
            words = [condition_words(one, self.document.project) for one in each.conditions]
            words[0] = f"{order}  {words[0]}" if count > 1 else words[0]
            returns = each.source != each.target and (each.target, each.source) in ways
            bow = bow_of(ways[:index].count(ways[index]), returns)
            arrows.append(
                Arrow(
                    index, self.states[each.source].rect, self.states[each.target].rect, tuple(words), bow,
                    ("transitions", transition_key(self.behaviour_id, index)) in self.document.selection,
                )
            )  # fmt: skip
        return arrows

    def _free_place(self) -> QPointF:
        """Centre of the view, moved down until a new box there covers no other item."""
        taken = [item.rect for item in self.states.values()]
        taken += [area for arrow in self.arrows for area in (arrow.boundingRect(), arrow.label)]
        place = self.mapToScene(self.viewport().rect().center())
        new = StateBox("State", "holds its pose", (), (0.0, 0.0)).rect.adjusted(
            -DIAGRAM_GRID, -DIAGRAM_MARGIN, DIAGRAM_GRID, DIAGRAM_MARGIN
        )
        while any(new.translated(place).intersects(each) for each in taken):
            place += QPointF(0.0, DIAGRAM_GRID)
        return place


def colour_of(project: Project, performer_id: str) -> str:
    """Colour of the character of a performer."""
    return project.characters[project.performers[performer_id].character_id].colour
