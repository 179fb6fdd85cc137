"""Form rows of a target and its keys: fixed, keyed, procedural, or following an object."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, cast

import numpy as np

from studio.core.body.canonical import BodyPart
from studio.core.captures.capture import Capture
from studio.core.changed_records import with_fields
from studio.core.constraints.base import BodyPoint, Constraint
from studio.core.constraints.follow import Follow, FollowBody, FollowPerformer, FollowProp, FollowTracked
from studio.core.constraints.own_place import KeyedOwnPlace, OwnPlace
from studio.core.constraints.procedural import ProceduralPlace
from studio.core.constraints.target import Place, Turn, own_place_of, with_own_place
from studio.core.curves.keyed import KeyedNumber, KeyedPlace, KeyedTurn, Keys
from studio.document.channels import allowed_value_at
from studio.document.keyed_fields import KeyedField
from studio.document.mnemonics import escaped_mnemonics
from studio.engine.point_names import POINT_NAMES, point_words
from studio.engine.posed_performer import motion_time, stage_time
from studio.engine.target_context import TargetContext
from studio.panels.constraint_editors.present import current_context
from studio.panels.constraint_editors.procedural_rows import PROCEDURAL_KINDS, ProceduralRows, ruled_position
from studio.panels.editor import Editor, NamedEntity
from studio.panels.fields import Choice, Section, check_box, elided_name, press_button, styled_label

FIXED_KIND, KEYED_KIND = "fixed", Keys.kind
PER_CHARACTER_KIND = OwnPlace.kind
PLACE_KINDS = (
    (PER_CHARACTER_KIND, "Per character"),
    (FIXED_KIND, "Fixed"),
    (KEYED_KIND, "Animated"),
    *PROCEDURAL_KINDS,
    (FollowBody.kind, "Follow own body"),
    (FollowPerformer.kind, "Follow character"),
    (FollowProp.kind, "Follow prop"),
    (FollowTracked.kind, "Follow source"),
)
ATTACHMENT_POINTS = (
    ((0.0, 0.0, 0.0), "Centre"),
    ((0.0, 1.0, 0.0), "Left side"),
    ((0.0, -1.0, 0.0), "Right side"),
    ((1.0, 0.0, 0.0), "Front"),
    ((-1.0, 0.0, 0.0), "Back"),
    ((0.0, 0.0, 1.0), "Top"),
    ((0.0, 0.0, -1.0), "Bottom"),
)
POSITION_ONLY_KINDS = (PLACE_KINDS[0], *PROCEDURAL_KINDS)
"""Kinds of target that are available for positions but not for rotations."""
SIGN_BUTTON_PX = 30
"""Width in pixels of a button with a single sign."""
WRIST_POINTS = (BodyPoint(BodyPart.RIGHT_FOREARM, at_end=True), BodyPoint(BodyPart.LEFT_FOREARM, at_end=True))


class TargetRows:
    """Form rows for the kind of target in an entity's value ``field``; the form shows the target's numbers in another
    row.
    """

    def __init__(self, editor: Editor[Constraint], section: Section, field: str, turns: bool = False) -> None:
        self._editor, self._field, self._turns = editor, field, turns
        self._kind = Choice(
            "Target type", [kind for kind in PLACE_KINDS if not turns or kind not in POSITION_ONLY_KINDS]
        )
        self._kind.value_chosen.connect(self._choose)
        self._kind_caption = section.add_row("Target type", self._kind)
        self._thing = Choice("Follows", ())
        self._thing.value_chosen.connect(self._choose_thing)
        self._thing_caption = section.add_row("Follows", self._thing)
        self._point = Choice("Followed point", [(point, name.capitalize()) for point, name in POINT_NAMES.items()])
        self._point.value_chosen.connect(self._choose_point)
        self._point_caption = section.add_row("Followed point", self._point)
        self._spot = Choice("Position on the prop", ATTACHMENT_POINTS)
        self._spot.setToolTip("Attachment point on the prop, at any size; the offset is relative to it.")
        self._spot.value_chosen.connect(self._choose_spot)
        self._spot_caption = section.add_row("Attach at", self._spot)
        self._awaits = check_box("Anticipate target")
        self._awaits.setToolTip(
            "The point goes to where the target will be when the constraint is fully active, instead of chasing it."
        )
        self._awaits.clicked.connect(lambda on: self._change(replace(self.target, awaits=on), "Anticipate target"))
        self._awaits_caption = section.add_row("Anticipation", self._awaits)
        self._each = check_box("Each character")
        self._each.setAccessibleName("Relative to each character")
        self._each.setToolTip("Relative to the position on each character, instead of one position for all.")
        self._each.clicked.connect(self._set_each)
        self._each_caption = section.add_row("Relative to", self._each)
        self._apart = check_box()
        self._apart.setToolTip("The handle then moves the target of this character only.")
        self._apart.clicked.connect(self._set_apart)
        self._apart_caption = section.add_row("Offset", self._apart)
        self._rule = ProceduralRows(editor, section, field)
        self._keys = KeyRow(editor, section, field)

    @property
    def target(self) -> Any:
        """Current value of the field."""
        return getattr(self._editor.entity, self._field)

    def current_numbers(self) -> Any:
        """Position or rotation of the target at the playhead; None if it is not solved yet."""
        if isinstance(self.target, tuple):
            return self.target
        moment = current_context(self._editor)
        fixed = moment.with_targets_fixed(self._editor.entity) if moment else None
        return getattr(fixed, self._field, None)

    def set_numbers(self, numbers: Any, text: str) -> None:
        """Move the target to ``numbers``: as a fixed value, as a key at the playhead, as the centre of a procedural
        target, or as an offset from the followed object.
        """
        editor, moment = self._editor, current_context(self._editor)
        if isinstance(self.target, tuple) or moment is None:
            editor.change(text, **{self._field: numbers})
        elif self._turns:
            editor.replace_entity(lambda: moment.with_target_rotation(editor.entity, numbers), text)
        else:
            editor.replace_entity(lambda: moment.with_target_moved(editor.entity, numbers), text)

    def refresh(self) -> None:
        """Show the kind of target and its rows; hidden if the value is not a target."""
        target = self.target
        kind = _kind_of(target)
        known = kind in dict(PLACE_KINDS)
        things = self._things(str(kind)) if known else ()
        self._kind.show_value(kind)
        for widget in (self._kind, self._kind_caption):
            widget.setVisible(known)
        for widget in (self._thing, self._thing_caption):
            widget.setVisible(bool(things))
        self._thing.offer(things)
        self._thing.show_value(next((getattr(target, name) for name in _THINGS if hasattr(target, name)), None))
        point = getattr(target, "point", None) if isinstance(target, Follow) else None
        for widget in (self._point, self._point_caption):
            widget.setVisible(point is not None)
        if point is not None:
            if not self._point.offers((point.part, point.at_end)):
                self._point.add((point.part, point.at_end), point_words(point).capitalize())
            self._point.show_value((point.part, point.at_end))
        for row in (self._spot, self._spot_caption):
            row.setVisible(isinstance(target, FollowProp) and not self._turns)
        if isinstance(target, FollowProp):
            self._spot.show_value(target.share)
        self._awaits.setVisible(isinstance(target, FollowPerformer))
        self._awaits_caption.setVisible(isinstance(target, FollowPerformer))
        self._awaits.setChecked(isinstance(target, FollowPerformer) and target.awaits)
        counts = isinstance(target, KeyedPlace | KeyedOwnPlace | ProceduralPlace)
        self._each.setVisible(counts)
        self._each_caption.setVisible(counts)
        self._each.setChecked(own_place_of(target) is not None)
        self._show_apart(target)
        self._rule.refresh()
        self._keys.refresh(known)

    def _show_apart(self, target: Place) -> None:
        """Show a checkbox for the offset of the active character, if targets are per character; it is ticked if that
        character has an offset.
        """
        document = self._editor.document
        performer = document.project.performers.get(document.active_performer_id or "")
        own = own_place_of(target)
        shown = own is not None and performer is not None
        for widget in (self._apart, self._apart_caption):
            widget.setVisible(shown)
        if own is not None and performer is not None:
            self._apart.setText(escaped_mnemonics(f"Unique for {elided_name(performer.name, self._apart)}"))
            self._apart.setAccessibleName(f"Offset unique for {performer.name}")
            self._apart.setChecked(document.active_performer_id in dict(own.own))

    def _set_apart(self, apart: bool) -> None:
        editor, performer_id = self._editor, self._editor.document.active_performer_id or ""
        name = editor.document.project.performers[performer_id].name
        text = f"{'Unique' if apart else 'Shared'} offset for {name}"
        own = own_place_of(self.target)
        if own is not None:
            self._change(with_own_place(self.target, own.with_own(performer_id, (0.0,) * 3 if apart else None)), text)

    def _set_each(self, each: bool) -> None:
        """Make a keyed or procedural target relative to each character's own position, or shared by all."""
        editor = self._editor
        text = f"{'Per character' if each else 'Fixed'}: {editor.entity.name}"
        editor.replace_entity(lambda: with_fields(editor.entity, **{self._field: self._counted(each)}), text)

    def _counted(self, each: bool) -> KeyedPlace | KeyedOwnPlace | ProceduralPlace:
        """Keyed or procedural target, per character or shared, that is where it was on the active character."""
        target, now, moment = self.target, self._known_now(), self._known_moment()
        seconds, leg_length = moment.pose.seconds, moment.pose.motion.body.leg_length
        here = target.at([seconds])[0]
        if isinstance(target, ProceduralPlace):
            if not each:
                return replace(target, origin=None).passing(now, seconds)
            x, y, z = (np.array(target.centre) - here).tolist()
            return replace(target, centre=(x, y, z), origin=self._own_place(now))
        scale = 1.0 / leg_length if each else leg_length
        points = (0.0 if each else np.array(now)) + scale * (target.points - here)
        keys = replace(target.with_rates(lambda rate: scale * rate), values=tuple(map(tuple, points.tolist())))
        parts = {name: getattr(keys, name) for name in ("times", "values", "tangents", "before", "after")}
        return KeyedOwnPlace(**parts, origin=self._own_place(now)) if each else KeyedPlace(**parts)

    def _things(self, kind: str) -> Sequence[tuple[object, str]]:
        """Ids and names of the objects or joints that a kind of target can follow."""
        project = self._editor.document.project
        match kind:
            case FollowPerformer.kind:
                followed = getattr(self.target, "performer_id", None)
                performers = project.performers.items()
                return [(key, each.name) for key, each in performers if each.visible or key == followed]
            case FollowProp.kind:
                return [(key, each.name) for key, each in project.props.items()]
            case FollowTracked.kind:
                return [(name, name) for name in self._capture().skeleton.names]
        return ()

    def _capture(self) -> Capture:
        project = self._editor.document.project
        return project.captures[project.motions[self._editor.entity.motion_id].capture_id]

    def _choose(self, kind: str) -> None:
        if kind == _kind_of(self.target):
            return
        editor, things = self._editor, self._things(kind)
        if kind in (FollowProp.kind, FollowPerformer.kind) and not things:
            editor.document.problem_reported.emit(
                "There is no prop on the stage. Add one with Prop > Add box, then choose it."
            )
            self.refresh()
            return
        text = f"{dict(PLACE_KINDS)[kind]}: {editor.entity.name}"
        editor.replace_entity(lambda: with_fields(editor.entity, **{self._field: self._first(kind, things)}), text)

    def _first(self, kind: str, things: Sequence[tuple[Any, str]]) -> Place | Turn:
        """New target of another kind, at the current position of the old one if possible."""
        editor, point, now = self._editor, self._editor.entity.point, self.current_numbers()
        moment = current_context(editor)
        match kind:
            case FollowBody.kind:
                return FollowBody(next(wrist for wrist in WRIST_POINTS if wrist.part != point.part))
            case FollowPerformer.kind:
                others = [key for key, _ in things if key != editor.document.active_performer_id]
                return FollowPerformer((others or [things[0][0]])[0], point)
            case FollowProp.kind:
                return self._attached(FollowProp(things[0][0]), now, moment)
            case FollowTracked.kind:
                capture = self._capture()
                parts = capture.body_map.parts if capture.body_map else {}
                return FollowTracked(capture.skeleton.names[parts.get(point.part, 0)])
        now = self._known_now()
        if kind == FIXED_KIND:
            return cast(Place | Turn, now)
        if kind == PER_CHARACTER_KIND:
            return self._own_place(now)
        origin = self._own_place(now) if self._is_per_character else None
        if kind in dict(PROCEDURAL_KINDS):
            return (
                ruled_position(kind, _full(now))
                if origin is None
                else replace(ruled_position(kind, (0.0, 0.0, 0.0)), origin=origin)
            )
        seconds = self._known_moment().pose.seconds
        if origin is not None:
            return origin.keyed(seconds)
        return (KeyedTurn if self._turns else KeyedPlace)((seconds,), (_full(now),))

    @property
    def _is_per_character(self) -> bool:
        """True if the target's position differs between characters, so that a new target must too."""
        return not self._turns and (own_place_of(self.target) is not None or isinstance(self.target, FollowBody))

    def _known_now(self) -> Any:
        now = self.current_numbers()
        if now is None:
            raise ValueError("The target is not solved yet. Wait until the character is adapted.")
        return now

    def _known_moment(self) -> TargetContext:
        moment = current_context(self._editor)
        if moment is None:
            raise ValueError("A key needs a clip: add one to a character first.")
        return moment

    def _own_place(self, now: tuple[float, ...]) -> OwnPlace:
        """Per-character position that is at ``now`` on the active character; the current one if the target is one.

        A new one is relative to the followed body point at the playhead; else to the constrained point there, or at the
        nearest time of full activation.
        """
        target, moment, curve = self.target, self._known_moment(), self._editor.entity.activation
        if isinstance(target, OwnPlace):
            return target
        if isinstance(target, KeyedOwnPlace):
            return target.own_at(moment.pose.seconds)
        point, seconds = self._editor.entity.point, min(max(moment.pose.seconds, curve.full), curve.full_end)
        if isinstance(target, FollowBody):
            point, seconds = target.point, moment.pose.seconds
        own = moment.own_place(point, _full(now), seconds)
        if own is None:
            raise ValueError("The position on each character is not solved yet. Wait until the characters are adapted.")
        return own

    def _attached(self, follow: FollowProp, now: Any, moment: TargetContext | None) -> Place | Turn:
        """Target ``follow`` with the offset at which it is at ``now`` at the playhead."""
        if now is None or moment is None:
            return follow
        held = with_fields(self._editor.entity, **{self._field: follow})
        moved = moment.with_target_rotation(held, now) if self._turns else moment.with_target_moved(held, _full(now))
        result: Place | Turn = getattr(moved, self._field)
        return result

    def _choose_thing(self, thing: str) -> None:
        name = next(name for name in _THINGS if hasattr(self.target, name))
        self._change(with_fields(self.target, **{name: thing}), "Set follow target")

    def _choose_point(self, choice: tuple[BodyPart, bool]) -> None:
        self._change(replace(self.target, point=BodyPoint(choice[0], at_end=choice[1])), "Set followed point")

    def _choose_spot(self, share: tuple[float, float, float]) -> None:
        self._change(replace(self.target, share=share, offset=(0.0, 0.0, 0.0)), "Set position on the prop")

    def _change(self, target: Place | Turn, text: str) -> None:
        self._editor.change(f"{text}: {self._editor.entity.name}", **{self._field: target})


