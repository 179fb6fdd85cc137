"""Form of reference footage: name, start and frame rate."""

from studio.core.stage.footage import FOOTAGE_RATES, Footage
from studio.document.document import Document
from studio.engine.live_interface import Live
from studio.panels.editor import Editor, EntityNameField
from studio.panels.fields import NumberField, Section, styled_label


class FootageEditor(Editor[Footage]):
    """Form of reference footage: name, start, frame rate, and facts of the file."""

    def __init__(self, document: Document, live: Live, collection: str, entity_id: str) -> None:
        super().__init__(document, live, collection, entity_id)
        section = Section("Footage")
        self._name = EntityNameField(self)
        section.add_row("Name", self._name)
        begin = NumberField("Start", "s", -1e5, 1e5, 0.01, 3)
        self._start = self.bind(begin, lambda value: self.change(f"Move {self.entity.name}", start=value))
        section.add_row("Start", self._start)
        rate = NumberField("Frame rate", "fps", *FOOTAGE_RATES, 1.0, 3)
        self._rate = self.bind(
            rate, lambda value: self.change(f"Set frame rate of {self.entity.name}", frame_rate=value)
        )
        section.add_row("Frame rate", self._rate)
        self._found = styled_label("", "hint")
        section.add_wide(self._found)
        self.column.addWidget(section)
        self.finish()

    def refresh(self) -> None:
        """Show the current values."""
        footage = self.entity
        self._name.show_name()
        self._start.show_value(footage.start)
        self._rate.show_value(footage.frame_rate)
        self._found.setText(f"{footage.frames} frames at {footage.file_rate:g} fps in {footage.source}")
