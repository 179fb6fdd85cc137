"""Form of a contact: the body point on the ground or the touching hands, and the frame range."""

from studio.core.captures.contacts import CONTACT_POINTS, ContactInterval, ContactPoint, Touch
from studio.core.constraints.scope import Scope
from studio.document.contact_owners import move_contact_to_scope
from studio.document.document import Document
from studio.engine.live_interface import Live
from studio.panels.editor import Editor
from studio.panels.fields import Choice, NumberField, Section, styled_label
from studio.panels.scope_row import ScopeRow


def contact_words(point: ContactPoint | Touch) -> str:
    """Name of a contact point as label, for example ``Left heel``."""
    return point.words.capitalize()


ON_BODY_SENTENCE = "The {what} keeps the actor's contact point on the surface"
KEPT_SENTENCES = {
    "together": "The distance between the hands is the actor's, scaled by arm length",
    "thing": "The size of the object between the hands is kept",
    **dict.fromkeys(("head", "trunk", "hips", "thigh"), ON_BODY_SENTENCE),
}
"""Sentence about the kept property of a contact of the hands, by the kind of contact."""


class ContactEditor(Editor[ContactInterval]):
    """Form of a contact: point, scope, first and last frame."""

    def __init__(self, document: Document, live: Live, collection: str, entity_id: str) -> None:
        super().__init__(document, live, collection, entity_id)
        section = Section("Contact")
        self._point = Choice("Point", [(point, contact_words(point)) for point in CONTACT_POINTS])
        self._point.value_chosen.connect(
            lambda point: self.change(f"Move contact to {contact_words(point)}", point=point)
        )
        section.add_row("Point", self._point)
        self._first = self.bind(NumberField("First frame", "", 0, 1e6, 1, 0), self._set_first)
        self._last = self.bind(NumberField("Last frame", "", 0, 1e6, 1, 0), self._set_last)
        section.add_row("Frame range", self._first, self._last)
        self._scope = ScopeRow(self, section, self._ask)
        self._words = styled_label("", "hint")
        section.add_wide(self._words)
        self.column.addWidget(section)
        self.finish()

    def refresh(self) -> None:
        """Update the contact."""
        contact = self.entity
        if contact is None:
            return
        self._point.show_value(contact.point)
        self._scope.refresh()
        self._first.show_value(contact.first)
        self._last.show_value(contact.last)
        seconds = (contact.last - contact.first + 1) / self.document.playhead.frame_rate
        what = contact_words(contact.point).lower()
        kept = KEPT_SENTENCES.get(contact.point.member, "The {what} is planted on the ground").format(what=what)
        self._words.setText(f"{kept} for {seconds:.2f} s{self._whose(contact)}.")

    def _whose(self, contact: ContactInterval) -> str:
        return "" if contact.scope.is_narrow else ", on every character"

    def depends_on(self, collection: str, entity_id: str) -> bool:
        """True for contacts, and for performers, which the scope names."""
        return super().depends_on(collection, entity_id) or collection == "performers"

    def _ask(self, scope: Scope) -> None:
        text = f"Set 'Applies to' of {contact_words(self.entity.point).lower()} contacts"
        contact_id = move_contact_to_scope(self.document, self.entity_id, scope, text)
        self.document.selection.set(("contacts", contact_id))

    def _set_first(self, frame: float) -> None:
        text = f"Trim {contact_words(self.entity.point).lower()} contact"
        self.change(text, first=min(round(frame), self.entity.last))

    def _set_last(self, frame: float) -> None:
        text = f"Trim {contact_words(self.entity.point).lower()} contact"
        self.change(text, last=max(round(frame), self.entity.first))