class KeyRow:
    """Form row with the number of the key at the playhead, and buttons to go to the next key, set and delete one."""

    def __init__(self, editor: Editor[NamedEntity], section: Section, field: str) -> None:
        self._editor, self._field = editor, field
        self._words = styled_label("", "value")
        self._words.setAccessibleName("Keys")
        self._buttons = [
            press_button("‹", lambda: self._go(-1)),
            press_button("›", lambda: self._go(1)),
            press_button("+", self._set),
            press_button("−", self._delete),
        ]
        for button, name in zip(self._buttons, ("Previous key", "Next key", "Set key", "Delete key"), strict=True):
            button.setAccessibleName(name)
            button.setToolTip(f"{name} at the playhead" if name in ("Set key", "Delete key") else name)
            button.setFixedWidth(SIGN_BUTTON_PX)
        self._caption = section.add_row("Keys", self._words, *self._buttons)

    def refresh(self, known: bool = True) -> None:
        """Show the keys; the row is hidden if the value has none."""
        keyed = self._keyed() if known else None
        for widget in (self._caption, self._words, *self._buttons):
            widget.setVisible(keyed is not None)
        if keyed is not None:
            place = keyed.key_at(self._seconds())
            count = len(keyed.times)
            self._words.setText(f"{count}" if place is None else f"{place + 1} of {count}")
            self._buttons[3].setEnabled(place is not None and count > 1)

    def _keyed(self) -> Any:
        value = getattr(self._editor.entity, self._field)
        return value if isinstance(value, Keys) else None

    @property
    def now(self) -> float:
        """Time of the playhead in seconds of the keys' own time."""
        return self._seconds()

    def _seconds(self) -> float:
        """Time of the playhead in seconds of the constraint's motion."""
        document = self._editor.document
        clip = document.active_clip
        if clip is None:
            return document.playhead.time
        rate = document.project.frame_rate_of(clip)
        return round(motion_time(clip, rate, document.playhead.time) * rate) / rate

    def _go(self, step: int) -> None:
        keyed, now = self._keyed(), self._seconds()
        ahead = [time for time in keyed.times if (time - now) * step > 1e-4]
        if ahead:
            self._editor.document.playhead.pause()
            self._show_time(min(ahead, key=lambda each: abs(each - now)))

    def _show_time(self, seconds: float) -> None:
        """Move the playhead to a time of the constraint's motion."""
        document = self._editor.document
        clip = document.active_clip
        if clip is not None:
            document.playhead.set_time(stage_time(clip, document.project.frame_rate_of(clip), seconds))

    def _set(self) -> None:
        """Set a key with the current value at the playhead."""
        keyed, now = self._keyed(), self._seconds()
        field = KeyedField(self._editor.collection, self._editor.entity_id, self._field)
        self._change(keyed.with_key(now, allowed_value_at(field, keyed, now)), "Set key of")

    def _delete(self) -> None:
        place = self._keyed().key_at(self._seconds())
        if place is not None:
            self._change(self._keyed().without_key(place), "Delete key of")

    def _change(self, value: Any, text: str) -> None:
        self._editor.change(f"{text} {self._editor.entity.name}", **{self._field: value})


