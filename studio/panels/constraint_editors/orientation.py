"""The form of an orientation constraint: how the segment is to be turned, as three angles."""

from functools import partial

import numpy as np

from studio.core.rotations import angle_between, from_euler, to_euler
from studio.panels.constraint_editors.common import ConstraintEditor
from studio.panels.constraint_editors.target_rows import TargetRows
from studio.panels.fields import NumberField, Section

EULER_ORDER = "ZYX"
"""Turned about the world's X first, then its Y, then its Z: so Z is always the heading."""
SAME = 1e-3
"""Radians: the fields are rounded, and angles that mean the same turn stay as they were typed."""


class OrientationEditor(ConstraintEditor):
    """Degrees about the X, Y and Z axes of the motion's space."""

    def add_kind_rows(self, section: Section) -> None:
        """What the target is, and the three angles that it has now."""
        self._source = TargetRows(self, section, "target", turns=True)
        self._angles = [
            self.bind(NumberField(f"Turn {axis}", "", -360.0, 360.0, 1.0, 2), partial(self._set_angle, k))
            for k, axis in enumerate("XYZ")
        ]
        section.add_row("Turn  °", *self._angles)

    def refresh_moment(self) -> None:
        """Fetch what depends on the playhead."""
        self._source.refresh()
        now = self._source.now()
        if now is not None and angle_between(self._quaternion(self._shown()), np.array(now)) > SAME:
            for field, angle in zip(self._angles, np.degrees(to_euler(EULER_ORDER, np.array(now)))[::-1], strict=True):
                field.show_value(float(angle))

    def _shown(self) -> list[float]:
        return [field.value() for field in self._angles]

    @staticmethod
    def _quaternion(degrees: list[float]) -> np.ndarray:
        return from_euler(EULER_ORDER, np.radians(degrees[::-1]))

    def _set_angle(self, axis: int, degrees: float) -> None:
        angles = self._shown()
        angles[axis] = degrees
        target = tuple(self._quaternion(angles).tolist())
        self._source.put(target, f"Turn target of {self.entity.name}")
