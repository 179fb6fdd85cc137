"""The ground: how high it lies."""

from studio.document.document import Document
from studio.engine.live import Live
from studio.panels.editor import Editor
from studio.panels.fields import NumberField, Section, labelled


class GroundEditor(Editor):
    """One number that every body follows."""

    def __init__(self, document: Document, live: Live, collection: str, entity_id: str) -> None:
        super().__init__(document, live, collection, entity_id)
        section = Section("Ground")
        self._height = self.bind(
            NumberField("Height", "m", -10.0, 10.0, 0.01, 3),
            lambda metres: self.change("Set height of the ground", height=metres),
        )
        section.add_row("Height", self._height)
        section.add_wide(labelled("Feet in contact stand on it, on every body.", "hint"))
        self.column.addWidget(section)
        self.finish()

    def refresh(self) -> None:
        """Fetch the height."""
        self._height.show_value(self.entity.height)
