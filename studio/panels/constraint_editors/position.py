"""Form of a position constraint: the target of the point."""

from studio.core.constraints.look_at import LookAtConstraint
from studio.core.constraints.position import PositionConstraint
from studio.panels.constraint_editors.common import ConstraintEditor
from studio.panels.constraint_editors.target_rows import TargetRows
from studio.panels.constraint_editors.vector_row import VectorRow
from studio.panels.fields import Section


class PositionEditor(ConstraintEditor[PositionConstraint | LookAtConstraint]):
    """Form of a position constraint: its target, and the target's current position in metres."""

    def add_kind_rows(self, section: Section) -> None:
        """Add the rows of the target."""
        self._source = TargetRows(self, section, "target")
        self._target = VectorRow(self, section, "Target", self._set_target)

    def refresh_moment(self) -> None:
        """Update the rows that depend on the playhead."""
        self._source.refresh()
        now = self._source.current_numbers()
        if now is not None:
            self._target.show_values(now)

    def _set_target(self, target: tuple[float, ...]) -> None:
        self._source.set_numbers(target, f"Move target of {self.entity.name}")
