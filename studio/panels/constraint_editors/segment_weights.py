"""Weights of single segments in the IK chain, which override those of their group."""

from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import partial

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QGridLayout, QLabel, QPushButton, QWidget

from studio.core.body.canonical import BodyPart
from studio.core.constraints.base import (
    LIMB_BONE_PARTS,
    THIGHS,
    UPPER_ARMS,
    WEIGHTED_PARTS,
    BodyPoint,
    Chain,
    Constraint,
    limb_bones,
)
from studio.panels.editor import Editor
from studio.panels.fields import Choice, NumberField, press_button, styled_label


def weight_field(name: str) -> NumberField:
    """Number field from 0 (locked) to 1 (free)."""
    field = NumberField(name, "", 0.0, 1.0, 0.05, 2)
    field.setFixedWidth(56)
    field.setAlignment(Qt.AlignmentFlag.AlignRight)
    return field


def weightable_parts(constraint: Constraint) -> tuple[BodyPart, ...]:
    """Segments whose weights can be overridden: those of the limbs at the constraint's points; for a balance constraint
    all that it can rotate.
    """
    other = getattr(constraint, "other", None)
    points = (constraint.point, other) if isinstance(other, BodyPoint) else (constraint.point,)
    bones = [bone for each in points for bone in limb_bones(each.part)]
    if constraint.kind == "balance":
        bones = [*UPPER_ARMS, *THIGHS]
    return (*(part for part in WEIGHTED_PARTS if part not in LIMB_BONE_PARTS), *dict.fromkeys(bones))


class SegmentWeights(QWidget):
    """Row for each overridden weight, and a list of the segments that can be added."""

    def __init__(self, editor: Editor[Constraint]) -> None:
        super().__init__()
        self._editor = editor
        self._rows: dict[BodyPart, tuple[QLabel, NumberField, QPushButton]] = {}
        grid = QGridLayout(self)
        grid.setContentsMargins(0, 4, 0, 0)
        grid.setHorizontalSpacing(8)
        grid.setVerticalSpacing(2)
        grid.setColumnStretch(0, 1)
        for index, part in enumerate(WEIGHTED_PARTS):
            field = self._editor.bind(weight_field(f"Weight override of {part.label}"), partial(self.put, part))
            remove = press_button("−", partial(self._remove, part))
            remove.setAccessibleName(f"Remove weight override of {part.label}")
            remove.setToolTip("Reset to group weight")
            remove.setFixedWidth(30)
            self._rows[part] = styled_label(part.label, "second"), field, remove
            for column, widget in enumerate(self._rows[part]):
                grid.addWidget(widget, index, column)
        self._add = Choice("Segment", ())
        self._add.setPlaceholderText("Add segment weight…")
        self._add.setToolTip("Override the weight of one segment. The abdomen is the spine below the chest.")
        self._add.value_chosen.connect(self._give)
        grid.addWidget(self._add, len(WEIGHTED_PARTS), 0, 1, 3)

    def refresh(self) -> None:
        """Update the weights."""
        own = dict(self._editor.entity.chain.segments)
        for part, row in self._rows.items():
            for widget in row:
                widget.setVisible(part in own)
            row[1].show_value(own.get(part, 0.0))
        left = [(part, part.label) for part in weightable_parts(self._editor.entity) if part not in own]
        self._add.offer(left)
        self._add.show_value(None)
        self._add.setVisible(bool(left))

    def put(self, part: BodyPart, weight: float) -> None:
        """Set the weight override of a segment as one undo step, or within the step of a drag."""
        self._change(
            lambda chain: ((part, weight) if each == part else (each, old) for each, old in chain.segments),
            f"Set weight of {part.label.lower()}",
        )

    def _give(self, part: BodyPart) -> None:
        balances = self._editor.entity.kind == "balance" and part in LIMB_BONE_PARTS
        self._change(
            lambda chain: (*chain.segments, (part, chain.recruited(part) if balances else chain.weight(part))),
            f"Override weight of {part.label.lower()}",
        )

    def _remove(self, part: BodyPart) -> None:
        self._change(
            lambda chain: (pair for pair in chain.segments if pair[0] != part),
            f"Remove weight override of {part.label.lower()}",
        )

    def _change(self, segments: Callable[[Chain], Iterable[tuple[BodyPart, float]]], text: str) -> None:
        editor = self._editor

        def made() -> Constraint:
            chain = editor.entity.chain
            return replace(editor.entity, chain=replace(chain, segments=tuple(segments(chain))))

        editor.replace_entity(made, f"{text} for {editor.entity.name}")
