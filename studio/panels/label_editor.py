"""Form of a label, the name of a frame or frame range of a motion."""

from studio.core.captures.annotations import Label
from studio.document.document import Document
from studio.engine.live_interface import Live
from studio.panels.editor import Editor, EntityNameField
from studio.panels.fields import NumberField, Section


class LabelEditor(Editor[Label]):
    """Form of a label: name, first and last frame."""

    def __init__(self, document: Document, live: Live, collection: str, entity_id: str) -> None:
        super().__init__(document, live, collection, entity_id)
        section = Section("Label")
        self._name = EntityNameField(self, "label ")
        section.add_row("Name", self._name)
        self._first = self.bind(NumberField("First frame", "", 0, 1e6, 1, 0), self._set_first)
        self._last = self.bind(NumberField("Last frame", "", 0, 1e6, 1, 0), self._set_last)
        section.add_row("Frame range", self._first, self._last)
        self.column.addWidget(section)
        self.finish()

    def refresh(self) -> None:
        """Update the label."""
        if self.entity is not None:
            self._name.show_name()
            self._first.show_value(self.entity.first)
            self._last.show_value(self.entity.last)

    def _set_first(self, frame: float) -> None:
        self.change(f"Trim label {self.entity.name}", first=min(round(frame), self.entity.last))

    def _set_last(self, frame: float) -> None:
        self.change(f"Trim label {self.entity.name}", last=max(round(frame), self.entity.first))
