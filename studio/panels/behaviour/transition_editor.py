"""Form of a transition: source and target state, conditions, and blend time."""

from collections.abc import Callable
from dataclasses import replace

from PySide6.QtWidgets import QVBoxLayout, QWidget

from studio.core.changed_records import with_fields
from studio.core.stage import behaviour_edits as edits
from studio.core.stage.behaviour import LONGEST_BLEND_SECONDS, Transition
from studio.core.stage.conditions import ClipEndCondition, Condition
from studio.document.behaviour_commands import place_of, transition_key
from studio.document.document import Document
from studio.engine.live_interface import Live
from studio.panels.behaviour.condition_section import ConditionSection, PutCondition
from studio.panels.behaviour.part_editor import PartEditor
from studio.panels.fields import FIELD_ICON_PX, Choice, NumberField, Section, press_button, styled_label


class TransitionEditor(PartEditor[Transition]):
    """Form of a transition. The first transition of a state whose conditions are all true is taken."""

    def __init__(self, document: Document, live: Live, collection: str, entity_id: str) -> None:
        super().__init__(document, live, collection, entity_id)
        section = Section("Transition")
        self._source, self._target = Choice("From", ()), Choice("To", ())
        self._source.value_chosen.connect(lambda name: self._set("Set source state", source=name))
        self._target.value_chosen.connect(lambda name: self._set("Set target state", target=name))
        section.add_row("From", self._source)
        section.add_row("To", self._target)
        self._blend = self.bind(
            NumberField("Blend", "s", 0.0, LONGEST_BLEND_SECONDS, 0.05),
            lambda seconds: self._set("Set blend", blend=seconds),
        )
        self._blend.setSpecialValueText("automatic")
        section.add_row("Blend", self._blend)
        self._order = styled_label("", "value")
        self._earlier = press_button("Move up", self._try_earlier)
        self._earlier.setToolTip("If several transitions apply, the first in this order is taken.")
        section.add_row("Order", self._order, self._earlier)
        self.column.addWidget(section)
        self._kinds: tuple[type, ...] = ()
        self._conditions: list[ConditionSection] = []
        self._box = QVBoxLayout()
        self.column.addLayout(self._box)
        below = QWidget()
        row = QVBoxLayout(below)
        row.setContentsMargins(FIELD_ICON_PX, 12, FIELD_ICON_PX, 0)
        row.addWidget(press_button("Add condition", self._add))
        row.addWidget(styled_label("All conditions must be true in the same frame.", "hint"))
        self.column.addWidget(below)
        self.finish()

    @property
    def place(self) -> int:
        """Index of the transition in its behaviour."""
        return place_of(self.entity_id)

    def refresh(self) -> None:
        """Update all fields from the document."""
        transition: Transition | None = self.entity
        if transition is None:
            return
        names = [(each.name, each.name) for each in self.behaviour.states]
        for choice, name in ((self._source, transition.source), (self._target, transition.target)):
            choice.offer(names)
            choice.show_value(name)
        self._blend.show_value(transition.blend)
        order, count = edits.transition_rank(self.behaviour, self.place)
        self._order.setText(f"{order} of {count}")
        self._earlier.setEnabled(order > 1)
        kinds = tuple(type(each) for each in transition.conditions)
        if kinds != self._kinds:
            self._make_sections(transition.conditions)
            self._kinds = kinds
        for section, condition in zip(self._conditions, transition.conditions, strict=True):
            section.show_condition(condition, self.document.project)

    def _make_sections(self, conditions: tuple[Condition, ...]) -> None:
        for old in self._conditions:
            self._box.removeWidget(old)
            old.hide()
            old.deleteLater()
        self._conditions = [
            ConditionSection(self, "And" if index else "Condition", each, self._putter(index))
            for index, each in enumerate(conditions)
        ]
        for section in self._conditions:
            self._box.addWidget(section)

    def _putter(self, index: int) -> PutCondition:
        def put(make: Callable[[], Condition] | None, text: str) -> None:
            conditions = list(self.entity.conditions)
            if make is None:
                del conditions[index]
                self._set(text, conditions=tuple(conditions))
            else:
                self._set_by(text, lambda: (*conditions[:index], make(), *conditions[index + 1 :]))

        return put

    def _add(self) -> None:
        self._set("Add condition", conditions=(*self.entity.conditions, ClipEndCondition()))

    def _try_earlier(self) -> None:
        new, place = edits.with_transition_moved_up(self.behaviour, self.place)
        performers = [item for item in self.document.selection.items if item[0] == "performers"]
        behaviour_id = self.behaviour_id
        if self.edit(lambda _: new, "Move transition up"):
            self.document.selection.set(*performers, ("transitions", transition_key(behaviour_id, place)))

    def _set_by(self, text: str, make: Callable[[], tuple[Condition, ...]]) -> None:
        transition, place = self.entity, self.place
        self.edit(lambda old: edits.with_transition_replaced(old, place, replace(transition, conditions=make())), text)

    def _set(self, text: str, **values: object) -> None:
        transition, place = self.entity, self.place
        self.edit(lambda old: edits.with_transition_replaced(old, place, with_fields(transition, **values)), text)
