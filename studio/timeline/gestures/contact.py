"""Drags on contacts, and the length of new contacts. Contacts of one point never overlap."""

from collections.abc import Collection
from dataclasses import replace

from PySide6.QtCore import QPointF

from studio.core.captures.contacts import ContactInterval, ContactPoint, Touch
from studio.core.constraints.scope import EVERYONE
from studio.timeline.gestures.gesture import DragHint, EditGesture
from studio.timeline.shown import ItemPart, RowContext
from studio.timeline.snapping import Snapped

MAX_NEW_CONTACT_SECONDS = 0.3
"""Maximum length in seconds of a contact that is added by hand."""


def gap_between_contacts(
    shown: RowContext, point: ContactPoint | Touch, frame: int, without: Collection[str] = ()
) -> tuple[int, int] | None:
    """First and last frame of the gap around ``frame`` between contacts of a point, ignoring those in ``without``; None
    if a contact is there.
    """
    first, last = 0, shown.subject.last_frame
    for key, contact in contacts_shown(shown).items():
        if contact.point != point or key in without:
            continue
        if contact.first <= frame <= contact.last:
            return None
        if contact.last < frame:
            first = max(first, contact.last + 1)
        else:
            last = min(last, contact.first - 1)
    return (first, last) if first <= frame <= last else None


def new_contact(shown: RowContext, point: ContactPoint | Touch, frame: int) -> ContactInterval | None:
    """New contact of a point around ``frame``, at most ``MAX_NEW_CONTACT_SECONDS`` seconds long and within the gap to
    its neighbours; None if a contact is there.
    """
    subject, room = shown.subject, gap_between_contacts(shown, point, frame)
    if room is None:
        return None
    length = min(int(MAX_NEW_CONTACT_SECONDS * subject.frame_rate), room[1] - room[0])
    first = min(max(frame - length // 2, room[0]), room[1] - length)
    scopes = [each.scope for each in contacts_shown(shown).values() if each.point == point]
    return ContactInterval(subject.motion_id, point, first, first + length, scopes[0] if scopes else EVERYONE)


def contacts_shown(shown: RowContext) -> dict[str, ContactInterval]:
    """Contacts of the active performer's clip, by id."""
    return shown.project.contacts_for(shown.subject.performer_id, shown.subject.clip)


class DragContact(EditGesture[ContactInterval]):
    """Drag of a contact, or of its first or last frame; it stops at neighbouring contacts of the point."""

    collection = "contacts"

    def __init__(self, shown: RowContext, entity_id: str, part: ItemPart, press: QPointF) -> None:
        super().__init__(shown, entity_id, press)
        self.part = part
        self.text = f"{'Move' if part == ItemPart.BODY else 'Trim'} {self.words}"
        # Contacts that move together leave each other room; those that are trimmed stop at each other.
        self._rooms = {
            key: gap_between_contacts(
                shown, each.point, each.first, self.originals if part == ItemPart.BODY else (key,)
            )
            or (each.first, each.last)
            for key, each in self.originals.items()
        }

    @property
    def words(self) -> str:
        """Name of the dragged contacts: ``left heel contact``, or ``2 contacts``."""
        return super().words if len(self.originals) > 1 else f"{self.original.point.words} contact"

    def update(self, position: QPointF, free: bool) -> None:
        """Move or trim by whole frames; ``free`` turns snapping to magnets off."""
        subject, old = self.shown.subject, self.original
        caught = self._catch(old.last if self.part == ItemPart.LAST else old.first, position, free)
        if self.part == ItemPart.BODY and caught.magnet is None:
            behind = subject.stage_time(old.last) - subject.stage_time(old.first)
            end = self._catch(old.last, position, free)
            caught = Snapped(end.time - behind, end.magnet) if end.magnet is not None else caught
        grabbed = old.last if self.part == ItemPart.LAST else old.first
        frames = self._within(round(subject.motion_frame(caught.time)) - grabbed)
        self.show_all_edited(lambda key, each: self._dragged(key, each, frames))
        contact = self._dragged(self.entity_id, old, frames)
        shown_frame = contact.last if self.part == ItemPart.LAST else contact.first
        text = self.shown.moment(shown_frame)
        self.mark = DragHint(subject.stage_time(shown_frame), text, caught.magnet)

    def _catch(self, grabbed: int, position: QPointF, free: bool) -> Snapped:
        """Stage time to which the ``grabbed`` frame is dragged, snapped."""
        return self.snap(self.shown.subject.stage_time(grabbed) + self.moved(position), free)

    def _within(self, frames: int) -> int:
        """``frames`` clamped to the displacement that all dragged contacts allow."""
        if self.part != ItemPart.BODY:
            return frames
        rooms = [(self._rooms[key], each) for key, each in self.originals.items()]
        most: int = min(high - each.last for (_, high), each in rooms)
        least: int = max(low - each.first for (low, _), each in rooms)
        return max(least, min(frames, most))

    def _dragged(self, key: str, old: ContactInterval, frames: int) -> ContactInterval:
        low, high = self._rooms[key]
        if self.part == ItemPart.FIRST:
            return replace(old, first=min(max(old.first + frames, low), old.last))
        if self.part == ItemPart.LAST:
            return replace(old, last=max(min(old.last + frames, high), old.first))
        return replace(old, first=old.first + frames, last=old.last + frames)
