"""Form of an upright constraint: axis of the segment, direction, and maximum tilt."""

from PySide6.QtWidgets import QPushButton

from studio.core.constraints.upright import UprightConstraint
from studio.panels.constraint_editors.common import ConstraintEditor
from studio.panels.constraint_editors.cone_row import ConeRow
from studio.panels.constraint_editors.present import current_rotation
from studio.panels.constraint_editors.vector_row import VectorRow
from studio.panels.fields import Section, styled_label


class UprightEditor(ConstraintEditor[UprightConstraint]):
    """Form of an upright constraint: maximum tilt in degrees, direction, and axis of the segment."""

    def add_kind_rows(self, section: Section) -> None:
        """Add the rows of maximum tilt, direction and axis, and a button that takes the axis from the pose at the
        playhead.
        """
        self._cone = ConeRow(self, section, "Maximum tilt from the direction; 0 keeps it exact")
        self._direction = VectorRow(self, section, "Direction", self._set_direction, unit="")
        self._axis = VectorRow(self, section, "Axis", self._set_axis, unit="")
        self._take = QPushButton("Set axis from pose")
        self._take.setToolTip("Set the axis to the one that points along the direction at the playhead")
        self._take.clicked.connect(self._take_axis)
        section.add_wide(self._take)
        section.add_wide(styled_label("Direction in clip space, axis local to the segment.", "hint"))

    def refresh(self) -> None:
        """Update all fields from the document."""
        super().refresh()
        if self.entity is not None:
            self._cone.refresh()
            self._direction.show_values(self.entity.direction)
            self._axis.show_values(self.entity.axis)

    def _set_direction(self, direction: tuple[float, ...]) -> None:
        if any(direction):
            self.change(f"Set direction of {self.entity.name}", direction=direction)

    def _set_axis(self, axis: tuple[float, ...]) -> None:
        if any(axis):
            self.change(f"Set axis of {self.entity.name}", axis=axis)

    def _take_axis(self) -> None:
        turn = current_rotation(self, self.entity.point.part)
        if turn is not None:
            axis = tuple((turn.T @ self.entity.direction).tolist())
            self.change(f"Set axis of {self.entity.name} from pose", axis=axis)
