"""Form of a correction layer: range, weight, order with the constraints, and the pose at the playhead."""

import math
from functools import partial

from PySide6.QtCore import QSignalBlocker
from PySide6.QtWidgets import QHBoxLayout, QWidget

from studio.core.body.canonical import BodyPart
from studio.core.stage.correction import Correction
from studio.document.correction_edits import mirror_correction, set_key, set_pose_of
from studio.document.document import Document
from studio.engine.live_interface import Live
from studio.panels.editor import Editor, EntityNameField
from studio.panels.fields import PER_CENT, Choice, NumberField, Section, check_box, press_button, styled_label

RANGE_FIELDS = ("Start", "Fade-in end", "Fade-out start", "End")
TURN_AXES = ("x", "y", "z")


class CorrectionEditor(Editor[Correction]):
    """Form of a correction layer."""

    def __init__(self, document: Document, live: Live, collection: str, entity_id: str) -> None:
        super().__init__(document, live, collection, entity_id)
        section = Section("Correction")
        mirror = press_button("Mirror", lambda: mirror_correction(document, self.entity_id), "link")
        mirror.setToolTip("Mirror the correction to the other side")
        section.head.addWidget(mirror)
        self._name = EntityNameField(self)
        section.add_row("Name", self._name)
        self._enabled = check_box("Enabled")
        self._enabled.toggled.connect(lambda on: self._change("Enable" if on else "Disable", enabled=on))
        section.add_row("State", self._enabled)
        self._above = Choice("Order", [(False, "Below constraints"), (True, "Above constraints")])
        self._above.setToolTip("Below: constraints and foot contacts still apply. Above: the pose is used as it is.")
        self._above.value_chosen.connect(lambda above: self._change("Reorder", above=above))
        section.add_row("Order", self._above)
        self._weight = self.bind(
            NumberField("Weight", "%", 0.0, PER_CENT, 1.0, 0),
            lambda number: self._change("Set weight of", weight=number / PER_CENT),
        )
        section.add_row("Weight", self._weight)
        self._range = [
            self.bind(NumberField(name, "s", -1e6, 1e6, 0.01, 3), partial(self._set_time, index))
            for index, name in enumerate(RANGE_FIELDS)
        ]
        section.add_row("Fade in (s)", *self._range[:2])
        section.add_row("Fade out (s)", *self._range[2:])
        self.column.addWidget(section)
        self._pose = Section("Pose at playhead")
        self._pose.head.addWidget(press_button("Set key", self._set_key, "link"))
        self._words = styled_label("", "hint")
        self._pose.add_wide(self._words)
        self.column.addWidget(self._pose)
        self._joints: QWidget | None = None
        self._shown_parts: tuple[BodyPart, ...] | None = None
        self._turns: dict[BodyPart, list[NumberField]] = {}
        self._hips: list[NumberField] = []
        document.playhead.changed.connect(self._show_pose)
        self.finish()

    def refresh(self) -> None:
        """Update the correction."""
        correction: Correction | None = self.entity
        if correction is None:
            return
        self._name.show_name()
        with QSignalBlocker(self._enabled):
            self._enabled.setChecked(correction.enabled)
        self._above.show_value(correction.above)
        self._weight.show_value(PER_CENT * correction.weight)
        for field, time in zip(self._range, correction.activation.times, strict=True):
            field.show_value(time)
        self._show_joints(correction)
        self._show_pose()

    def _show_joints(self, correction: Correction) -> None:
        """Show a row of three angles for each rotated part, and a row for the hips."""
        parts = (*correction.keys.parts, *((None,) if correction.keys.moves_hips else ()))
        if parts == self._shown_parts:
            return
        self._shown_parts = parts
        self._turns, self._hips = {}, []
        joints = Section("Joints")
        for part in correction.keys.parts:
            fields = [
                self.bind(
                    NumberField(f"{part.label} {axis}", "°", -720.0, 720.0, 1.0, 1),
                    partial(self._set_turn, part, index),
                )
                for index, axis in enumerate(TURN_AXES)
            ]
            self._turns[part] = fields
            joints.add_row(part.label, *fields)
            joints.add_wide(self._deletion(part))
        if correction.keys.moves_hips:
            self._hips = [
                self.bind(NumberField(f"Hips {axis}", "×", -10.0, 10.0, 0.01, 3), partial(self._set_hips, index))
                for index, axis in enumerate(("ahead", "left", "up"))
            ]
            joints.add_row("Hips", *self._hips)
        if self._joints is None:
            self.column.insertWidget(self.column.indexOf(self._pose) + 1, joints)
        else:
            self.column.replaceWidget(self._joints, joints)
            self._joints.hide()
            self._joints.deleteLater()
        self._joints = joints

    def _deletion(self, part: BodyPart) -> QWidget:
        holder = QWidget()
        row = QHBoxLayout(holder)
        row.setContentsMargins(0, 0, 0, 0)
        row.addStretch(1)
        button = press_button("Delete joint", lambda: self._delete(part), "link")
        button.setAccessibleName(f"Delete {part.label.lower()}")
        row.addWidget(button)
        return holder

    def _show_pose(self) -> None:
        correction: Correction | None = self.entity
        if correction is None:
            return
        time = self.document.playhead.time
        pose, count = correction.keys.value_at(time), len(correction.keys.times)
        at_key = correction.keys.key_at(time) is not None
        keys = "1 key" if count == 1 else f"{count} keys"
        where = "at a key" if at_key else "between keys" if count > 1 else "not at the playhead"
        self._words.setText(f"{keys}, {where}. Local rotations in degrees; x bends elbows and knees.")
        for part, fields in self._turns.items():
            for field, angle in zip(fields, pose.turn(part), strict=True):
                field.show_value(math.degrees(angle))
        for field, value in zip(self._hips, pose.hips, strict=False):
            field.show_value(value)

    def _change(self, verb: str, **values: object) -> None:
        self.change(f"{verb} {self.entity.name}", **values)

    def _set_time(self, index: int, time: float) -> None:
        """Set one of the four times of the range; the others are pushed along if necessary."""
        times = [*self.entity.activation.times]
        times[index] = time
        times[:index] = [min(each, time) for each in times[:index]]
        times[index + 1 :] = [max(each, time) for each in times[index + 1 :]]
        self._change("Set range of", activation=self.entity.activation.with_times(*times))

    def _set_turn(self, part: BodyPart, index: int, degrees: float) -> None:
        turn = [*self.entity.pose_at(self.document.playhead.time).turn(part)]
        turn[index] = math.radians(degrees)
        x, y, z = turn
        self._pose_by({part: (x, y, z)}, None)

    def _set_hips(self, index: int, value: float) -> None:
        hips = [*self.entity.pose_at(self.document.playhead.time).hips]
        hips[index] = value
        x, y, z = hips
        self._pose_by({}, (x, y, z))

    def _pose_by(
        self, turns: dict[BodyPart, tuple[float, float, float]], hips: tuple[float, float, float] | None
    ) -> None:
        with self._objections_told():
            set_pose_of(
                self.document, self.entity_id, self.document.playhead.time, turns, hips, self.gesture,
                f"Correct {self.entity.name}",
            )  # fmt: skip

    def _set_key(self) -> None:
        set_key(self.document, self.entity_id, self.document.playhead.time)

    def _delete(self, part: BodyPart) -> None:
        correction: Correction = self.entity
        left = correction.without_part(part)
        text = f"Delete {part.label.lower()} of {correction.name}"
        if left.keys.parts or left.keys.moves_hips:
            self.replace_entity(lambda: left, text)
        else:
            self.document.remove("corrections", self.entity_id, text)
