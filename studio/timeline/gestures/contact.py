"""Drags on a contact, and how long a new one is: contacts of one point never overlap."""

from dataclasses import replace

from PySide6.QtCore import QPointF

from studio.core.captures.contacts import ContactInterval, ContactPoint, Touch
from studio.core.stage.scope import EVERYONE
from studio.timeline.figures import moment
from studio.timeline.gestures.gesture import EditGesture, Mark
from studio.timeline.shown import Part, Shown
from studio.timeline.snapping import Snapped

LONGEST_NEW = 0.3
"""Seconds of a contact that is added by hand."""


def free_stretch(shown: Shown, point: ContactPoint | Touch, frame: int, without: str = "") -> tuple[int, int] | None:
    """First and last frame about ``frame`` that no contact of the point takes; None where one stands."""
    first, last = 0, shown.subject.last_frame
    for key, contact in contacts_shown(shown).items():
        if contact.point != point or key == without:
            continue
        if contact.first <= frame <= contact.last:
            return None
        if contact.last < frame:
            first = max(first, contact.last + 1)
        else:
            last = min(last, contact.first - 1)
    return (first, last) if first <= frame <= last else None


def new_contact(shown: Shown, point: ContactPoint | Touch, frame: int) -> ContactInterval | None:
    """A contact about ``frame``, at most 0.3 s long and up to its neighbours; None where one stands."""
    subject, room = shown.subject, free_stretch(shown, point, frame)
    if room is None:
        return None
    length = min(int(LONGEST_NEW * subject.frame_rate), room[1] - room[0])
    first = min(max(frame - length // 2, room[0]), room[1] - length)
    scopes = [each.scope for each in contacts_shown(shown).values() if each.point == point]
    return ContactInterval(subject.motion_id, point, first, first + length, scopes[0] if scopes else EVERYONE)


def contacts_shown(shown: Shown) -> dict[str, ContactInterval]:
    """What stands while the active performer plays the clip, by id."""
    return shown.project.contacts_for(shown.subject.performer_id, shown.subject.clip)


class DragContact(EditGesture):
    """Drag a contact's body to move it, an end to trim it; it stops at its neighbours."""

    collection = "contacts"

    def __init__(self, shown: Shown, entity_id: str, part: Part, press: QPointF) -> None:
        super().__init__(shown, entity_id, press)
        self.part = part
        name = self.original.point.words
        self.text = f"Move {name} contact" if part == Part.BODY else f"Trim {name} contact"
        room = free_stretch(shown, self.original.point, self.original.first, without=entity_id)
        self._room = room or (self.original.first, self.original.last)

    def update(self, position: QPointF, free: bool) -> None:
        """Whole frames always; ``free`` only keeps it from catching on what lies near."""
        subject, old = self.shown.subject, self.original
        caught = self._catch(old.last if self.part == Part.LAST else old.first, position, free)
        if self.part == Part.BODY and caught.caught is None:
            behind = subject.stage_time(old.last) - subject.stage_time(old.first)
            end = self._catch(old.last, position, free)
            caught = Snapped(end.time - behind, end.caught) if end.caught is not None else caught
        contact = self._dragged(round(subject.motion_frame(caught.time)))
        self.put(contact)
        shown_frame = contact.last if self.part == Part.LAST else contact.first
        text = moment(shown_frame, shown_frame / subject.frame_rate)
        self.mark = Mark(subject.stage_time(shown_frame), text, caught.caught)

    def _catch(self, grabbed: int, position: QPointF, free: bool) -> Snapped:
        """Where one of its ends would come to lie."""
        return self.snap(self.shown.subject.stage_time(grabbed) + self.moved(position), free)

    def _dragged(self, frame: int) -> ContactInterval:
        old, (low, high) = self.original, self._room
        if self.part == Part.FIRST:
            return replace(old, first=min(max(frame, low), old.last))
        if self.part == Part.LAST:
            return replace(old, last=max(min(frame, high), old.first))
        length = old.last - old.first
        first = max(min(frame, high - length), low)
        return replace(old, first=first, last=first + length)
