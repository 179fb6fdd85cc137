"""The keys of the timeline: frames, keys and contacts, handles, deletion, Esc."""

from typing import TYPE_CHECKING

from PySide6.QtCore import Qt

from studio.timeline import edits

if TYPE_CHECKING:
    from studio.timeline.canvas import TrackCanvas

Key = Qt.Key
STEPS = {Key.Key_Left: -1, Key.Key_Right: 1}
JUMPS = {Key.Key_Up: -1, Key.Key_Down: 1}


def is_wanted(canvas: "TrackCanvas", key: int) -> bool:
    """Whether a key means something here that the window's shortcuts must not take."""
    if key == Key.Key_Escape:
        return canvas.gesture is not None or canvas.handle is not None
    return key in STEPS and canvas.handle is not None


def press_key(canvas: "TrackCanvas", key: Qt.Key, modifiers: Qt.KeyboardModifier) -> bool:
    """Do what a key stands for; whether it stands for anything."""
    shown = canvas.shown
    if shown is None:
        return False
    if key in STEPS and canvas.handle is not None:
        edits.nudge(shown, STEPS[key])
        canvas.setAccessibleName(edits.handle_words(shown))
    elif key in (Key.Key_Delete, Key.Key_Backspace):
        return edits.delete_selected(shown)
    elif key == Key.Key_Escape:
        return _escape(canvas)
    else:
        return _move_playhead(canvas, key, bool(modifiers & Qt.KeyboardModifier.ShiftModifier))
    return True


def _escape(canvas: "TrackCanvas") -> bool:
    if canvas.gesture is not None:
        canvas.gesture.cancel()
        canvas.end_gesture()
    elif canvas.handle is not None:
        canvas.set_handle(None)
    else:
        return False
    return True


def _move_playhead(canvas: "TrackCanvas", key: Qt.Key, to_end: bool) -> bool:
    playhead = canvas.document.playhead
    if key == Key.Key_Home or (key == Key.Key_Left and to_end):
        playhead.set_frame(playhead.first)
    elif key == Key.Key_End or (key == Key.Key_Right and to_end):
        playhead.set_frame(playhead.last)
    elif key in STEPS:
        playhead.step(STEPS[key])
    elif key in JUMPS and canvas.shown is not None:
        edits.go_to_key(canvas.shown, JUMPS[key])
    else:
        return False
    return True