class NumberRows:
    """Form rows of a number that may be keyed: a checkbox that keys it, and its keys."""

    def __init__(self, editor: Editor[NamedEntity], section: Section, field: str) -> None:
        self._editor, self._field = editor, field
        self.keyed = check_box("keyed")
        self.keyed.setAccessibleName(f"{field.capitalize()} is animated")
        self.keyed.clicked.connect(self._toggle)
        self._keys = KeyRow(editor, section, field)

    def refresh(self, shown: bool = True) -> None:
        """Show if the number is keyed, and its keys; ``shown`` False hides the rows."""
        value = getattr(self._editor.entity, self._field)
        self.keyed.setVisible(shown)
        self.keyed.setChecked(isinstance(value, KeyedNumber))
        self._keys.refresh(shown)

    @property
    def current_number(self) -> float:
        """Value of the number at the playhead."""
        value = getattr(self._editor.entity, self._field)
        if not isinstance(value, KeyedNumber):
            return float(value)
        field = KeyedField(self._editor.collection, self._editor.entity_id, self._field)
        return float(allowed_value_at(field, value, self._keys.now))

    def set_number(self, number: float, text: str) -> None:
        """Set the number: constant, or as a key at the playhead if it is keyed."""
        value = getattr(self._editor.entity, self._field)
        new = value.with_key(self._keys.now, number) if isinstance(value, KeyedNumber) else number
        self._editor.change(text, **{self._field: new})

    def _toggle(self, keyed: bool) -> None:
        value = KeyedNumber((self._keys.now,), (self.current_number,)) if keyed else self.current_number
        text = f"{'Key' if keyed else 'Delete keys of the'} {self._field} of {self._editor.entity.name}"
        self._editor.change(text, **{self._field: value})


def _kind_of(target: object) -> str | None:
    """Key of a target in ``PLACE_KINDS``; None if the value is not a target."""
    if isinstance(target, KeyedOwnPlace):
        return KEYED_KIND
    return getattr(target, "kind", FIXED_KIND if isinstance(target, tuple) else None)


_THINGS = ("performer_id", "prop_id", "joint")


def _full(numbers: Sequence[float]) -> Any:
    """Position (x, y, z); a ground position (x, y) gets height 0, a rotation is unchanged."""
    return (*numbers, 0.0) if len(numbers) == 2 else numbers
