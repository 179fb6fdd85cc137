"""Mouse buttons and modifier keys that orbit, pan and zoom the camera."""

from collections.abc import Mapping
from types import MappingProxyType

from PySide6.QtCore import Qt

Navigation = Mapping[str, str]
"""Camera drag (``orbit``, ``pan`` or ``zoom``) by modifiers and button, for example ``Shift+Middle``."""
DEFAULT_NAVIGATION: Navigation = MappingProxyType({"Alt+Left": "orbit", "Middle": "pan", "Alt+Right": "zoom"})
CAMERA_DRAGS = ("orbit", "pan", "zoom")
MOUSE_BUTTONS = {
    "Left": Qt.MouseButton.LeftButton,
    "Middle": Qt.MouseButton.MiddleButton,
    "Right": Qt.MouseButton.RightButton,
}
MODIFIER_KEYS = {
    "Alt": Qt.KeyboardModifier.AltModifier,
    "Ctrl": Qt.KeyboardModifier.ControlModifier,
    "Shift": Qt.KeyboardModifier.ShiftModifier,
}


def camera_drag(navigation: Navigation, button: Qt.MouseButton, held: Qt.KeyboardModifier) -> str | None:
    """Camera drag of a button with modifiers held; the entry with most modifiers wins. None if there is none."""
    found = [
        (len(keys), kind)
        for stroke, kind in navigation.items()
        for *keys, name in (stroke.split("+"),)
        if MOUSE_BUTTONS[name] == button and all(held & MODIFIER_KEYS[key] for key in keys)
    ]
    return max(found)[1] if found else None
