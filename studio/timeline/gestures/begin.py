"""Choice of the drag for a press, and of the cursor, by the part under the mouse."""

from PySide6.QtCore import QPointF, Qt

from studio.core.captures.contacts import ContactInterval
from studio.timeline.gestures.activation import DragHandle, MoveActivation
from studio.timeline.gestures.clip import MoveClips, StretchClip, TrimClip
from studio.timeline.gestures.contact import DragContact
from studio.timeline.gestures.correction import DragCorrectionRange, MoveCorrection
from studio.timeline.gestures.gesture import TimelineGesture
from studio.timeline.gestures.hold import DragHold
from studio.timeline.gestures.label import DragLabel
from studio.timeline.gestures.media import MoveMedia
from studio.timeline.gestures.view import Scrub
from studio.timeline.shown import EDGE_PARTS, HANDLE_PARTS, Hit, ItemPart, RowContext

Cursor = Qt.CursorShape


def gesture_at(hit: Hit, shown: RowContext, press: QPointF, stretch: bool = False) -> TimelineGesture | None:
    """Drag that a press on ``hit`` starts; None if it starts none. ``stretch`` changes the speed of a clip instead of
    trimming it.
    """
    if hit.part == ItemPart.TIME:
        return Scrub(shown.document.playhead, shown.axis)
    if hit.kind in MOVABLE_COLLECTIONS and shown.project.get(hit.kind, hit.id) is None:
        return None  # deleted since the button was pressed
    if hit.kind == "constraints" and hit.part in HANDLE_PARTS:
        return DragHandle(shown, hit.id, hit.part, press)
    if hit.kind == "constraints" and hit.part == ItemPart.BODY:
        return MoveActivation(shown, hit.id, press)
    if hit.kind == "corrections" and hit.part in HANDLE_PARTS:
        return DragCorrectionRange(shown, hit.id, hit.part, press)
    if hit.kind == "corrections" and hit.part == ItemPart.BODY:
        return MoveCorrection(shown, hit.id, press)
    if hit.kind == "clips":
        if hit.part == ItemPart.BODY:
            return MoveClips(shown, hit.id, press)
        return (StretchClip if stretch else TrimClip)(shown, hit.id, hit.part, press)
    if hit.kind == "props" and (hit.part == ItemPart.BODY or hit.part in EDGE_PARTS):
        return DragHold(shown, hit.id, hit.part, press)
    if hit.kind in ("sounds", "footage") and hit.part == ItemPart.BODY:
        return MoveMedia(shown, hit.kind, hit.id, press)
    if hit.kind == "labels" and hit.id:
        return DragLabel(shown, hit.id, hit.part, press)
    if hit.kind == "contacts":
        return DragContact(shown, hit.id, hit.part, press)
    return None


MOVABLE_COLLECTIONS = ("constraints", "contacts", "clips", "props", "labels", "corrections", "sounds", "footage")
"""Collections of entities whose bars can be dragged as a whole."""


def cursor_at(hit: Hit) -> Cursor:
    """Cursor over a part: arrows for parts that can be dragged, a hand for parts that can be clicked, a cross where a
    contact or label can be added.
    """
    if hit.part in HANDLE_PARTS or hit.part in (*EDGE_PARTS, ItemPart.KEY) or hit.kind == "playhead":
        return Cursor.SizeHorCursor
    if hit.part == ItemPart.BODY and hit.kind in MOVABLE_COLLECTIONS:
        return Cursor.OpenHandCursor
    if hit.part == ItemPart.FOLD or (
        hit.part == ItemPart.LABEL and hit.kind in ("constraints", "plot", "performers", "corrections")
    ):
        return Cursor.PointingHandCursor
    if hit.kind in ("lane", "labels") and hit.part == ItemPart.EMPTY:
        return Cursor.CrossCursor
    return Cursor.ArrowCursor


def items_of(hit: Hit) -> tuple[tuple[str, str], ...]:
    """Items that a click selects; a clip together with the performer of its track."""
    if hit.kind == "clips":
        return ("performers", hit.performer_id), ("clips", hit.id)
    if hit.kind == "clip" and hit.part == ItemPart.KEY:
        return ("performers", hit.id), hit.keys[0].field.item
    if hit.part == ItemPart.KEY and hit.kind not in ("growth", "props", "constraints", "corrections"):
        return ()
    if hit.kind == "growth":
        return (("performers", hit.id),) if hit.part == ItemPart.KEY else ()
    if (
        hit.kind == "contacts"
        or (hit.kind == "labels" and hit.id)
        or (
            hit.kind in ("constraints", "performers", "props", "corrections", "sounds", "footage")
            and hit.part != ItemPart.EMPTY
        )
    ):
        return ((hit.kind, hit.id),)
    return ()


def name_of(contact: ContactInterval) -> str:
    """Name of a contact: ``Left heel contact``."""
    return f"{contact.point.words.capitalize()} contact"
