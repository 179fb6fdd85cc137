"""Form row of a rotation as three Euler angles."""

from collections.abc import Callable
from functools import partial

import numpy as np
from numpy.typing import ArrayLike, NDArray

from studio.core.rotations import angle_between, from_euler, to_euler
from studio.panels.editor import Editor
from studio.panels.fields import NumberField, Section

EULER_ORDER = "ZYX"
"""Intrinsic Euler order; equal to rotations about fixed X, then Y, then Z, so that Z is always the heading."""
SAME_ANGLE_RADIANS = 1e-3
"""Angle in radians below which rotations count as equal, so that typed angles are not replaced by rounded ones."""


class RotationRow:
    """Form row of rotation angles in degrees about X, then Y, then Z of ``space``; ``put`` is called with the
    quaternion (x, y, z, w).
    """

    def __init__(
        self,
        editor: Editor[object],
        section: Section,
        space: str,
        put: Callable[[tuple[float, float, float, float]], None],
    ) -> None:
        self._put = put
        self._fields = [
            editor.bind(NumberField(f"Rotation {axis}", "", -360.0, 360.0, 1.0, 2), partial(self._set, index))
            for index, axis in enumerate("XYZ")
        ]
        words = f"Euler angles in degrees about the axes of {space}; rotation order XYZ, X first."
        for field in self._fields:
            field.setToolTip(words)
        section.add_row("Rotation (°)", *self._fields).setToolTip(words)

    def show_rotation(self, rotation: ArrayLike) -> None:
        """Show a quaternion (x, y, z, w) as angles."""
        now = np.asarray(rotation, dtype=np.float64)
        if angle_between(self._rotation(self._shown()), now) > SAME_ANGLE_RADIANS:
            for field, angle in zip(self._fields, np.degrees(to_euler(EULER_ORDER, now))[::-1], strict=True):
                field.show_value(float(angle))

    def _shown(self) -> list[float]:
        return [field.value() for field in self._fields]

    @staticmethod
    def _rotation(degrees: list[float]) -> NDArray[np.float64]:
        return from_euler(EULER_ORDER, np.radians(degrees[::-1]))

    def _set(self, axis: int, degrees: float) -> None:
        angles = self._shown()
        angles[axis] = degrees
        x, y, z, w = self._rotation(angles).tolist()
        self._put((x, y, z, w))
