"""Edited project: an immutable project replaced by undo commands, with its selection and playhead."""

import weakref
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from itertools import groupby
from operator import itemgetter

from PySide6.QtCore import QObject, Signal
from PySide6.QtGui import QUndoStack
from shiboken6 import isValid

from studio.core.constraints.base import Constraint
from studio.core.constraints.follow import FollowTracked
from studio.core.constraints.objections import objection
from studio.core.constraints.target import follows_of
from studio.core.errors import StudioError
from studio.core.solver.performers.rows import stage_span
from studio.core.stage.clip import Clip
from studio.core.stage.project import COLLECTION_CLASSES, GROUND_ID, Entity, Performer, Project, new_ids, references
from studio.document.commands.removal import removal_edits
from studio.document.commands.replace import (
    Edit,
    ReplaceValue,
    SelectionState,
    merged_edits,
    reverted_edits,
    same_value,
    with_edits_applied,
)
from studio.document.key_selection import KeySelection
from studio.document.mirrored import mirrored_edit, mirrored_entity, mirrored_project
from studio.document.playhead import INITIAL_PLAYHEAD, Playhead
from studio.document.selection import Item, Selection

MANY_EDITS = 100


class EditedProject(QObject):
    """Project with edits, undo, selection and playhead, but without files."""

    entity_changed = Signal(str, str)
    """Emitted with collection and id; the id is empty if one step changed more than ``MANY_EDITS`` entities of a
    collection.
    """
    project_opened = Signal()
    saved_state_changed = Signal()
    problem_reported = Signal(str)

    def __init__(self, project: Project | None = None, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._project = project or Project()
        self._revision = 0
        self._gesture = 0
        self._group: list[Edit] | None = None
        self._shown_already = False
        self._mirrored: tuple[Project, str, Clip, Project] | None = None
        self.undo_stack = QUndoStack(self)
        # A stack that is destroyed tells of its last steps, when those who listen may be gone; and Qt crashes where
        # Python collects commands before the stack that holds them.
        weakref.finalize(self, _empty, self.undo_stack)
        self.selection = Selection(self)
        self._active_before: str | None = None
        self._active: tuple[Project, tuple[Item, ...], str | None, str | None] | None = None
        self._active_clip: tuple[Project, str, tuple[Item, ...], str | None, Clip | None] | None = None
        """Active performer, last, of a project and a selection, and of who was active before."""
        self._clip_before: str | None = None
        self.selection.changed.connect(self._keep_active)
        self.keys = KeySelection(self)
        self.playhead = Playhead(self)
        self.undo_stack.cleanChanged.connect(self._tell_saved_state)
        self._fit_playhead()

    @property
    def project(self) -> Project:
        """Current project, an immutable value that any thread may hold."""
        return self._project

    @property
    def shown_project(self) -> Project:
        """Project as the active clip shows it: if that clip is mirrored, its constraints and contacts are on the other
        side.
        """
        clip, performer_id = self.active_clip, self.active_performer_id
        if clip is None or performer_id is None or not clip.mirrored:
            return self._project
        known = self._mirrored
        if known is None or known[0] is not self._project or known[1:3] != (performer_id, clip):
            shown = mirrored_project(self._project, performer_id, clip)
            known = self._mirrored = self._project, performer_id, clip, shown
        return known[3]

    @property
    def revision(self) -> int:
        """Number that increases with every change of the project."""
        return self._revision

    @property
    def dirty(self) -> bool:
        """True if there are unsaved changes."""
        return not self.undo_stack.isClean()

    @property
    def history(self) -> tuple[str, ...]:
        """Texts of all undo steps, including undone ones; the first ``undo_stack.index()`` of them are applied."""
        return tuple(self.undo_stack.text(step) for step in range(self.undo_stack.count()))

    def replace(self, collection: str, entity_id: str, new: Entity, text: str, gesture: int | None = None) -> None:
        """Replace an entity by ``new``: one undo step, or a part of the gesture's step.

        Raises StudioError if the entity does not exist, ``new`` refers to a missing one, or it is a constraint that
        conflicts with the others (in a group that is checked at its end).
        """
        old = self._existing(collection, entity_id)
        self._check(collection, new)
        if not same_value(old, new):
            if self._group is None:
                edits = (Edit(collection, entity_id, old, new),)
                self._refuse(self._project, with_edits_applied(self._project, edits), edits)
            self._change((Edit(collection, entity_id, old, new),), text, gesture)

    def replace_shown(
        self, collection: str, entity_id: str, new: Entity, text: str, gesture: int | None = None
    ) -> None:
        """Replace an entity by ``new``, which was made from ``shown_project``; mirroring is undone first. Arguments and
        errors are those of ``replace``.
        """
        old = self._existing(collection, entity_id)
        if (clip := self._mirrored_clip_of(old)) is not None:
            new = mirrored_edit(self._project, self.active_performer_id or "", clip, old, new)
        self.replace(collection, entity_id, new, text, gesture)

    def add_shown(self, collection: str, entity: Entity, text: str) -> str:
        """Add an entity made from ``shown_project``, mirrored back if the active clip is mirrored; returns its id."""
        if (clip := self._mirrored_clip_of(entity)) is not None:
            entity = mirrored_entity(self._project, self.active_performer_id or "", clip, entity)
        return self.add(collection, entity, text)

    def _mirrored_clip_of(self, entity: Entity) -> Clip | None:
        """Active clip if it is mirrored and plays the motion of ``entity``, else None."""
        clip = self.active_clip
        is_mirrored = clip is not None and clip.mirrored and getattr(entity, "motion_id", None) == clip.motion_id
        return clip if is_mirrored else None

    def add(self, collection: str, entity: Entity, text: str) -> str:
        """Append a new entity to its collection and return its id. Raises StudioError if it refers to a missing entity
        or conflicts with others.
        """
        [entity_id] = self.add_all(collection, (entity,), text)
        return entity_id

    def add_all(self, collection: str, entities: Iterable[Entity], text: str) -> list[str]:
        """Append many new entities to a collection in one undo step, and return their ids. It is much faster than
        repeated ``add``.
        """
        entities = tuple(entities)
        return self.put_all(collection, dict(zip(new_ids(len(entities)), entities, strict=True)), text)

    def put_all(self, collection: str, entities: Mapping[str, Entity], text: str) -> list[str]:
        """Append entities with given new ids to a collection in one undo step, and return the ids."""
        index = len(getattr(self._project, collection))
        self._check(collection, *entities.values())
        edits = tuple(
            Edit(collection, entity_id, None, entity, index + number)
            for number, (entity_id, entity) in enumerate(entities.items())
        )
        if edits and self._group is None:
            self._refuse(self._project, with_edits_applied(self._project, edits), edits)
        if edits:
            self._change(edits, text, None)
        return list(entities)

    def remove(self, collection: str, entity_id: str, text: str) -> None:
        """Remove an entity, and everything that depends on it, as one step."""
        self._existing(collection, entity_id)
        if (collection, entity_id) == ("grounds", GROUND_ID):
            raise StudioError("The stage always has a ground. Set its height instead of removing it.")
        self._change(removal_edits(self._project, collection, entity_id), text, None)

    @contextmanager
    def group(self, text: str, gesture: int | None = None) -> Iterator[None]:
        """Context in which all changes are one undo step; an exception reverts them."""
        if self._group is not None:
            yield
            return
        self._group, before, selected = [], self._project, self._selected
        try:
            yield
            self._refuse(before, self._project, self._group)
        except BaseException:
            undone, self._group = tuple(self._group), None
            self._show(reverted_edits(undone))
            raise
        edits, self._group = tuple(self._group), None
        edits = merged_edits((), edits)
        if edits:
            self._shown_already = True
            self.undo_stack.push(ReplaceValue(self._step, edits, text, gesture, selected))

    def new_gesture(self) -> int:
        """New number for the edits of one drag, which become one undo step."""
        self._gesture += 1
        return self._gesture

    def undo_gesture(self, gesture: int) -> None:
        """Undo the step of a gesture, without redo, if it is the newest step."""
        newest = self.undo_stack.command(self.undo_stack.index() - 1)
        if isinstance(newest, ReplaceValue) and newest.gesture == gesture:
            newest.vanishes = True
            self.undo_stack.undo()

    @property
    def active_performer_id(self) -> str | None:
        """Id of the performer to which actions apply; None without performers.

        The selected performer, else a visible one that plays a selected clip or to which a selected entity applies,
        else the one that was active before if it is visible, else the first.
        """
        items, before, known = self.selection.items, self._active_before, self._active
        if known is None or known[0] is not self._project or known[1:3] != (items, before):
            known = self._active = self._project, items, before, self._find_active_performer()
        return known[3]

    def _find_active_performer(self) -> str | None:
        performers = self._project.performers
        selected = [key for key in self.selection.of("performers") if key in performers]
        visible = [key for key, performer in performers.items() if performer.visible]
        visible.sort(key=lambda key: key != self._active_before)
        concerned = [key for key in visible if self._concerns_selection(performers[key], key)]
        return next(iter((*reversed(selected), *concerned, *visible)), None)

    def _concerns_selection(self, performer: Performer, performer_id: str) -> bool:
        """True if the performer has a selected clip or correction, or a clip to which a selected constraint or contact
        applies.
        """
        clips = {*self.selection.of("clips")}
        corrections = self._project.corrections_of(performer_id)
        if any(key in corrections for key in self.selection.of("corrections")):
            return True
        scoped = [self._project.get(*item) for item in self.selection.items if item[0] in ("constraints", "contacts")]
        return any(
            clip.id in clips
            or any(each.motion_id == clip.motion_id and each.scope.includes(performer_id, clip.id) for each in scoped)
            for clip in performer.all_clips
        )

    def _keep_active(self) -> None:
        self._active_before = self.active_performer_id
        clip = self.active_clip
        self._clip_before = clip.id if clip else None

    @property
    def active_clip(self) -> Clip | None:
        """Clip of the active performer to which actions apply; None without clips.

        The selected one, or one to which a selected entity applies; of several, or without a selection, the one that
        was active before, else the first.
        """
        performer_id, items, before = self.active_performer_id or "", self.selection.items, self._clip_before
        known = self._active_clip
        if known is None or known[0] is not self._project or known[1:4] != (performer_id, items, before):
            clip = self._find_active_clip(performer_id)
            known = self._active_clip = self._project, performer_id, items, before, clip
        return known[4]

    def _find_active_clip(self, performer_id: str) -> Clip | None:
        performer = self._project.performers.get(performer_id)
        clips = sorted(performer.clips if performer else (), key=lambda clip: clip.id != self._clip_before)
        selected = {*self.selection.of("clips")}
        asked = [self._project.get(*item) for item in self.selection.items if item[0] in ("constraints", "contacts")]
        for clip in clips:
            if clip.id in selected:
                return clip
        for clip in clips:
            if any(each.motion_id == clip.motion_id and each.scope.includes(performer_id, clip.id) for each in asked):
                return clip
        return clips[0] if clips else None

    @property
    def active_motion_id(self) -> str | None:
        """Id of the motion of the active clip; None without one."""
        return self.active_clip.motion_id if self.active_clip else None

    def _show_other(self, project: Project) -> None:
        """Replace the project by another one with an empty history."""
        self.playhead.pause()
        self._project = project
        self._revision += 1
        self._active_before = self._clip_before = self._mirrored = None
        self.selection.clear()  # first: who hears of the others asks what is selected
        self.undo_stack.clear()
        self.undo_stack.setClean()
        self.playhead.restore(INITIAL_PLAYHEAD)
        self.playhead.speed = 1.0
        self._fit_playhead()
        self.project_opened.emit()

    def _recorded(self, edits: tuple[Edit, ...], verb: str, text: str, gesture: int | None) -> None:
        """Hook that is called after every step; ``Document`` writes the step to its journal."""

    def _tell_saved_state(self) -> None:
        self.saved_state_changed.emit()

    def _existing(self, collection: str, entity_id: str) -> Entity:
        entity: Entity | None = self._project.get(collection, entity_id)
        if entity is None:
            raise StudioError(f"The project has no {entity_id!r} among its {collection}.")
        return entity

    def _check(self, collection: str, *entities: Entity) -> None:
        for entity in entities:
            if not isinstance(entity, COLLECTION_CLASSES[collection]):
                raise TypeError(f"A {type(entity).__name__} does not belong among the {collection}.")
        for name, key in dict.fromkeys(reference for entity in entities for reference in references(entity)):
            if self._project.get(name, key) is None:
                raise StudioError(f"It refers to {key!r}, which is not among the project's {name}.")
        for entity in entities if collection == "constraints" else ():
            self._check_tracked(entity)

    def _check_tracked(self, constraint: Entity) -> None:
        """Raise StudioError if a constraint follows a joint that its capture does not have."""
        assert isinstance(constraint, Constraint)
        capture = self._project.captures[self._project.motions[constraint.motion_id].capture_id]
        for follow in follows_of(constraint):
            if isinstance(follow, FollowTracked):
                capture.skeleton.index(follow.joint)

    def _refuse(self, before: Project, after: Project, edits: Iterable[Edit]) -> None:
        """Raise StudioError if an edited constraint conflicts with others and did not before."""
        for key in dict.fromkeys(edit.entity_id for edit in edits if edit.collection == "constraints"):
            sentence = _objection(after, key)
            if sentence is not None and _objection(before, key) is None:
                raise StudioError(sentence)

    def _change(self, edits: tuple[Edit, ...], text: str, gesture: int | None) -> None:
        if self._group is not None:
            self._show(edits)
            self._group += edits
        else:
            self.undo_stack.push(ReplaceValue(self._step, edits, text, gesture, self._selected))

    @property
    def _selected(self) -> SelectionState:
        return SelectionState(self.selection.items, self.keys.items)

    def _step(
        self, edits: tuple[Edit, ...], verb: str, text: str, gesture: int | None, state: SelectionState
    ) -> SelectionState:
        """Apply and record the edits of a command; in a group they are applied already.

        Undo and redo restore the selection ``state`` if they bring back entities of it or remove selected ones, and its
        keys. Returns the selection before.
        """
        before, selected = self._project, self._selected
        if not self._shown_already:
            self._show(edits)
        self._shown_already = False
        if verb != "edit":
            self._restore_selection(state, selected.items, before)
        self._recorded(edits, verb, text, gesture)
        return selected

    def _restore_selection(self, state: SelectionState, selected: tuple[Item, ...], before: Project) -> None:
        found = [item for item in state.items if self._project.get(*item) is not None and self._may_be_seen(item)]
        if any(before.get(*item) is None for item in found):
            self.selection.set(*found)
        elif self.selection.items != selected:
            self.selection.set(*dict.fromkeys((*self.selection.items, *found)))
        self.keys.restore(state.keys, before)

    def _show(self, edits: tuple[Edit, ...]) -> None:
        before, playhead = stage_span(self._project), self.playhead
        whole = before is None or (before.first, before.last) == (playhead.first, playhead.last)
        self._project = with_edits_applied(self._project, edits)
        self._revision += 1
        gone = {edit.item for edit in edits if edit.new is None}
        self.selection.set(*(item for item in self.selection.items if item not in gone and self._may_be_seen(item)))
        after = stage_span(self._project)
        new = before is None or after is None or after.frame_rate != before.frame_rate
        left = after is not None and (playhead.last < after.first or playhead.first > after.last)
        if after != before and (whole or new or left):
            self._fit_playhead()
        for collection, ids in groupby(dict.fromkeys(edit.item for edit in edits), key=itemgetter(0)):
            changed = [entity_id for _, entity_id in ids]
            for entity_id in changed if len(changed) <= MANY_EDITS else [""]:
                self.entity_changed.emit(collection, entity_id)

    def _may_be_seen(self, item: Item) -> bool:
        """True if an item may be selected: constraints, contacts and clips only if their motion is on the stage, states
        and transitions only while their behaviour has them.
        """
        if item[0] in ("clips", "states", "transitions") and self._project.get(*item) is None:
            return False
        motion_id = getattr(self._project.get(*item), "motion_id", None)
        playing = (performer for performer in self._project.performers.values() if performer.visible)
        return motion_id is None or any(clip.motion_id == motion_id for each in playing for clip in each.all_clips)

    def _fit_playhead(self) -> None:
        """Set frame rate and play range to those of the stage; an empty stage changes nothing."""
        span = stage_span(self._project)
        if span is not None:
            self.playhead.frame_rate = span.frame_rate
            self.playhead.set_range(span.first, span.last)
            if not span.first <= self.playhead.frame <= span.last:
                self.playhead.set_frame(span.first)


def _objection(project: Project, constraint_id: str) -> str | None:
    """Sentence why a constraint conflicts with others of its motion; None if it does not, or the entity is no
    constraint.
    """
    constraint = project.constraints.get(constraint_id)
    if constraint is None:
        return None
    return objection(constraint, [each for key, each in project.constraints.items() if key != constraint_id])


def _empty(stack: QUndoStack) -> None:
    if isValid(stack):
        stack.blockSignals(True)
        stack.clear()
