"""Form of a clip: frame range, start, speed and placement; for a layer also its body region and blending."""

import math
from collections.abc import Callable
from functools import partial

from PySide6.QtCore import QSignalBlocker
from PySide6.QtWidgets import QCheckBox, QHBoxLayout, QWidget

from studio.core.changed_records import with_fields
from studio.core.curves.keyed import KeyedNumber
from studio.core.curves.retiming import FASTEST_CLIP_SPEED, SLOWEST_CLIP_SPEED, Speed, speed_at
from studio.core.errors import StudioError
from studio.core.mesh.hand_shapes import FIST_GRIP, HALF_CLOSED_GRIP, OPEN_GRIP, RELAXED_GRIP
from studio.core.stage.clip import MOST_CLIP_REPEATS, Clip
from studio.core.stage.clip_row import ClipEdit, players_of, with_first_frame, with_last_frame
from studio.document import clip_edits
from studio.document.document import Document
from studio.document.mnemonics import escaped_mnemonics
from studio.engine.live_interface import Live
from studio.panels.editor import Editor
from studio.panels.fields import Choice, NumberField, Section, check_box, elided_name, press_button, styled_label
from studio.panels.layer_section import LayerSection

CLIP_OFFSET_LIMIT = 1000.0
CLIP_TIME_LIMIT = 100_000.0
GRIP_CHOICES = (
    (None, "From character"),
    (OPEN_GRIP, "Open"),
    (RELAXED_GRIP, "Relaxed"),
    (HALF_CLOSED_GRIP, "Half closed"),
    (FIST_GRIP, "Fists"),
)


