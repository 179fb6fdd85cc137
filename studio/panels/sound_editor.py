"""Form of a sound track: name and start."""

from studio.core.stage.sound_track import SoundTrack
from studio.document.document import Document
from studio.engine.live_interface import Live
from studio.panels.editor import Editor, EntityNameField
from studio.panels.fields import NumberField, Section, styled_label


class SoundEditor(Editor[SoundTrack]):
    """Form of a sound track: name, start, and facts of the file."""

    def __init__(self, document: Document, live: Live, collection: str, entity_id: str) -> None:
        super().__init__(document, live, collection, entity_id)
        section = Section("Sound")
        self._name = EntityNameField(self)
        section.add_row("Name", self._name)
        field = NumberField("Start", "s", -1e5, 1e5, 0.01, 3)
        self._start = self.bind(field, lambda value: self.change(f"Move {self.entity.name}", start=value))
        section.add_row("Start", self._start)
        self._found = styled_label("", "hint")
        section.add_wide(self._found)
        self.column.addWidget(section)
        self.finish()

    def refresh(self) -> None:
        """Show the current values."""
        sound = self.entity
        self._name.show_name()
        self._start.show_value(sound.start)
        self._found.setText(f"{len(sound.beats)} beats in {sound.end - sound.start:.2f} s of {sound.source}")
