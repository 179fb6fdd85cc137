"""Undo command that replaces values of the project; every edit is one of these."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, fields, is_dataclass, replace
from itertools import groupby
from operator import attrgetter
from typing import Any
from weakref import WeakMethod

import numpy as np
from PySide6.QtGui import QUndoCommand

from studio.core.stage.project import Entity, Project
from studio.document.keyed_fields import KeyRef

GESTURE_COMMAND_ID = 1


@dataclass(frozen=True, eq=False)
class Edit:
    """Change of one entity: ``old`` None is an addition, ``new`` None a removal, and ``place`` the index in the
    collection.
    """

    collection: str
    entity_id: str
    old: Entity | None
    new: Entity | None
    place: int | None = None

    @property
    def item(self) -> tuple[str, str]:
        """Collection and id of the entity."""
        return self.collection, self.entity_id

    @property
    def reverted(self) -> "Edit":
        """Inverse of this edit."""
        return Edit(self.collection, self.entity_id, self.new, self.old, self.place)


def with_edits_applied(project: Project, edits: Iterable[Edit]) -> Project:
    """``project`` after all edits, applied in order."""
    for collection, run in groupby(edits, key=attrgetter("collection")):
        project = project.with_entities(collection, ((edit.entity_id, edit.new, edit.place) for edit in run))
    return project


def reverted_edits(edits: tuple[Edit, ...]) -> tuple[Edit, ...]:
    """Inverse edits in reverse order, so that every index is restored."""
    return tuple(edit.reverted for edit in reversed(edits))


def same_value(first: Any, second: Any) -> bool:
    """True if two entities have equal fields; unlike ``==`` it can compare fields that are arrays."""
    if first is second:
        return True
    if type(first) is not type(second):
        return False
    if isinstance(first, np.ndarray):
        return np.array_equal(first, second, equal_nan=first.dtype.kind == "f")
    if isinstance(first, tuple):
        return len(first) == len(second) and all(map(same_value, first, second))
    if is_dataclass(first):
        return all(same_value(getattr(first, f.name), getattr(second, f.name)) for f in fields(first))
    return bool(first == second)


@dataclass(frozen=True)
class SelectionState:
    """Selected entities, by collection and id, and keys at one moment."""

    items: tuple[tuple[str, str], ...] = ()
    keys: frozenset[KeyRef] = frozenset()


class ReplaceValue(QUndoCommand):
    """Undo step of several edits. Steps of one gesture merge, and a step without a net change is dropped."""

    def __init__(
        self,
        show: Callable[[tuple[Edit, ...], str, str, int | None, SelectionState], SelectionState],
        edits: tuple[Edit, ...],
        text: str,
        gesture: int | None,
        selected: SelectionState = SelectionState(),
    ) -> None:
        """``selected`` is the selection before; ``show`` applies edits and returns the selection at that moment."""
        super().__init__(text)
        # A strong one closes a cycle through the stack's C++ side, which crashes the garbage collector.
        self._document_step = WeakMethod(show)
        self.edits, self.gesture = edits, gesture
        self._selected = selected
        """Selection in the state on the other side of this step."""
        self.vanishes = False
        """The command leaves the stack as it is undone, and cannot be redone."""
        self._verb = "edit"

    def redo(self) -> None:
        """Set the new values."""
        before = self._show(self.edits, self._verb)
        self._selected = self._selected if self._verb == "edit" else before
        self._verb = "redo"

    def undo(self) -> None:
        """Restore the old values."""
        self._selected = self._show(reverted_edits(self.edits), "undo")
        self.setObsolete(self.vanishes)

    def _show(self, edits: tuple[Edit, ...], verb: str) -> SelectionState:
        step = self._document_step()
        return self._selected if step is None else step(edits, verb, self.text(), self.gesture, self._selected)

    def id(self) -> int:
        """Id by which Qt merges commands: the same for all commands of gestures, -1 for others."""
        return -1 if self.gesture is None else GESTURE_COMMAND_ID

    def mergeWith(self, other: QUndoCommand) -> bool:
        """Merge a later command of the same gesture into this one."""
        if not isinstance(other, ReplaceValue) or other.gesture != self.gesture:
            return False
        self.edits, other.edits = merged_edits(self.edits, other.edits), ()  # Qt deletes the other one, Python keeps it
        self.setText(other.text())
        self.setObsolete(not self.edits)
        return True


def merged_edits(earlier: tuple[Edit, ...], later: tuple[Edit, ...]) -> tuple[Edit, ...]:
    """Two successive lists of edits as one: one edit per entity, without those that have no net change.

    An edit is merged with an earlier one of its entity unless entities were added or removed in between, because
    indices refer to that moment; an addition that is later removed is dropped.
    """
    result, last, fixed = list(earlier), {edit.item: at for at, edit in enumerate(earlier)}, -1
    for at, edit in enumerate(earlier):
        fixed = at if edit.old is None or edit.new is None else fixed
    for edit in later:
        at = last.get(edit.item, -1)
        before = result[at] if at >= max(fixed, 0) else None
        if before is None or before.new is None or (edit.new is None and before.old is not None):
            fixed = len(result) if edit.old is None or edit.new is None else fixed
            last[edit.item] = len(result)
            result.append(edit)
        else:
            result[at] = replace(before, new=edit.new)
    return tuple(edit for edit in result if edit.old is not edit.new and not same_value(edit.old, edit.new))