class ClipEditor(Editor[Clip]):
    """Form of a clip; an edit applies to all performers that play the clip."""

    def __init__(self, document: Document, live: Live, collection: str, entity_id: str) -> None:
        super().__init__(document, live, collection, entity_id)
        self.column.addWidget(self._playing())
        self._place = self._placing()
        self.column.addWidget(self._place)
        self._layer = LayerSection(self)
        self.column.addWidget(self._layer)
        self.finish()

    def _playing(self) -> Section:
        section = Section("Clip")
        self._motion, self._players = styled_label("", "value"), styled_label("", "value")
        self._players.setWordWrap(True)
        section.add_row("Capture", self._motion)
        section.add_row("Used by", self._players)
        self._own = press_button("", self._make_own)
        self._own.setToolTip(
            "Shared: edits affect every character that plays this clip. Make it unique to edit it separately."
        )
        section.add_wide(self._own)
        self._start = self._number(
            NumberField("Start", "s", -CLIP_TIME_LIMIT, CLIP_TIME_LIMIT, 0.05, 3), "Move", start=1.0
        )
        section.add_row("Start", self._start)
        self._first = self.bind(NumberField("First frame", "", 0, 1e6, 1, 0), self._set_first)
        self._last = self.bind(NumberField("Last frame", "", 0, 1e6, 1, 0), self._set_last)
        section.add_row("Frame range", self._first, self._last)
        self._speed = self.bind(
            NumberField("Speed", "×", SLOWEST_CLIP_SPEED, FASTEST_CLIP_SPEED, 0.05), self._set_speed
        )
        self._keyed = self._box("keyed", self._set_keyed)
        self._keyed.setToolTip("Animate speed: set keys here or with S; edit them in the curve editor")
        section.add_row("Speed", self._speed, self._keyed)
        self._repeats = self.bind(NumberField("Loop count", "", 1, MOST_CLIP_REPEATS, 1, 0), self._set_repeats)
        section.add_row("Loop count", self._repeats)
        self._mirrored = self._box("Mirror left/right", self._set_mirrored)
        section.add_row("Mirror", self._mirrored)
        self._grip = Choice("Hands", GRIP_CHOICES)
        self._grip.setToolTip(
            "Pose of the hands while the clip plays. From character: the captured fingers, else those of the character"
        )
        self._grip.value_chosen.connect(lambda grip: self._set("Set hands of", grip=grip))
        section.add_row("Hands", self._grip)
        section.add_wide(self._buttons())
        return section

    def _placing(self) -> Section:
        section = Section("Placement")
        self._joined = self._box("Match previous clip", lambda on: self._set("Match previous clip:", joined=on))
        section.add_row("Alignment", self._joined)
        turn = NumberField("Rotation", "°", -360.0, 360.0, 1.0, 1)
        self._turn = self._number(turn, "Rotate", turn=math.radians(1.0))
        section.add_row("Rotation", self._turn)
        self._offset = [
            self.bind(
                NumberField(f"Offset {axis}", "", -CLIP_OFFSET_LIMIT, CLIP_OFFSET_LIMIT, 0.01), partial(self._move, k)
            )
            for k, axis in enumerate("XY")
        ]
        for field in self._offset:
            field.setToolTip("In leg lengths, so that it scales with each character. Drag sideways to change.")
        section.add_row("Offset (legs)", *self._offset)
        self._ease = self._number(NumberField("Blend time", "s", 0.0, 60.0, 0.05), "Set blend time of", ease=1.0)
        self._ease.setSpecialValueText("automatic")
        section.add_row("Blend", self._ease)
        section.add_wide(styled_label("Where clips overlap, a line in the bar marks the transition.", "hint"))
        return section

    def _buttons(self) -> QWidget:
        buttons = QWidget()
        row = QHBoxLayout(buttons)
        row.setContentsMargins(0, 4, 0, 0)
        row.setSpacing(4)
        for text, run in (("Split at playhead", self._split), ("Duplicate", self._duplicate)):
            row.addWidget(press_button(text, run), 1)
        return buttons

    def _box(self, text: str, put: Callable[[bool], None]) -> QCheckBox:
        box = check_box(text)
        box.toggled.connect(put)
        return box

    def _number(self, field: NumberField, verb: str, **unit: float) -> NumberField:
        """Bind ``field`` to the clip's value named in ``unit``, for example ``turn=math.radians(1.0)`` for a field in
        degrees.
        """
        [(name, size)] = unit.items()
        return self.bind(field, lambda number: self._set(verb, **{name: number * size}))

    def refresh(self) -> None:
        """Update all fields from the document."""
        clip: Clip | None = self.entity
        if clip is None:
            return
        project = self.document.project
        self._layer.refresh()
        self._place.setVisible(clip_edits.layer_of(project, self.entity_id) is None)
        self._motion.setText(clip_edits.name_of(project, clip))
        players = players_of(project, clip.id)
        self._players.setText(", ".join(each.name for each in players.values()))
        active = players.get(self.document.active_performer_id or "")
        self._own.setVisible(len(players) > 1 and active is not None)
        self._own.setText(escaped_mnemonics(f"Make unique for {elided_name(active.name, self._own)}") if active else "")
        shown = {
            self._start: clip.start, self._first: clip.first, self._last: clip.last, self._speed: self._speed_of(clip),
            self._repeats: clip.repeats, self._turn: math.degrees(clip.turn), self._ease: clip.ease,
            self._offset[0]: clip.offset[0], self._offset[1]: clip.offset[1],
        }  # fmt: skip
        for field, value in shown.items():
            field.show_value(value)
        keyed = isinstance(clip.speed, KeyedNumber)
        for box, on in ((self._mirrored, clip.mirrored), (self._joined, clip.joined), (self._keyed, keyed)):
            with QSignalBlocker(box):
                box.setChecked(on)
        self._grip.show_value(clip.grip)

    def depends_on(self, collection: str, entity_id: str) -> bool:
        """True for the clip itself, for performers, which play it, and for motions, whose names the form shows."""
        return collection in ("performers", "motions")

    def _edit(self, edit: ClipEdit, verb: str) -> None:
        self._edit_each(lambda key, text: clip_edits.edit_clip(self.document, key, edit, text), verb)

    def _edit_each(self, edit: Callable[[str, str], None], verb: str) -> None:
        """Call ``edit`` with the id of each selected clip and the undo text, as one undo step."""
        text = f"{verb} {clip_edits.name_of(self.document.project, self.entity)}"

        def edit_all() -> None:
            with self.document.group(text, self._gesture):
                for key in self.edited_ids:
                    edit(key, text)

        self._say(edit_all)

    def _set_mirrored(self, mirrored: bool) -> None:
        self._edit_each(lambda key, _: clip_edits.set_mirrored(self.document, key, mirrored), "Mirror")

    def _set(self, verb: str, **values: object) -> None:
        self._edit(lambda clip: (with_fields(clip, **values),), verb)

    def _time_of(self, clip: Clip) -> float:
        """Time of the playhead in seconds of the clip's motion, rounded to a whole frame within the clip."""
        rate = self.document.project.frame_rate_of(clip)
        frame = round(float(clip.motion_seconds(self.document.playhead.time, rate)) * rate)
        return min(max(frame, clip.first), clip.last) / rate

    def _speed_of(self, clip: Clip) -> float:
        return float(speed_at(clip.speed, self._time_of(clip)))

    def _set_speed(self, number: float) -> None:
        """Set the speed: constant, or as a key at the playhead if it is keyed."""
        self._change_speed(
            lambda clip: (
                clip.speed.with_key(self._time_of(clip), number) if isinstance(clip.speed, KeyedNumber) else number
            ),
            "Set",
        )

    def _set_keyed(self, on: bool) -> None:
        """Key the speed at the playhead; or, if ``on`` is False, make its current value constant."""
        self._change_speed(
            lambda clip: KeyedNumber((self._time_of(clip),), (self._speed_of(clip),)) if on else self._speed_of(clip),
            "Key" if on else "Delete keys of the",
        )

    def _change_speed(self, change: Callable[[Clip], Speed], verb: str) -> None:
        project, document, before = self.document.project, self.document, self.entity
        text, shown = f"{verb} speed of {clip_edits.name_of(project, self.entity)}", self._time_of(self.entity)

        def edit_all() -> None:
            with document.group(text, self._gesture):
                for key in self.edited_ids:
                    clip_edits.set_speed(document, key, change(document.project.clips[key]), text)
            changed, time = document.project.clips[self.entity_id], document.playhead.time
            rate = document.project.frame_rate_of(changed)
            if isinstance(changed.speed, KeyedNumber) and before.start <= time <= before.start + before.length(rate):
                document.playhead.set_time(float(changed.stage_seconds(shown, rate)))  # the key stays under it

        self._say(edit_all)

    def _set_first(self, frame: float) -> None:
        project = self.document.project
        self._edit(lambda clip: (with_first_frame(clip, project.frame_rate_of(clip), round(frame)),), "Trim")

    def _set_last(self, frame: float) -> None:
        project = self.document.project

        def ended(clip: Clip) -> tuple[Clip, ...]:
            count = project.captures[project.motions[clip.motion_id].capture_id].frame_count
            return (with_last_frame(clip, round(frame), count),)

        self._edit(ended, "Trim")

    def _set_repeats(self, times: float) -> None:
        self._set("Loop", repeats=round(times))

    def _move(self, axis: int, way: float) -> None:
        offset = list(self.entity.offset)
        offset[axis] = way
        self._set("Move", offset=tuple(offset))

    def _make_own(self) -> None:
        performer_id = self.document.active_performer_id
        if performer_id is not None:
            self._select(lambda: clip_edits.detach_clip(self.document, performer_id, self.entity_id))

    def _split(self) -> None:
        self._select(lambda: clip_edits.split_clip(self.document, self.entity_id, self.document.playhead.time))

    def _duplicate(self) -> None:
        self._select(lambda: clip_edits.duplicate_clip(self.document, self.entity_id))

    def _select(self, make: Callable[[], str]) -> None:
        """Call ``make`` and select the clip whose id it returns, together with the active performer."""
        performer_id = self.document.active_performer_id or ""
        self._say(lambda: self.document.selection.set(("performers", performer_id), ("clips", make())))

    def _say(self, run: Callable[[], object]) -> None:
        try:
            run()
        except StudioError as error:
            self.document.problem_reported.emit(str(error))
            self.refresh()
