"""Behaviour panel: the performer's behaviour, its partner, and the diagram."""

from collections.abc import Sequence

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QHBoxLayout, QLabel, QStackedLayout, QVBoxLayout, QWidget

from studio.core.errors import StudioError
from studio.document.behaviour_commands import set_cast, shown_behaviour
from studio.document.document import Document
from studio.panels.behaviour.diagram import Diagram
from studio.panels.fields import Choice, press_button, styled_label

NO_CHARACTER_HINT = "Select a character to edit its behaviour for live play."
NO_BEHAVIOUR_HINT = (
    "{name} plays its clip track. Start with one of these, or choose a behaviour above: a state machine whose"
    " transitions react to events."
)


class BehaviourPanel(QWidget):
    """Behaviour panel; ``action_requested`` carries the id of a ready-made part to be added."""

    action_requested = Signal(str)

    def __init__(self, document: Document, ready_made: Sequence[tuple[str, str, str]]) -> None:
        """``ready_made``: id, text and tooltip of each ready-made part."""
        super().__init__()
        self.setObjectName("panel")
        self.setAttribute(Qt.WidgetAttribute.WA_StyledBackground)
        self.document = document
        self.diagram = Diagram(document)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(0)
        column.addWidget(self._make_bar())
        self._pages = QStackedLayout()
        self._pages.addWidget(self._make_empty(ready_made))
        self._pages.addWidget(self.diagram)
        column.addLayout(self._pages, 1)
        document.selection.changed.connect(self.refresh)
        document.project_opened.connect(self._project_opened)
        document.entity_changed.connect(self._entity_changed)
        self.refresh()

    def show_running(self, performer_id: str, state: str) -> None:
        """Highlight the current state of a performer during live play; an empty ``state`` removes the highlight."""
        running = self.diagram.running
        if running.get(performer_id, "") != state:
            running.pop(performer_id, None)
            if state:
                running[performer_id] = state
            self.diagram.refresh()

    def refresh(self) -> None:
        """Show the behaviour of the selection or of the active performer, and who uses it."""
        project, performer_id = self.document.project, self.document.active_performer_id
        behaviour_id = shown_behaviour(self.document) or ""
        performer = project.performers.get(performer_id or "")
        behaviour = project.behaviours.get(behaviour_id)
        role = behaviour.role_of(performer_id or "") if behaviour else None
        self._name.setText(performer.name if performer else "None")
        self._name.setVisible(performer is not None)
        choices = [("", "No behaviour"), *((key, each.name) for key, each in project.behaviours.items())]
        self._choice.offer(choices)
        self._choice.show_value(behaviour_id)
        self._choice.setVisible(performer is not None)
        others = [("", "nobody"), *((k, each.name) for k, each in project.performers.items() if k != performer_id)]
        self._partner.offer(others)
        self._partner.show_value(role.partner_id if role else "")
        for widget in (self._against, self._partner):
            widget.setVisible(role is not None)
        for button in self._tools:
            button.setVisible(behaviour is not None)
        self._words.setText(NO_BEHAVIOUR_HINT.format(name=performer.name) if performer else NO_CHARACTER_HINT)
        self._ready.setVisible(performer is not None)
        self._pages.setCurrentIndex(1 if behaviour else 0)
        self.diagram.show_behaviour(behaviour_id)

    def _make_bar(self) -> QWidget:
        bar = QWidget()
        row = QHBoxLayout(bar)
        row.setContentsMargins(12, 4, 12, 4)
        row.setSpacing(8)
        self._name: QLabel = styled_label("", "title")
        self._choice, self._partner = Choice("Behaviour", ()), Choice("Partner", ())
        self._choice.setToolTip("What it does during live play. Several characters can share one behaviour.")
        self._partner.setToolTip("Character it reacts to: it keeps its distance, blocks and strikes.")
        self._against = styled_label("against", "second")
        for choice in (self._choice, self._partner):
            choice.setMinimumContentsLength(14)
        self._choice.value_chosen.connect(lambda key: self._let_play(str(key), str(self._partner.value or "")))
        self._partner.value_chosen.connect(lambda key: self._let_play(self.diagram.behaviour_id, str(key)))
        self._tools = [
            press_button("Add state", lambda: self.diagram.rename(self.diagram.add_state())),
            press_button("Show all", self.diagram.fit),
        ]
        self._tools[0].setToolTip("Or double-click the diagram. Drag from the edge of a state to make a transition.")
        self._tools[1].setToolTip("Wheel zooms; middle mouse button or Alt+drag pans.")
        for widget in (self._name, self._choice, self._against, self._partner):
            row.addWidget(widget)
        row.addStretch(1)
        for button in self._tools:
            row.addWidget(button)
        return bar

    def _make_empty(self, ready_made: Sequence[tuple[str, str, str]]) -> QWidget:
        page = QWidget()
        column = QVBoxLayout(page)
        column.setContentsMargins(24, 12, 24, 12)
        column.setSpacing(12)
        self._words = styled_label(NO_CHARACTER_HINT, "hint")
        self._words.setAlignment(Qt.AlignmentFlag.AlignCenter)
        self._ready = QWidget()
        row = QHBoxLayout(self._ready)
        row.setContentsMargins(0, 0, 0, 0)
        row.addStretch(1)
        for key, text, tip in ready_made:
            button = press_button(text, lambda key=key: self.action_requested.emit(key))  # type: ignore[misc]
            button.setToolTip(tip)
            row.addWidget(button)
        row.addStretch(1)
        column.addStretch(1)
        column.addWidget(self._words)
        column.addWidget(self._ready)
        column.addStretch(1)
        return page

    def _let_play(self, behaviour_id: str, partner_id: str) -> None:
        performer_id = self.document.active_performer_id
        if performer_id is None:
            return
        try:
            set_cast(self.document, performer_id, behaviour_id or None, partner_id)
        except StudioError as error:
            self.document.problem_reported.emit(str(error))
        self.document.selection.set(("performers", performer_id))
        self.refresh()

    def _project_opened(self) -> None:
        self.diagram.running.clear()
        self.diagram.leave_gesture()
        self.refresh()

    def _entity_changed(self, collection: str, _: str) -> None:
        if collection in ("behaviours", "performers", "characters", "motions", "props"):
            self.refresh()
