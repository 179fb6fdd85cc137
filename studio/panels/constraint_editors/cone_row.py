"""Form row for the maximum angle between an axis and its direction."""

import math

from studio.core.constraints.parallel import ParallelConstraint
from studio.core.constraints.upright import UprightConstraint
from studio.panels.editor import Editor
from studio.panels.fields import NumberField, Section

MAX_CONE_DEGREES = 170.0
CONE_LABEL = "Max. angle"


class ConeRow:
    """Form row for the field ``cone`` of a constraint, in degrees; 0 keeps the axis exactly."""

    def __init__(self, editor: Editor[ParallelConstraint | UprightConstraint], section: Section, tip: str) -> None:
        self._editor = editor
        self._field = editor.bind(NumberField(CONE_LABEL, "°", 0.0, MAX_CONE_DEGREES, 1.0, 1), self._set)
        self._field.setToolTip(tip)
        section.add_row(CONE_LABEL, self._field)

    def refresh(self) -> None:
        """Show the current angle."""
        self._field.show_value(math.degrees(self._editor.entity.cone))

    def _set(self, degrees: float) -> None:
        self._editor.change(f"Set max. angle of {self._editor.entity.name}", cone=math.radians(degrees))
