"""Form of a rail constraint: line or plane, its centre, direction and length."""

from studio.core.constraints.rail import RailConstraint, RailShape
from studio.panels.constraint_editors.common import ConstraintEditor
from studio.panels.constraint_editors.target_rows import TargetRows
from studio.panels.constraint_editors.vector_row import VECTOR_LIMIT, VectorRow
from studio.panels.fields import NumberField, Section, Segments


class RailEditor(ConstraintEditor[RailConstraint]):
    """Form of a rail constraint; a plane has a normal instead of direction and length."""

    def add_kind_rows(self, section: Section) -> None:
        """Add the rows of shape, centre, direction and length."""
        self._shape = Segments("Slide along", [(RailShape.LINE, "Line"), (RailShape.PLANE, "Plane")])
        self._shape.value_chosen.connect(lambda shape: self._set("Set shape of", shape=shape))
        section.add_row("Slide along", self._shape)
        self._source = TargetRows(self, section, "centre")
        self._centre = VectorRow(
            self, section, "Centre", lambda place: self._source.set_numbers(place, f"Move {self.entity.name}")
        )
        self._direction = VectorRow(self, section, "Direction", self._set_direction, unit="")
        self._length = self.bind(NumberField("Length", "m", 0.001, VECTOR_LIMIT, 0.05, 3), self._set_length)
        self._length_caption = section.add_row("Length", self._length)

    def refresh(self) -> None:
        """Update all fields from the document."""
        super().refresh()
        rail = self.entity
        if rail is None:
            return
        self._shape.show_value(rail.shape)
        self._direction.show_values(rail.direction)
        self._length.show_value(rail.length)
        self._direction.caption.setText("Direction" if rail.shape is RailShape.LINE else "Normal")
        for widget in (self._length, self._length_caption):
            widget.setVisible(rail.shape is RailShape.LINE)

    def refresh_moment(self) -> None:
        """Update the rows that depend on the playhead."""
        self._source.refresh()
        now = self._source.current_numbers()
        if now is not None:
            self._centre.show_values(now)

    def _set(self, verb: str, **values: object) -> None:
        self.change(f"{verb} {self.entity.name}", **values)

    def _set_direction(self, direction: tuple[float, ...]) -> None:
        if any(direction):
            self._set("Set direction of", direction=direction)

    def _set_length(self, length: float) -> None:
        self._set("Set length of", length=length)
