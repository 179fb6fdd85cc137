"""Form of a behaviour: its name, its start state, and the performers that use it."""

from PySide6.QtWidgets import QListWidget

from studio.core.errors import StudioError
from studio.core.stage.behaviour import Behaviour
from studio.document.behaviour_commands import detach_behaviour, state_key
from studio.document.document import Document
from studio.document.mnemonics import escaped_mnemonics
from studio.engine.live_interface import Live
from studio.panels.editor import Editor, EntityNameField
from studio.panels.fields import FORM_ROW_HEIGHT_PX, Choice, Section, press_button, styled_label


class BehaviourEditor(Editor[Behaviour]):
    """Form of a whole behaviour; its states are listed as well, for use by keyboard."""

    def __init__(self, document: Document, live: Live, collection: str, entity_id: str) -> None:
        super().__init__(document, live, collection, entity_id)
        section = Section("Behaviour")
        self._name = EntityNameField(self)
        section.add_row("Name", self._name)
        self._start = Choice("Start state", ())
        self._start.value_chosen.connect(lambda name: self.change(f"Set {name} as start state", start=name))
        section.add_row("Start state", self._start)
        self._players = styled_label("", "value")
        self._players.setWordWrap(True)
        section.add_row("Used by", self._players)
        self._own = press_button("", self._make_own)
        self._own.setToolTip("Shared: edits affect every character that uses it. Make it unique to edit it separately.")
        section.add_wide(self._own)
        section.add_wide(press_button("Delete behaviour", self._delete))
        self.column.addWidget(section)
        states = Section("States")
        self._states = QListWidget()
        self._states.setAccessibleName("States")
        self._states.itemActivated.connect(lambda item: self._select(item.text()))
        self._states.itemClicked.connect(lambda item: self._select(item.text()))
        states.add_wide(self._states)
        self.column.addWidget(states)
        self.finish()

    def depends_on(self, collection: str, entity_id: str) -> bool:
        """True for the behaviour itself, and for performers, whose names the form shows."""
        return super().depends_on(collection, entity_id) or collection == "performers"

    def refresh(self) -> None:
        """Update all fields from the document."""
        behaviour: Behaviour | None = self.entity
        if behaviour is None:
            return
        self._name.show_name()
        names = [each.name for each in behaviour.states]
        self._start.offer([(name, name) for name in names])
        self._start.show_value(behaviour.start)
        called = {key: each.name for key, each in self.document.project.performers.items()}
        roles = [
            called[role.performer_id] + (f" against {called[role.partner_id]}" if role.partner_id else "")
            for role in behaviour.cast
        ]
        self._players.setText("\n".join(roles) or "no character yet")
        active = self.document.active_performer_id or ""
        self._own.setVisible(len(behaviour.cast) > 1 and behaviour.role_of(active) is not None)
        self._own.setText(escaped_mnemonics(f"Make unique for {called[active]}") if active else "")
        if names != [self._states.item(row).text() for row in range(self._states.count())]:
            self._states.clear()
            self._states.addItems(names)
            self._states.setFixedHeight(FORM_ROW_HEIGHT_PX * len(names) + 4)

    def _make_own(self) -> None:
        performer_id = self.document.active_performer_id or ""
        made = detach_behaviour(self.document, performer_id, self.entity_id)
        self.document.selection.set(("performers", performer_id), ("behaviours", made))

    def _delete(self) -> None:
        try:
            self.document.remove("behaviours", self.entity_id, f"Delete {self.entity.name}")
        except StudioError as error:
            self.document.problem_reported.emit(str(error))

    def _select(self, name: str) -> None:
        performers = [item for item in self.document.selection.items if item[0] == "performers"]
        self.document.selection.set(*performers, ("states", state_key(self.entity_id, name)))
