"""Content of the inspector if nothing is selected: hints on first steps."""

from studio.document.document import Document
from studio.engine.live_interface import Live
from studio.panels.editor import Editor
from studio.panels.fields import Section, styled_label

FIRST_HINTS = (
    "Select a character to change its body.",
    "Click a joint in the 3D view and press C to give it a target.",
    "Select a bar on the timeline to set when it is active.",
    "Drop a capture anywhere to adapt it to these characters.",
)


class StageEditor(Editor[None]):
    """Form with hints on first steps."""

    def __init__(self, document: Document, live: Live) -> None:
        super().__init__(document, live, "", "")
        section = Section("Nothing selected")
        for step in FIRST_HINTS:
            section.add_wide(styled_label(step, "hint"))
        self.column.addWidget(section)
        self.column.addStretch(1)

    def depends_on(self, collection: str, entity_id: str) -> bool:
        """Always False, since the hints never change."""
        return False
