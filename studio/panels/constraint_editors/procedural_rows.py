"""Form rows for the parameters of a procedural position: circle, pendulum or noise."""

import math
from dataclasses import dataclass
from functools import partial

from studio.core.changed_records import with_fields
from studio.core.constraints.base import Vector
from studio.core.constraints.procedural import CirclePlace, NoisePlace, PendulumPlace, ProceduralPlace
from studio.core.constraints.target import Place
from studio.panels.constraint_editors.vector_row import VectorRow
from studio.panels.editor import Editor, NamedEntity
from studio.panels.fields import NumberField, Section

PROCEDURAL_KINDS = (
    (CirclePlace.kind, "Circle"),
    (PendulumPlace.kind, "Pendulum"),
    (NoisePlace.kind, "Noise"),
)
_MAKERS = {each.kind: each for each in (CirclePlace, PendulumPlace, NoisePlace)}


def ruled_position(kind: str, position: Vector) -> ProceduralPlace:
    """Procedural position of a kind of ``PROCEDURAL_KINDS`` that moves about ``position``."""
    return _MAKERS[kind](centre=position)


@dataclass(frozen=True)
class _Number:
    """Parameter of a procedural position: its label, limits, and the size of the displayed unit."""

    name: str
    label: str
    unit: str
    low: float
    high: float
    step: float
    decimals: int = 2
    size: float = 1.0

    def field(self) -> NumberField:
        return NumberField(self.label, self.unit, self.low, self.high, self.step, self.decimals)


_DEGREE = math.radians(1.0)
_NUMBERS = (
    _Number("radius", "Radius", "m", 0.0, 100.0, 0.01, 3),
    _Number("tilt", "Tilt", "°", -360.0, 360.0, 1.0, 1, _DEGREE),
    _Number("length", "Length", "m", 0.0, 100.0, 0.01, 3),
    _Number("angle", "Swing angle", "°", 0.0, 180.0, 1.0, 1, _DEGREE),
    _Number("heading", "Direction", "°", -360.0, 360.0, 1.0, 1, _DEGREE),
    _Number("seconds", "Period", "s", 0.05, 600.0, 0.05),
    _Number("since", "Start time", "s", -600.0, 600.0, 0.05),
    _Number("seed", "Seed", "", 0, 2**32 - 1, 1, 0),
)


class ProceduralRows:
    """Form rows for the parameters of an entity's value ``field``; hidden if that is not procedural."""

    def __init__(self, editor: Editor[NamedEntity], section: Section, field: str) -> None:
        self._editor, self._field = editor, field
        self._rows = []
        for number in _NUMBERS:
            box = editor.bind(number.field(), partial(self._put_number, number))
            self._rows.append((number, box, section.add_row(number.label, box)))
        self._reach = VectorRow(editor, section, "Amplitude", lambda reach: self._put("Amplitude", reach=reach))
        self._reach.set_least(0.0)

    @property
    def _place(self) -> Place:
        place: Place = getattr(self._editor.entity, self._field)
        return place

    def refresh(self) -> None:
        """Show the current parameters."""
        place = self._place if isinstance(self._place, ProceduralPlace) else None
        for number, box, caption in self._rows:
            shown = hasattr(place, number.name)
            for widget in (box, caption):
                widget.setVisible(shown)
            if shown:
                box.show_value(getattr(place, number.name) / number.size)
        wanders = isinstance(place, NoisePlace)
        self._reach.set_visible(wanders, wanders, wanders)
        if isinstance(place, NoisePlace):
            self._reach.show_values([abs(way) for way in place.reach])

    def _put_number(self, number: _Number, value: float) -> None:
        own = round(value) if number.name == "seed" else value * number.size
        self._put(number.label, **{number.name: own})

    def _put(self, label: str, **values: object) -> None:
        place = self._place
        assert isinstance(place, ProceduralPlace)
        place = with_fields(place, **values)
        self._editor.change(f"Set {label.lower()} of the path of {self._editor.entity.name}", **{self._field: place})
