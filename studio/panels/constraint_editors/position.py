"""The form of a position constraint: where the point is to be."""

from studio.panels.constraint_editors.common import ConstraintEditor
from studio.panels.constraint_editors.vector_row import VectorRow
from studio.panels.fields import Section


class PositionEditor(ConstraintEditor):
    """Three numbers in metres."""

    def add_kind_rows(self, section: Section) -> None:
        """The target."""
        self._target = VectorRow(self, section, "Target", self._set_target)

    def refresh(self) -> None:
        """Fetch everything."""
        super().refresh()
        if self.entity is not None:
            self._target.show_values(self.entity.target)

    def _set_target(self, target: tuple[float, ...]) -> None:
        self.change(f"Move target of {self.entity.name}", target=target)
