"""Form section of a constraint's activation: start, end, ease in and out, and interpolation."""

from dataclasses import replace

from studio.core.changed_records import with_fields
from studio.core.constraints.base import Constraint
from studio.core.curves.activation import EaseShape
from studio.core.stage.clip import Clip
from studio.panels.editor import Editor
from studio.panels.fields import NumberField, Section, Segments

MAX_ACTIVATION_SECONDS = 3600.0


class ActivationSection(Section):
    """Form section of an activation curve as start, end, ease in and ease out."""

    def __init__(self, editor: Editor[Constraint]) -> None:
        super().__init__("Activation")
        self._editor = editor
        self._shown_clip: Clip | None = None
        self._start = editor.bind(self._seconds("Start"), self._set_start)
        self._end = editor.bind(self._seconds("End"), self._set_end)
        self._ease_in = editor.bind(self._seconds("Fade in"), self._set_ease_in)
        self._ease_out = editor.bind(self._seconds("Fade out"), self._set_ease_out)
        self._shape = Segments("Interpolation", [(shape, shape.value) for shape in EaseShape])
        self._shape.value_chosen.connect(self._set_shape)
        self.add_row("From / to (s)", self._start, self._end)
        self.add_row("Fade in / out (s)", self._ease_in, self._ease_out)
        self.add_row("Interpolation", self._shape)

    def _seconds(self, name: str) -> NumberField:
        step = 1.0 / self._editor.document.playhead.frame_rate
        return NumberField(name, "", 0.0, MAX_ACTIVATION_SECONDS, step, 3)

    def refresh(self) -> None:
        """Show the activation in stage time, for the clip that plays there; tooltips show the time of the clip."""
        curve, self._shown_clip = self._editor.entity.activation, self._clip()
        start, full, full_end, end = map(self._on_stage, (curve.start, curve.full, curve.full_end, curve.end))
        for field, stage, own in ((self._start, start, curve.start), (self._end, end, curve.end)):
            field.show_value(stage)
            field.setToolTip(f"{field.accessibleName()} ({own:.3f} s of the clip)" if stage != own else "")
        self._ease_in.show_value(full - start)
        self._ease_out.show_value(end - full_end)
        self._shape.show_value(curve.shape)

    def refresh_clip(self) -> None:
        """Update the times if the active clip has changed."""
        if self._clip() != self._shown_clip:
            self.refresh()

    def _clip(self) -> Clip | None:
        """Active clip if it plays the constraint's motion, else None."""
        clip = self._editor.document.active_clip
        return clip if clip is not None and clip.motion_id == self._editor.entity.motion_id else None

    def _on_stage(self, seconds: float) -> float:
        """Stage time in seconds of a time ``seconds`` of the constraint's motion."""
        clip = self._clip()
        rate = self._editor.document.project.frame_rate_of(clip) if clip is not None else 0.0
        return seconds if clip is None else float(clip.stage_seconds(seconds, rate))

    def _in_motion(self, seconds: float) -> float:
        """Time in seconds of the constraint's motion at the stage time ``seconds``."""
        clip = self._clip()
        rate = self._editor.document.project.frame_rate_of(clip) if clip is not None else 0.0
        return seconds if clip is None else float(clip.motion_seconds(seconds, rate))

    def _change(self, what: str, **times: float) -> None:
        editor = self._editor
        editor.replace_entity(
            lambda: replace(editor.entity, activation=with_fields(editor.entity.activation, **times)),
            f"{what} of {editor.entity.name}",
        )

    def _set_start(self, start: float) -> None:
        curve = self._editor.entity.activation
        start = min(self._in_motion(start), curve.full_end)
        self._change("Move start", start=start, full=min(start + curve.full - curve.start, curve.full_end))

    def _set_end(self, end: float) -> None:
        curve = self._editor.entity.activation
        end = max(self._in_motion(end), curve.full)
        self._change("Move end", end=end, full_end=max(end - curve.end + curve.full_end, curve.full))

    def _set_ease_in(self, seconds: float) -> None:
        curve = self._editor.entity.activation
        full = self._in_motion(self._on_stage(curve.start) + seconds)
        self._change("Set fade in", full=min(full, curve.full_end))

    def _set_ease_out(self, seconds: float) -> None:
        curve = self._editor.entity.activation
        full_end = self._in_motion(self._on_stage(curve.end) - seconds)
        self._change("Set fade out", full_end=max(full_end, curve.full))

    def _set_shape(self, shape: EaseShape) -> None:
        editor = self._editor
        editor.replace_entity(
            lambda: replace(editor.entity, activation=replace(editor.entity.activation, shape=shape)),
            f"Set interpolation of {editor.entity.name}",
        )
