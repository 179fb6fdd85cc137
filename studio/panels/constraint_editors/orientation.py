"""Form of an orientation constraint: the target rotation of the segment, as three angles."""

from studio.core.constraints.orientation import OrientationConstraint
from studio.panels.constraint_editors.common import ConstraintEditor
from studio.panels.constraint_editors.target_rows import TargetRows
from studio.panels.fields import Section
from studio.panels.rotation_row import RotationRow


class OrientationEditor(ConstraintEditor[OrientationConstraint]):
    """Form of an orientation constraint: target rotation as X, Y and Z angles in degrees, clip space."""

    def add_kind_rows(self, section: Section) -> None:
        """Add the rows of the target and of its three current angles."""
        self._source = TargetRows(self, section, "target", turns=True)
        self._angles = RotationRow(
            self,
            section,
            "clip space",
            lambda target: self._source.set_numbers(target, f"Rotate target of {self.entity.name}"),
        )

    def refresh_moment(self) -> None:
        """Update the rows that depend on the playhead."""
        self._source.refresh()
        now = self._source.current_numbers()
        if now is not None:
            self._angles.show_rotation(now)
