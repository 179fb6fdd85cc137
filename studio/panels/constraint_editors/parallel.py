"""Form of a parallel constraint: the other segment, both axes, and the maximum angle between them."""

from PySide6.QtWidgets import QPushButton

from studio.core.body.canonical import BodyPart
from studio.core.constraints.base import BodyPoint
from studio.core.constraints.parallel import ParallelConstraint
from studio.panels.constraint_editors.common import ConstraintEditor
from studio.panels.constraint_editors.cone_row import ConeRow
from studio.panels.constraint_editors.present import current_rotation
from studio.panels.constraint_editors.vector_row import VectorRow
from studio.panels.fields import Choice, Section, styled_label


class ParallelEditor(ConstraintEditor[ParallelConstraint]):
    """Form of a parallel constraint: other segment, an axis of each, and maximum angle in degrees."""

    def add_kind_rows(self, section: Section) -> None:
        """Add the rows, and a button that takes the other axis from the pose at the playhead."""
        self._other = Choice("Parallel to", [(part, part.label.capitalize()) for part in BodyPart])
        self._other.value_chosen.connect(self._set_other)
        section.add_row("Parallel to", self._other)
        self._cone = ConeRow(self, section, "Maximum angle between the axes; 0 keeps them parallel")
        self._axis = VectorRow(self, section, "Axis", self._set_axis, unit="")
        self._other_axis = VectorRow(self, section, "Other axis", self._set_other_axis, unit="")
        self._take = QPushButton("Set axis from pose")
        self._take.setToolTip("Set the other axis so that it is parallel at the playhead")
        self._take.clicked.connect(self._take_axis)
        section.add_wide(self._take)
        section.add_wide(styled_label("Axes are local to their segments.", "hint"))

    def refresh(self) -> None:
        """Update all fields from the document."""
        super().refresh()
        if self.entity is not None:
            self._other.show_value(self.entity.other.part)
            self._cone.refresh()
            self._axis.show_values(self.entity.axis)
            self._other_axis.show_values(self.entity.other_axis)

    def _set_other(self, part: BodyPart) -> None:
        self.change(f"Set other segment of {self.entity.name}", other=BodyPoint(part))

    def _set_axis(self, axis: tuple[float, ...]) -> None:
        if any(axis):
            self.change(f"Set axis of {self.entity.name}", axis=axis)

    def _set_other_axis(self, axis: tuple[float, ...]) -> None:
        if any(axis):
            self.change(f"Set other axis of {self.entity.name}", other_axis=axis)

    def _take_axis(self) -> None:
        turn, other = (current_rotation(self, point.part) for point in (self.entity.point, self.entity.other))
        if turn is not None and other is not None:
            axis = tuple((other.T @ turn @ self.entity.axis).tolist())
            self.change(f"Set other axis of {self.entity.name} from pose", other_axis=axis)
