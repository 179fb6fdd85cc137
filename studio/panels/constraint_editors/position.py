"""The form of a position constraint: where the point is to be."""

from functools import partial

from studio.panels.constraint_editors.common import ConstraintEditor
from studio.panels.fields import NumberField, Section

FAR = 1000.0


class PositionEditor(ConstraintEditor):
    """Three numbers in metres, to type or to drag."""

    def add_kind_rows(self, section: Section) -> None:
        """The target."""
        self._target = [
            self.bind(
                NumberField(f"Target {axis}", "", -FAR, FAR, 0.01, 3),
                partial(self._set_target, k),
            )
            for k, axis in enumerate("XYZ")
        ]
        section.add_row("Target  m", *self._target)

    def refresh(self) -> None:
        """Fetch everything."""
        super().refresh()
        if self.entity is not None:
            for field, value in zip(self._target, self.entity.target, strict=True):
                field.show_value(value)

    def _set_target(self, axis: int, metres: float) -> None:
        target = list(self.entity.target)
        target[axis] = metres
        self.change(f"Move target of {self.entity.name}", target=tuple(target))
