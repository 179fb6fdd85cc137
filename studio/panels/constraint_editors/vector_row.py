"""Form row of the X, Y and Z components of a value."""

from collections.abc import Callable, Sequence
from functools import partial

from PySide6.QtWidgets import QLabel

from studio.panels.editor import Editor
from studio.panels.fields import NumberField, Section, with_unit

VECTOR_LIMIT = 1000.0


class VectorRow:
    """Number fields for X, Y and Z; ``put`` is called with all components when one is edited."""

    def __init__(
        self,
        editor: Editor[object],
        section: Section,
        label: str,
        put: Callable[[tuple[float, ...]], None],
        axes: str = "XYZ",
        unit: str = "m",
    ) -> None:
        self._values: list[float] = [0.0] * len(axes)
        self._put = put
        self.fields = [
            editor.bind(
                NumberField(f"{label} {axis}", unit, -VECTOR_LIMIT, VECTOR_LIMIT, 0.01, 3, suffix=False),
                partial(self._set, k),
            )
            for k, axis in enumerate(axes)
        ]
        self.caption: QLabel = section.add_row(with_unit(label, unit), *self.fields)

    def set_unit(self, label: str, unit: str) -> None:
        """Change the label and the unit of the fields."""
        self.caption.setText(with_unit(label, unit))
        for field in self.fields:
            field.set_unit(unit)

    def show_values(self, values: Sequence[float]) -> None:
        """Show the components."""
        self._values = list(values)
        for field, value in zip(self.fields, values, strict=True):
            field.show_value(value)

    def set_least(self, low: float) -> None:
        """Set the minimum of all fields."""
        for field in self.fields:
            field.set_least(low)

    def set_visible(self, *visible: bool) -> None:
        """Show or hide each field; the row is hidden if no field is shown."""
        for field, shown in zip(self.fields, visible, strict=True):
            field.setVisible(shown)
        self.caption.setVisible(any(visible))

    def _set(self, axis: int, number: float) -> None:
        values = list(self._values)
        values[axis] = number
        self._put(tuple(values))
