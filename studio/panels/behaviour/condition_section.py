"""Form section of one condition of a transition."""

from collections.abc import Callable
from dataclasses import replace

from studio.core.body.canonical import BodyPart
from studio.core.changed_records import with_fields
from studio.core.constraints.base import BodyPoint
from studio.core.stage.behaviour import Transition
from studio.core.stage.behaviour_target import PELVIS_POINT, BehaviourTarget
from studio.core.stage.conditions import (
    ClipEndCondition,
    Condition,
    DistanceCondition,
    EventCondition,
    KeyCondition,
    TimeCondition,
)
from studio.core.stage.project import Project
from studio.panels.behaviour.part_editor import PartEditor, PointChoice, TargetChoiceRows
from studio.panels.fields import Choice, NumberField, Section, TextField, press_button

CONDITION_KINDS: dict[str, tuple[str, Condition]] = {
    "closer": ("Closer than", DistanceCondition()),
    "farther": ("Farther than", DistanceCondition(closer=False)),
    "time": ("Time elapsed", TimeCondition()),
    "clip_end": ("Clip ended", ClipEndCondition()),
    "event": ("Event", EventCondition("attack")),
    "key": ("Key press", KeyCondition("K")),
}
"""Label and default value of each kind of condition."""
PutCondition = Callable[[Callable[[], Condition] | None, str], None]
"""Function that is called with a factory of the edited condition, or None to remove it, and the text of the undo step.
"""
DEFAULT_POINT = BodyPoint(BodyPart.HEAD)
DISTANCE_UNITS = ((False, "Metres"), (True, "Leg lengths"))


def kind_of(condition: Condition) -> str:
    """Key in ``CONDITION_KINDS`` for a condition."""
    if isinstance(condition, DistanceCondition):
        return "closer" if condition.closer else "farther"
    return condition.kind


class ConditionSection(Section):
    """Form section of one condition; edits are passed to ``put``."""

    def __init__(self, editor: PartEditor[Transition], title: str, condition: Condition, put: PutCondition) -> None:
        super().__init__(title)
        self._condition, self._put = condition, put
        remove = press_button("Remove", lambda: put(None, "Remove condition"), "link")
        remove.setAccessibleName(f"Remove condition: {title}")
        self.head.addWidget(remove)
        self._kind = Choice("Condition", [(key, text) for key, (text, _) in CONDITION_KINDS.items()])
        self._kind.value_chosen.connect(self._set_kind)
        self.add_row("Condition", self._kind)
        match condition:
            case DistanceCondition():
                self._add_distance(editor)
            case TimeCondition():
                field = NumberField("Seconds", "s", 0.0, 3600.0, 0.05)
                self._seconds = editor.bind(field, lambda seconds: self._set("Set time", seconds=seconds))
                self.add_row("Time", self._seconds)
            case EventCondition() | KeyCondition():
                self._add_name(condition)

    def show_condition(self, condition: Condition, project: Project) -> None:
        """Show a condition of the kind for which the section was made."""
        self._condition = condition
        self._kind.show_value(kind_of(condition))
        match condition:
            case DistanceCondition():
                self._distance.show_value(condition.distance)
                self._distance.setSuffix(f" {condition.gap.unit}")
                self._legs.show_value(condition.gap.legs)
                self._flat.show_value(condition.gap.flat)
                self._point.show_point(condition.gap.point)
                for widget in (self._point, self._point_caption):
                    widget.setVisible(not condition.gap.flat)
                self._whom.show_whom(condition.gap.whom, project, with_point=not condition.gap.flat)
            case TimeCondition():
                self._seconds.show_value(condition.seconds)
            case EventCondition():
                self._name.setText(condition.event)
            case KeyCondition():
                self._name.setText(condition.key)

    def _add_distance(self, editor: PartEditor[Transition]) -> None:
        self._distance = editor.bind(
            NumberField("Distance", "m", 0.0, 100.0, 0.05), lambda far: self._set("Set distance", distance=far)
        )
        self.add_row("Distance", self._distance)
        self._legs = Choice("Units", DISTANCE_UNITS)
        self._legs.setToolTip(
            "Leg lengths are the mean of both characters, so that one behaviour fits characters of any size."
        )
        self._legs.value_chosen.connect(lambda legs: self._set_gap(legs=legs))
        self.add_row("Units", self._legs)
        self._flat = Choice("Distance type", [(True, "Horizontal"), (False, "Point to point")])
        self._flat.value_chosen.connect(
            lambda flat: self._set_gap(flat=flat, point=PELVIS_POINT if flat else DEFAULT_POINT)
        )
        self.add_row("Distance type", self._flat)
        self._point = PointChoice("Body point", lambda point: self._set_gap(point=point))
        self._point_caption = self.add_row("Body point", self._point)
        self._whom = TargetChoiceRows(self, "To", self._set_whom)

    def _add_name(self, condition: Condition) -> None:
        is_key = isinstance(condition, KeyCondition)
        self._name = TextField()
        self._name.setToolTip(
            "A letter, a digit, or a name such as Space." if is_key
            else "Event sent by a state of the partner, or received over the network."
        )  # fmt: skip
        self._name.editingFinished.connect(lambda: self._rename("key" if is_key else "event"))
        self.add_row("Key press" if is_key else "Event", self._name)

    def _rename(self, field: str) -> None:
        if self._name.text().strip() != getattr(self._condition, field):
            self._set(f"Set {field}", **{field: self._name.text()})

    def _set_kind(self, kind: str) -> None:
        new = CONDITION_KINDS[kind][1]
        if isinstance(new, DistanceCondition) and isinstance(self._condition, DistanceCondition):
            new = replace(self._condition, closer=new.closer)
        self._put(lambda: new, "Set condition")

    def _set(self, text: str, **values: object) -> None:
        self._put(lambda: with_fields(self._condition, **values), text)

    def _set_gap(self, **values: object) -> None:
        assert isinstance(self._condition, DistanceCondition)
        self._set("Set distance", gap=with_fields(self._condition.gap, **values))

    def _set_whom(self, whom: BehaviourTarget) -> None:
        self._set_gap(whom=whom)
