"""Form section of one reaction of a state: keep distance, lean away, or reach for the partner."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial

from PySide6.QtCore import QSignalBlocker

from studio.core.changed_records import with_fields
from studio.core.curves.activation import ActivationCurve
from studio.core.stage.behaviour import State
from studio.core.stage.behaviour_target import BehaviourTarget
from studio.core.stage.project import Project
from studio.core.stage.reactions import ACTIVE_WHOLE_CLIP, KeepDistance, LeanAway, Meet, Reaction
from studio.panels.behaviour.condition_section import DISTANCE_UNITS
from studio.panels.behaviour.part_editor import PartEditor, PointChoice, TargetChoiceRows
from studio.panels.fields import Choice, NumberField, Section, check_box, press_button

REACTION_TITLES: dict[type, str] = {KeepDistance: "Keep distance", LeanAway: "Lean away", Meet: "Reach for partner"}
PutManner = Callable[[Callable[[], Reaction] | None, str], None]
"""Function that is called with a factory of the edited reaction, or None to remove it, and the text of the undo step.
"""
MANNER_LIMIT = 100.0
ACTIVATION_TIMES = ("start", "full", "full_end", "end")
DEFAULT_REACH_ACTIVATION = ActivationCurve(0.0, 0.2, 0.8, 1.0)
"""Default activation of a new reaction that reaches for the partner, in seconds of the clip."""


class MannerSection(Section):
    """Form section of one reaction; edits are passed to ``put``."""

    def __init__(self, editor: PartEditor[State], manner: Reaction, put: PutManner) -> None:
        super().__init__(REACTION_TITLES[type(manner)])
        self._manner, self._put = manner, put
        remove = press_button(
            "Remove", lambda: put(None, f"Remove reaction: {REACTION_TITLES[type(manner)].lower()}"), "link"
        )
        remove.setAccessibleName(f"Remove reaction: {REACTION_TITLES[type(manner)]}")
        self.head.addWidget(remove)
        self._editor = editor
        self._numbers: dict[str, NumberField] = {}
        self._times: list[NumberField] = []
        if not isinstance(manner, KeepDistance):
            self._point = PointChoice("Body point", lambda point: self._set(point=point))
            self.add_row("Body point", self._point)
        self._whom = TargetChoiceRows(self, "Target" if isinstance(manner, Meet) else "From", self._set_whom)
        match manner:
            case KeepDistance():
                self._add_number("Distance", "distance")
                self._add_number("Tolerance", "room")
                self._legs = Choice("Units", DISTANCE_UNITS)
                self._legs.value_chosen.connect(lambda legs: self._set(legs=legs))
                self.add_row("Units", self._legs)
            case LeanAway():
                self._add_number("Min. distance", "metres")
            case Meet():
                self._add_times()

    def show_manner(self, manner: Reaction, project: Project) -> None:
        """Show a reaction of the kind for which the section was made."""
        self._manner = manner
        self._whom.show_whom(manner.whom, project, with_point=not isinstance(manner, KeepDistance))
        for name, field in self._numbers.items():
            field.show_value(getattr(manner, name))
        if not isinstance(manner, KeepDistance):
            self._point.show_point(manner.point)
        if isinstance(manner, KeepDistance):
            self._legs.show_value(manner.legs)
            for field in self._numbers.values():
                field.set_unit(manner.gap.unit)
        if isinstance(manner, Meet):
            whole = manner.activation == ACTIVE_WHOLE_CLIP
            with QSignalBlocker(self._always):
                self._always.setChecked(whole)
            for field, time in zip(self._times, ACTIVATION_TIMES, strict=True):
                field.setEnabled(not whole)
                field.show_value(getattr(DEFAULT_REACH_ACTIVATION if whole else manner.activation, time))

    def _add_number(self, label: str, name: str) -> None:
        field = NumberField(label, "m", 0.0, MANNER_LIMIT, 0.05)
        self._numbers[name] = self._editor.bind(field, lambda metres: self._set(**{name: metres}))
        self.add_row(label, field)

    def _add_times(self) -> None:
        self._always = check_box("Whole clip")
        self._always.setAccessibleName("The point follows its target while the clip plays")
        self._always.toggled.connect(
            lambda on: self._set(activation=ACTIVE_WHOLE_CLIP if on else DEFAULT_REACH_ACTIVATION)
        )
        self.add_row("Active", self._always)
        for label, names in (("Fade in (s)", ACTIVATION_TIMES[:2]), ("Fade out (s)", ACTIVATION_TIMES[2:])):
            fields = [
                NumberField(f"{label} {name.replace('_', ' ')}", "", -MANNER_LIMIT, MANNER_LIMIT, 0.05)
                for name in names
            ]
            for field, name in zip(fields, names, strict=True):
                field.setToolTip("Seconds of the clip. Drag sideways to change.")
                self._editor.bind(field, partial(self._set_time, name))
            self._times += fields
            self.add_row(label, *fields)

    def _set_time(self, name: str, seconds: float) -> None:
        manner = self._manner
        assert isinstance(manner, Meet)
        before = manner.activation
        start, full, end, gone = (seconds if each == name else getattr(before, each) for each in ACTIVATION_TIMES)
        self._put(
            lambda: replace(manner, activation=ActivationCurve(start, full, end, gone, before.shape)), self._words
        )

    def _set(self, **values: object) -> None:
        self._put(lambda: with_fields(self._manner, **values), self._words)

    def _set_whom(self, whom: BehaviourTarget) -> None:
        self._set(whom=whom)

    @property
    def _words(self) -> str:
        return f"Set reaction: {REACTION_TITLES[type(self._manner)].lower()}"
