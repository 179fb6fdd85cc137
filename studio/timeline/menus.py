"""The menus of the timeline, by what lies under the mouse."""

from typing import TYPE_CHECKING

from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QMenu

from studio.core.contacts import ContactPoint
from studio.timeline import edits
from studio.timeline.gestures.contact import new_contact
from studio.timeline.shown import Hit, Part, Shown
from studio.timeline.tracks.plot import Quantity

if TYPE_CHECKING:
    from studio.timeline.canvas import TrackCanvas


def menu_at(canvas: "TrackCanvas", position: QPointF) -> QMenu | None:
    """The menu of a place, or None where nothing can be done."""
    if canvas.sheet is None:
        return None
    hit = canvas.sheet.hit(position)
    menu = QMenu(canvas)
    menu.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
    if hit.kind == "plot":
        _offer_quantities(menu, canvas, canvas.sheet.shown)
    elif hit.kind in edits.DELETABLE and hit.part != Part.EMPTY:
        canvas.document.selection.set((hit.kind, hit.id))
        _offer_deletion(menu, canvas, hit)
    elif hit.kind == "feet" and hit.part == Part.EMPTY:
        _offer_contact(menu, canvas, ContactPoint(hit.id), position)
    return menu if menu.actions() else None


def _offer_quantities(menu: QMenu, canvas: "TrackCanvas", shown: Shown) -> None:
    for quantity in Quantity:
        action = menu.addAction(f"{quantity.value} ({quantity.unit(shown)})")
        action.setCheckable(True)
        action.setChecked(quantity is canvas.picture.plot.quantity)
        action.triggered.connect(lambda _, chosen=quantity: canvas.set_quantity(chosen))


def _offer_deletion(menu: QMenu, canvas: "TrackCanvas", hit: Hit) -> None:
    action = QAction("Delete constraint" if hit.kind == "constraints" else "Delete contact", menu)
    action.triggered.connect(lambda: canvas.shown and edits.delete_selected(canvas.shown))
    menu.addAction(action)


def _offer_contact(menu: QMenu, canvas: "TrackCanvas", point: ContactPoint, position: QPointF) -> None:
    shown = canvas.shown
    if shown is None:
        return
    frame = round(shown.frame_at(position.x()))
    action = menu.addAction(f"Add {point.value.replace('_', ' ')} contact here")
    action.setEnabled(new_contact(shown, point, frame) is not None)
    action.triggered.connect(lambda: canvas.shown and edits.add_contact(canvas.shown, point, frame))
