"""Form of a distance constraint: the distance, and the other end."""

from studio.core.body.canonical import BodyPart
from studio.core.constraints.base import BodyPoint
from studio.core.constraints.distance import DistanceConstraint
from studio.engine.point_names import point_words
from studio.panels.constraint_editors.common import ConstraintEditor, point_choices
from studio.panels.constraint_editors.present import current_position
from studio.panels.constraint_editors.target_rows import NumberRows, TargetRows
from studio.panels.constraint_editors.vector_row import VECTOR_LIMIT, VectorRow
from studio.panels.fields import Choice, NumberField, Section

FIXED_POSITION_CHOICE = None


class DistanceEditor(ConstraintEditor[DistanceConstraint]):
    """Form of a distance constraint: distance in metres, and the other end as a body point or a fixed position."""

    def add_kind_rows(self, section: Section) -> None:
        """Add the rows of the distance, the other end, and its position if it is fixed."""
        self._distance = self.bind(NumberField("Distance", "m", 0.0, VECTOR_LIMIT, 0.005, 3), self._set_distance)
        self._length = NumberRows(self, section, "distance")
        section.add_row("Distance", self._distance, self._length.keyed)
        self._other = Choice("Distance from", [(FIXED_POSITION_CHOICE, "Fixed position"), *point_choices()])
        self._other.value_chosen.connect(self._set_other)
        section.add_row("From", self._other)
        self._source = TargetRows(self, section, "other")
        self._place = VectorRow(self, section, "Position", self._set_place)

    def refresh_moment(self) -> None:
        """Update the rows that depend on the playhead."""
        other = self.entity.other
        self._length.refresh()
        self._distance.show_value(self._length.current_number)
        self._source.refresh()
        outside = not isinstance(other, BodyPoint)
        self._place.set_visible(*[outside] * 3)
        if isinstance(other, BodyPoint):
            if not self._other.offers((other.part, other.at_end)):
                self._other.add((other.part, other.at_end), point_words(other).capitalize())
            self._other.show_value((other.part, other.at_end))
        else:
            self._other.show_value(FIXED_POSITION_CHOICE)
            now = self._source.current_numbers()
            if now is not None:
                self._place.show_values(now)

    def _set_distance(self, metres: float) -> None:
        self._length.set_number(metres, f"Set distance of {self.entity.name}")

    def _set_place(self, position: tuple[float, ...]) -> None:
        self._source.set_numbers(position, f"Move position of {self.entity.name}")

    def _set_other(self, choice: tuple[BodyPart, bool] | None) -> None:
        """Set the other end; for None, a fixed position where the former one was."""
        other: object = None
        if choice is not None:
            other = BodyPoint(choice[0], at_end=choice[1])
        elif isinstance(self.entity.other, BodyPoint):
            other = current_position(self, self.entity.other) or (0.0, 0.0, 1.0)
        if other is not None:
            self.change(f"Set second point of {self.entity.name}", other=other)
