"""Form section of a constraint's activation: start, end, the fades at both, and their shape."""

from dataclasses import replace

from studio.core.changed_records import with_fields
from studio.core.constraints.base import Constraint
from studio.core.curves.activation import EaseShape
from studio.panels.editor import Editor
from studio.panels.fields import NumberField, Section, Segments

LONGEST_ACTIVATION = 3600.0


class ActivationSection(Section):
    """Activation as start, end, fade in and fade out."""

    def __init__(self, editor: Editor[Constraint]) -> None:
        super().__init__("Activation")
        self._editor = editor
        self._start = editor.bind(self._seconds("Start"), self._set_start)
        self._end = editor.bind(self._seconds("End"), self._set_end)
        self._ease_in = editor.bind(self._seconds("Ease in"), self._set_ease_in)
        self._ease_out = editor.bind(self._seconds("Ease out"), self._set_ease_out)
        self._shape = Segments("Shape", [(shape, shape.value) for shape in EaseShape])
        self._shape.value_chosen.connect(self._set_shape)
        self.add_row("From · to  s", self._start, self._end)
        self.add_row("Ease  s", self._ease_in, self._ease_out)
        self.add_row("Shape", self._shape)

    def _seconds(self, name: str) -> NumberField:
        step = 1.0 / self._editor.document.playhead.frame_rate
        return NumberField(name, "", 0.0, LONGEST_ACTIVATION, step, 3)

    def refresh(self) -> None:
        """Update the curve."""
        curve = self._editor.entity.activation
        self._start.show_value(curve.start)
        self._end.show_value(curve.end)
        self._ease_in.show_value(curve.full - curve.start)
        self._ease_out.show_value(curve.end - curve.full_end)
        self._shape.show_value(curve.shape)

    def _change(self, what: str, **times: float) -> None:
        editor = self._editor
        editor.put(
            lambda: replace(editor.entity, activation=with_fields(editor.entity.activation, **times)),
            f"{what} of {editor.entity.name}",
        )

    def _set_start(self, start: float) -> None:
        curve = self._editor.entity.activation
        start = min(start, curve.full_end)
        self._change("Move start", start=start, full=min(start + curve.full - curve.start, curve.full_end))

    def _set_end(self, end: float) -> None:
        curve = self._editor.entity.activation
        end = max(end, curve.full)
        self._change("Move end", end=end, full_end=max(end - curve.end + curve.full_end, curve.full))

    def _set_ease_in(self, seconds: float) -> None:
        curve = self._editor.entity.activation
        self._change("Set ease in", full=min(curve.start + seconds, curve.full_end))

    def _set_ease_out(self, seconds: float) -> None:
        curve = self._editor.entity.activation
        self._change("Set ease out", full_end=max(curve.end - seconds, curve.full))

    def _set_shape(self, shape: EaseShape) -> None:
        editor = self._editor
        editor.put(
            lambda: replace(editor.entity, activation=replace(editor.entity.activation, shape=shape)),
            f"Shape ease of {editor.entity.name}",
        )
