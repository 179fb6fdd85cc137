"""The form of a prop: where the box stands, how large it is."""

import math
from typing import Any

from studio.document.document import Document
from studio.engine.live import Live
from studio.panels.constraint_editors.vector_row import VectorRow
from studio.panels.editor import Editor
from studio.panels.fields import NumberField, Section

LEAST = 0.001


class PropEditor(Editor):
    """Place on the stage, edges, heading."""

    def __init__(self, document: Document, live: Live, collection: str, entity_id: str) -> None:
        super().__init__(document, live, collection, entity_id)
        section = Section("Prop")
        self._position = VectorRow(self, section, "Centre", lambda place: self._set("Move", position=place))
        self._size = VectorRow(self, section, "Size", lambda size: self._set("Resize", size=size))
        self._size.set_least(LEAST)
        self._heading = self.bind(NumberField("Heading", "°", -360.0, 360.0, 1.0, 1), self._set_heading)
        section.add_row("Heading", self._heading)
        self.column.addWidget(section)
        self.finish()

    def refresh(self) -> None:
        """Fetch everything."""
        prop = self.entity
        if prop is not None:
            self._position.show_values(prop.position)
            self._size.show_values(prop.size)
            self._heading.show_value(math.degrees(prop.heading))

    def _set(self, verb: str, **values: Any) -> None:
        self.change(f"{verb} {self.entity.name}", **values)

    def _set_heading(self, degrees: float) -> None:
        self._set("Turn", heading=math.radians(degrees))
