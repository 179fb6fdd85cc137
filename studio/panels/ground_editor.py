"""Form of the ground: type and parameters; all characters follow a dragged slider."""

import math
from dataclasses import dataclass, fields

from studio.core.grounds import Bumps, HeightMap, Slope, Steps, SurfaceMesh
from studio.core.grounds.ground import Ground
from studio.document.channels import DEGREES_PER_RADIAN
from studio.document.document import Document
from studio.document.length_units import PER_METRE, length_text
from studio.engine.live_interface import Live
from studio.panels.editor import Editor
from studio.panels.fields import Choice, NumberField, Section, styled_label
from studio.panels.sliders import ValueSlider

GROUND_CHOICES: tuple[tuple[type[Ground], str], ...] = (
    (Ground, "Flat"),
    (Slope, "Slope"),
    (Steps, "Steps"),
    (Bumps, "Bumps"),
    (HeightMap, "Height map"),
    (SurfaceMesh, "Mesh"),
)
NUMERIC_GROUND_KINDS = (Ground, Slope, Steps, Bumps)
"""Ground types defined by numbers; the other types come from files and are offered only if one is loaded."""


@dataclass(frozen=True)
class GroundSlider:
    """Slider of a ground parameter: limits in the parameter's own unit, and the factor ``scale`` to the displayed
    unit.
    """

    name: str
    words: str
    low: float
    high: float
    unit: str = "m"
    scale: float = 1.0
    decimals: int = 2
    whole: bool = False

    def reading(self, value: float) -> str:
        """Displayed text of a value."""
        if self.unit in PER_METRE:
            return length_text(value, self.unit, self.decimals)
        return f"{value * self.scale:.{self.decimals}f}{self.unit}"


DIRECTION_SLIDER = GroundSlider("direction", "Direction", -math.pi, math.pi, "°", DEGREES_PER_RADIAN, 0)
GROUND_SLIDERS: dict[type[Ground], tuple[GroundSlider, ...]] = {
    Slope: (
        GroundSlider("angle", "Angle", -math.radians(30.0), math.radians(30.0), "°", DEGREES_PER_RADIAN, 1),
        DIRECTION_SLIDER,
    ),
    Steps: (
        GroundSlider("rise", "Rise", -0.30, 0.30, "cm", decimals=1),
        GroundSlider("tread", "Tread", 0.20, 0.60, "cm", decimals=1),
        GroundSlider("count", "Steps", 1, 40, "", decimals=0, whole=True),
        DIRECTION_SLIDER,
    ),
    Bumps: (
        GroundSlider("amplitude", "Amplitude", 0.0, 0.30, "cm", decimals=1),
        GroundSlider("wavelength", "Wavelength", 0.4, 4.0),
        GroundSlider("seed", "Seed", 0, 50, "", decimals=0, whole=True),
    ),
}
GROUND_ORIGINS: dict[type[Ground], tuple[str, str]] = {
    Slope: ("foot", "Start position"),
    Steps: ("start", "First step position"),
    HeightMap: ("origin", "Origin"),
}


class GroundEditor(Editor[Ground]):
    """Form of the ground: type and height, and below them the parameters of the type."""

    def __init__(self, document: Document, live: Live, collection: str, entity_id: str) -> None:
        super().__init__(document, live, collection, entity_id)
        section = Section("Ground")
        self._kind = Choice(
            "Ground type", [(kind, words) for kind, words in GROUND_CHOICES if kind in NUMERIC_GROUND_KINDS]
        )
        self._kind.value_chosen.connect(self._choose)
        section.add_row("Type", self._kind)
        self._height = self.bind(
            NumberField("Height", "m", -10.0, 10.0, 0.01, 3),
            lambda metres: self.change("Set height of the ground", height=metres),
        )
        section.add_row("Height", self._height)
        self.column.addWidget(section)
        self._forms = {kind: _KindSection(self, kind) for kind in (*GROUND_SLIDERS, HeightMap)}
        for form in self._forms.values():
            self.column.addWidget(form)
        hint = styled_label("Planted feet follow the ground, on every character.", "hint")
        hint.setContentsMargins(12, 8, 12, 0)
        self.column.addWidget(hint)
        self.finish()

    def refresh(self) -> None:
        """Update type, height and parameters."""
        ground = self.entity
        kind, words = next(pair for pair in GROUND_CHOICES if pair[0] is type(ground))
        if not self._kind.offers(kind):
            self._kind.add(kind, words)
        self._kind.show_value(kind)
        self._height.show_value(ground.height)
        for shown, form in self._forms.items():
            form.setVisible(shown is kind)
            if shown is kind:
                form.refresh()

    def _choose(self, kind: type[Ground]) -> None:
        """Change the type of ground; parameters that both types have are kept."""
        if kind is type(self.entity):
            return
        words = dict(GROUND_CHOICES)[kind].lower()
        names = {field.name for field in fields(kind)} & {field.name for field in fields(self.entity)}
        kept = {name: getattr(self.entity, name) for name in names}
        if kind in NUMERIC_GROUND_KINDS:
            self.replace_entity(lambda: kind(**kept), f"Set ground to {words}")
        self.refresh()


class _KindSection(Section):
    """Form section with the sliders and the position of one type of ground."""

    def __init__(self, editor: GroundEditor, kind: type[Ground]) -> None:
        self._words = dict(GROUND_CHOICES)[kind]
        super().__init__(self._words)
        self._editor = editor
        self._sliders = {measure: self._make_slider(measure, kind) for measure in GROUND_SLIDERS.get(kind, ())}
        self._place = ""
        self._fields: list[NumberField] = []
        if kind in GROUND_ORIGINS:
            self._place, words = GROUND_ORIGINS[kind]
            self._fields = [self._make_field(words, axis) for axis in range(2)]
            self.add_row(words, *self._fields)

    def refresh(self) -> None:
        """Update every parameter."""
        ground = self._editor.entity
        for measure, slider in self._sliders.items():
            value = getattr(ground, measure.name)
            slider.show_value(value, measure.reading(value))
        for axis, field in enumerate(self._fields):
            field.show_value(getattr(ground, self._place)[axis])

    def _make_slider(self, measure: GroundSlider, kind: type[Ground]) -> ValueSlider:
        slider = ValueSlider(measure.words, measure.low, measure.high)
        slider.begun.connect(self._editor.begin)
        slider.edited.connect(lambda value: self._set(measure, value))
        slider.ended.connect(self._editor.end)
        slider.restored.connect(lambda: self._set(measure, getattr(kind(), measure.name)))
        self.add_row(measure.words, slider)
        return slider

    def _make_field(self, words: str, axis: int) -> NumberField:
        name = f"{words} {'XY'[axis]}"
        field = NumberField(name, "m", -100.0, 100.0, 0.05)
        return self._editor.bind(field, lambda metres: self._move(axis, metres))

    def _set(self, measure: GroundSlider, value: float) -> None:
        text = f"Set {measure.words.lower()} of the {self._words.lower()}"
        self._editor.change(text, **{measure.name: round(value) if measure.whole else value})

    def _move(self, axis: int, metres: float) -> None:
        place = list(getattr(self._editor.entity, self._place))
        place[axis] = metres
        self._editor.change(f"Move the {self._words.lower()}", **{self._place: tuple(place)})
