"""Context menus of the timeline, by the part under the mouse."""

from typing import TYPE_CHECKING

from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QMenu

from studio.core.captures.contacts import CONTACT_POINTS, ContactPoint, Touch, contact_point
from studio.document.key_edits import delete_keys
from studio.document.length_units import shown_unit
from studio.timeline import edits
from studio.timeline.clip_actions import offer_clip, offer_motions
from studio.timeline.curve_menu import offer_curves
from studio.timeline.curves import plotted_quantities
from studio.timeline.gestures.begin import items_of
from studio.timeline.gestures.contact import new_contact
from studio.timeline.shown import Hit, ItemPart, RowContext
from studio.timeline.tracks.keys import stage_times

if TYPE_CHECKING:
    from studio.timeline.track_canvas import TrackCanvas


def menu_at(canvas: "TrackCanvas", position: QPointF) -> QMenu | None:
    """Context menu for a position; None if it would be empty."""
    if canvas.sheet is None:
        return None
    hit = canvas.hit(position)
    menu = QMenu(canvas)
    menu.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
    if hit.part == ItemPart.KEY:
        _offer_key(menu, canvas, hit)
    elif hit.kind == "curves":
        offer_curves(menu, canvas)
    elif hit.kind == "plot":
        _offer_quantities(menu, canvas, canvas.sheet.context)
    elif hit.kind == "clips":
        if ("clips", hit.id) not in canvas.document.selection:
            canvas.document.selection.set(*items_of(hit))
        offer_clip(menu, canvas.sheet.context, hit)
        menu.addSeparator()
        offer_motions(menu, canvas.sheet.context, hit.performer_id, None)
    elif hit.kind in ("clip", "performers"):
        start = None if hit.part == ItemPart.LABEL else canvas.sheet.context.axis.time_at(position.x())
        offer_motions(menu, canvas.sheet.context, hit.id, start)
    elif hit.kind in ("ruler", "labels") and not hit.id and hit.part in (ItemPart.TIME, ItemPart.EMPTY):
        _offer_label(menu, canvas, round(canvas.sheet.context.frame_at(position.x())))
    elif hit.kind in edits.DELETABLE_COLLECTIONS and hit.id and hit.part != ItemPart.EMPTY:
        canvas.document.selection.set((hit.kind, hit.id))
        if hit.kind == "labels":
            menu.addAction("Rename label").triggered.connect(lambda: canvas.rename_label(hit.id))
        _offer_deletion(menu, canvas, hit)
    elif hit.kind == "lane":
        _offer_contacts(menu, canvas, hit, position)
    return menu if menu.actions() else None


def _offer_quantities(menu: QMenu, canvas: "TrackCanvas", shown: RowContext) -> None:
    for quantity in plotted_quantities():
        action = menu.addAction(f"{quantity.value} ({shown_unit(quantity.unit(shown)).symbol})")
        action.setCheckable(True)
        action.setChecked(quantity == canvas.picture.plot.quantity)
        action.triggered.connect(lambda _, chosen=quantity: canvas.set_quantity(chosen))


def _offer_label(menu: QMenu, canvas: "TrackCanvas", frame: int) -> None:
    action = menu.addAction("Add label here")
    action.triggered.connect(lambda: canvas.shown and edits.add_label(canvas.shown, frame))


def _offer_deletion(menu: QMenu, canvas: "TrackCanvas", hit: Hit) -> None:
    action = QAction(f"Delete {hit.kind.removesuffix('s')}", menu)
    action.triggered.connect(lambda: canvas.shown and edits.delete_selected(canvas.shown))
    menu.addAction(action)


def _offer_key(menu: QMenu, canvas: "TrackCanvas", hit: Hit) -> None:
    document, shown = canvas.document, canvas.shown
    if shown is None:
        return
    if not document.keys.items.intersection(hit.keys):
        canvas.select_keys(hit, add=False)
    count = len(document.keys.items)
    action = menu.addAction("Delete key" if count == 1 else f"Delete {count} keys")
    fields = document.keys.by_field().items()
    stays = all(len(places) < len(stage_times(shown, field)) for field, places in fields)
    action.setEnabled(stays)
    action.triggered.connect(lambda: delete_keys(document))


def _offer_contacts(menu: QMenu, canvas: "TrackCanvas", hit: Hit, position: QPointF) -> None:
    """Add entries that add a contact: of the point under the mouse, or of another point of the track. Over the track's
    name it is added at the playhead.
    """
    shown = canvas.shown
    if shown is None:
        return
    on_name = hit.part != ItemPart.EMPTY  # the name, or the triangle before it
    time = shown.document.playhead.time
    frame = round(shown.subject.motion_frame(time) if on_name else shown.frame_at(position.x()))
    if not on_name:
        point = contact_point(hit.id)
        _offer_contact(menu, canvas, point, frame, f"Add {point.words} contact here")
    others = menu.addMenu("Add contact of")
    for point in CONTACT_POINTS:
        _offer_contact(others, canvas, point, frame, point.words.capitalize())


def _offer_contact(menu: QMenu, canvas: "TrackCanvas", point: ContactPoint | Touch, frame: int, text: str) -> None:
    action = menu.addAction(text)
    action.setEnabled(canvas.shown is not None and new_contact(canvas.shown, point, frame) is not None)
    action.triggered.connect(lambda: canvas.shown and edits.add_contact(canvas.shown, point, frame))
