"""Keys that nudge the selection along an axis of its gizmo."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING

from PySide6.QtCore import Qt
from PySide6.QtGui import QKeyEvent

from studio.viewport.gizmo import GIZMO_AXES

if TYPE_CHECKING:
    from studio.viewport.widget import Viewport

AXIS_KEYS: Mapping[int, str] = MappingProxyType({Qt.Key[f"Key_{axis.upper()}"]: axis for axis in GIZMO_AXES})
STEP_KEYS: Mapping[int, float] = MappingProxyType({Qt.Key.Key_Plus: 1.0, Qt.Key.Key_Equal: 1.0, Qt.Key.Key_Minus: -1.0})


def nudge_by_key(viewport: Viewport, event: QKeyEvent) -> bool:
    """Choose an axis by X, Y or Z, or nudge along it by plus or minus; returns False for other keys."""
    key, held = event.key(), event.modifiers() & ~Qt.KeyboardModifier.KeypadModifier
    if key == Qt.Key.Key_Plus:
        held &= ~Qt.KeyboardModifier.ShiftModifier  # some keyboards have it above another sign
    if held:
        return False
    if key in AXIS_KEYS:
        viewport.choose_nudged_axis(AXIS_KEYS[key])
    elif key in STEP_KEYS:
        viewport.nudge(STEP_KEYS[key])
    return key in AXIS_KEYS or key in STEP_KEYS
