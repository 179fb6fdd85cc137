"""Context menu of the curve editor: tangents, extrapolation, and framing."""

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING

from PySide6.QtWidgets import QMenu

from studio.core.curves.keyed import Keys
from studio.core.curves.tangents import Beyond, TangentMode
from studio.document.channels import with_broken, with_even_weights, with_mode
from studio.document.key_edits import delete_keys, edit_selected, set_beyond
from studio.document.keyed_fields import Keyed

if TYPE_CHECKING:
    from studio.timeline.track_canvas import TrackCanvas


def offer_curves(menu: QMenu, canvas: "TrackCanvas") -> None:
    """Fill the menu with actions on the selected keys and on the visible curves."""
    document, shown = canvas.document, canvas.shown
    if shown is None:
        return
    selected = bool(document.keys.items)
    modes: dict[str, Callable[[Keyed, int], Keyed]] = {
        f"{mode.value.capitalize()} tangents": partial(_with_mode, mode) for mode in TangentMode
    }
    edits: dict[str, Callable[[Keyed, int], Keyed]] = {
        "Break tangents": partial(_with_broken_tangents, True),
        "Unify tangents": partial(_with_broken_tangents, False),
        "Reset tangent weights": with_even_weights,
    }
    for group in (modes, edits):
        for text, edit in group.items():
            _offer(menu, text, partial(edit_selected, document, edit, text), selected)
        menu.addSeparator()
    channels = canvas.picture.curves.channels(shown)
    keyed = {channel.field: value for channel, value in channels if isinstance(value, Keys)}
    for side in ("before", "after"):
        inner = menu.addMenu(f"{'Pre' if side == 'before' else 'Post'}-infinity")
        for beyond in Beyond:
            action = inner.addAction(beyond.value.capitalize())
            action.setCheckable(True)
            action.setChecked(bool(keyed) and all(getattr(value, side) is beyond for value in keyed.values()))
            action.triggered.connect(lambda _=False, side=side, beyond=beyond: _set_beyond(canvas, side, beyond))
    menu.addSeparator()
    normalize = menu.addAction("Normalize curves")
    normalize.setCheckable(True)
    normalize.setChecked(canvas.picture.curves.normalized)
    normalize.triggered.connect(canvas.set_normalized)
    _offer(menu, "Frame all", partial(canvas.frame_curves, False), True)
    _offer(menu, "Frame selected", partial(canvas.frame_curves, True), selected)
    _offer(menu, "Delete keys", partial(delete_keys, document), selected)


def _offer(menu: QMenu, text: str, run: Callable[[], object], enabled: bool) -> None:
    action = menu.addAction(text)
    action.setEnabled(enabled)
    action.triggered.connect(lambda: run())


def _set_beyond(canvas: "TrackCanvas", side: str, beyond: Beyond) -> None:
    if canvas.shown is not None:
        fields = dict.fromkeys(channel.field for channel, _ in canvas.picture.curves.channels(canvas.shown))
        set_beyond(canvas.document, fields, side, beyond)


def _with_mode(mode: TangentMode, keyed: Keyed, index: int) -> Keyed:
    return with_mode(keyed, index, mode)


def _with_broken_tangents(broken: bool, keyed: Keyed, index: int) -> Keyed:
    return with_broken(keyed, index, broken)
