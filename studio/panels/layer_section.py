"""Form section of a layer: body region, weight, fades, and additive mode."""

from PySide6.QtCore import QSignalBlocker

from studio.core.errors import StudioError
from studio.core.stage.clip import Clip
from studio.core.stage.layer import Region
from studio.document import clip_edits
from studio.panels.editor import Editor
from studio.panels.fields import PER_CENT, Choice, NumberField, Section, check_box, styled_label


class LayerSection(Section):
    """Form section with the settings of a clip that is a layer."""

    def __init__(self, editor: Editor[Clip]) -> None:
        super().__init__("Layer")
        self._editor = editor
        self._region = Choice("Body region", [(region, region.label) for region in Region])
        self._region.value_chosen.connect(lambda region: self._put("Set body region of", region=region))
        self.add_row("Body region", self._region)
        self._weight = editor.bind(
            NumberField("Weight", "%", 0.0, PER_CENT, 1.0, 0),
            lambda number: self._put("Set layer weight of", weight=number / PER_CENT),
        )
        self.add_row("Weight", self._weight)
        self._fades = [
            editor.bind(
                NumberField(f"Fade {way}", "s", 0.0, 60.0, 0.05),
                lambda seconds, name=name: self._put("Set layer fade of", **{name: seconds}),  # type: ignore[misc]
            )
            for way, name in (("in", "fade_in"), ("out", "fade_out"))
        ]
        for field in self._fades:
            field.setSpecialValueText("automatic")
        self.add_row("Fade in / out (s)", *self._fades)
        self._additive = check_box("Additive")
        self._additive.toggled.connect(lambda on: self._put("Set additive mode of", additive=on))
        self.add_row("Blend mode", self._additive)
        self._reference = editor.bind(
            NumberField("Reference frame", "", -1, 1e6, 1, 0),
            lambda frame: self._put("Set reference frame of", reference=round(frame)),
        )
        self._reference.setSpecialValueText("first frame")
        self._reference.setToolTip("Additive: the difference from this frame of the clip is added.")
        self._reference_row = self.add_row("Reference frame", self._reference)
        self.add_wide(styled_label("Foot contacts come from the clips that drive the legs.", "hint"))

    def refresh(self) -> None:
        """Update all fields; the section is hidden for a clip of the track."""
        layer = clip_edits.layer_of(self._editor.document.project, self._editor.entity_id)
        self.setVisible(layer is not None)
        if layer is None:
            return
        self._region.show_value(layer.region)
        self._weight.show_value(PER_CENT * layer.weight)
        for field, seconds in zip(self._fades, (layer.fade_in, layer.fade_out), strict=True):
            field.show_value(seconds)
        with QSignalBlocker(self._additive):
            self._additive.setChecked(layer.additive)
        self._reference.show_value(layer.reference)
        for widget in (self._reference, self._reference_row):
            widget.setVisible(layer.additive)

    def _put(self, text: str, **values: object) -> None:
        editor = self._editor
        words = f"{text} {clip_edits.name_of(editor.document.project, editor.entity)}"
        try:
            clip_edits.edit_layer(editor.document, editor.entity_id, words, editor.gesture, **values)
        except StudioError as error:
            editor.document.problem_reported.emit(str(error))
            self.refresh()
