"""Keys of the timeline: step by frames, keys and contacts, move handles, delete, cancel."""

from typing import TYPE_CHECKING

from PySide6.QtCore import Qt

from studio.document.key_edits import nudge_keys, stretch_keys
from studio.timeline import edits
from studio.timeline.shown import RowContext

if TYPE_CHECKING:
    from studio.timeline.track_canvas import TrackCanvas

Key, Modifier = Qt.Key, Qt.KeyboardModifier
FRAME_STEPS = {Key.Key_Left: -1, Key.Key_Right: 1}
FRAMING_KEYS = (Key.Key_A, Key.Key_F)
"""Keys that frame all curves, or the selected keys, in the curve editor."""
JUMP_DIRECTIONS = {Key.Key_Up: -1, Key.Key_Down: 1}


def handles_key(canvas: "TrackCanvas", key: int, modifiers: Qt.KeyboardModifier) -> bool:
    """True if the timeline uses a key, which is then not available as a shortcut of the window."""
    if key == Key.Key_Escape:
        return canvas.gesture is not None or canvas.handle is not None or bool(canvas.document.keys.items)
    if _moves_keys(key, modifiers) or _jumps_to_key(key, modifiers):
        return True
    if canvas.editing and key in FRAMING_KEYS and modifiers == Modifier.NoModifier:
        return True
    if (key, modifiers) == (Key.Key_A, Modifier.ControlModifier):
        return True
    return key in FRAME_STEPS and canvas.handle is not None


def press_key(canvas: "TrackCanvas", key: Qt.Key, modifiers: Qt.KeyboardModifier) -> bool:
    """Perform the function of a key; returns False if it has none."""
    shown = canvas.shown
    if shown is None:
        return False
    if _moves_keys(key, modifiers) and canvas.gesture is None:
        _move_keys(shown, key, modifiers)
    elif _jumps_to_key(key, modifiers):
        edits.go_to_key(shown, JUMP_DIRECTIONS[key])
        edits.select_keys_at_playhead(shown)
    elif canvas.editing and key in FRAMING_KEYS and modifiers == Modifier.NoModifier:
        canvas.frame_curves(key == Key.Key_F)
    elif (key, modifiers) == (Key.Key_A, Modifier.ControlModifier):
        edits.select_all_keys(shown)
    elif key in FRAME_STEPS and canvas.handle is not None:
        edits.nudge_handle(shown, FRAME_STEPS[key])
        canvas.setAccessibleName(edits.handle_words(shown))
    elif key in (Key.Key_Delete, Key.Key_Backspace):
        return edits.delete_selected(shown)
    elif key == Key.Key_Escape:
        return _escape(canvas)
    else:
        return _move_playhead(canvas, key, bool(modifiers & Qt.KeyboardModifier.ShiftModifier))
    return True


def _moves_keys(key: int, modifiers: Qt.KeyboardModifier) -> bool:
    return bool(modifiers & Modifier.AltModifier) and key in FRAME_STEPS


def _jumps_to_key(key: int, modifiers: Qt.KeyboardModifier) -> bool:
    return modifiers == Modifier.ControlModifier and key in JUMP_DIRECTIONS


def _move_keys(shown: RowContext, key: Qt.Key, modifiers: Qt.KeyboardModifier) -> None:
    """Move the selected keys by one frame, with Shift by ten; with Ctrl scale them instead."""
    if modifiers & Modifier.ControlModifier:
        stretch_keys(shown.document, FRAME_STEPS[key])
    else:
        nudge_keys(shown.document, FRAME_STEPS[key] * (10 if modifiers & Modifier.ShiftModifier else 1))


def _escape(canvas: "TrackCanvas") -> bool:
    if canvas.gesture is not None:
        canvas.gesture.cancel()
        canvas.end_gesture()
    elif canvas.handle is not None:
        canvas.set_handle(None)
    elif canvas.document.keys.items:
        canvas.document.keys.clear()
    else:
        return False
    return True


def _move_playhead(canvas: "TrackCanvas", key: Qt.Key, to_end: bool) -> bool:
    playhead = canvas.document.playhead
    if key == Key.Key_Home or (key == Key.Key_Left and to_end):
        playhead.set_frame(playhead.first)
    elif key == Key.Key_End or (key == Key.Key_Right and to_end):
        playhead.set_frame(playhead.last)
    elif key in FRAME_STEPS:
        playhead.step(FRAME_STEPS[key])
    elif key in JUMP_DIRECTIONS and canvas.shown is not None:
        edits.go_to_key(canvas.shown, JUMP_DIRECTIONS[key])
    else:
        return False
    return True
