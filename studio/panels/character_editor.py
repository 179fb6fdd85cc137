"""Form of a character: sliders for stature and proportions, presets, skinning and finger curl."""

from collections.abc import Callable
from dataclasses import fields, replace

from PySide6.QtCore import Signal

from studio.core.body.growth import KeyedProportions
from studio.core.body.morphology import Morphology, Proportions
from studio.core.captures.remarks import body_remarks
from studio.core.changed_records import with_fields
from studio.core.mesh.character import Character
from studio.core.mesh.skin import Blending
from studio.core.stage.project import Performer
from studio.document.document import Document
from studio.document.length_units import length_text
from studio.engine.live_interface import Live
from studio.panels.body_map_section import character_section
from studio.panels.editor import Editor, EntityNameField
from studio.panels.fields import Choice, Section, TagField, press_button, styled_label
from studio.panels.growth_row import GrowthRow
from studio.panels.sliders import ValueSlider

MIN_PROPORTION, MAX_PROPORTION = 0.5, 1.6
ORIGINAL_PROPORTIONS = Proportions()
SKINNING_CHOICES = ((Blending.LINEAR, "Classic linear"), (Blending.DUAL_QUATERNIONS, "Dual quaternions"))
PROPORTION_PRESETS: dict[str, Proportions] = {
    "Original": ORIGINAL_PROPORTIONS,
    "Child": Proportions(stature=0.68, head=1.35, thighs=0.92, shanks=0.92, hands=0.95, shoulders=0.9),
    "Stocky": Proportions(stature=0.96, trunk=1.06, shoulders=1.18, hips=1.16, thighs=0.92, shanks=0.92),
    "Tall": Proportions(stature=1.14, thighs=1.05, shanks=1.05, head=0.94),
    "Long-armed": Proportions(upper_arms=1.25, forearms=1.28, hands=1.1),
}
SLIDER_NAMES = {"trunk": "Torso", "shanks": "Lower legs"}


def measure_of(name: str, body: Morphology) -> float:
    """Length in metres on a body that the slider of a proportion scales."""
    lengths: dict[str, Callable[[], float]] = {
        "stature": lambda: body.stature,
        "trunk": lambda: body.spine_length,
        "shoulders": lambda: float(body.clavicle.sum()),
        "hips": lambda: float(abs(body.hip_offset[0, 1] - body.hip_offset[1, 1])),
        "upper_arms": lambda: float(body.arm[0, 0]),
        "forearms": lambda: float(body.arm[0, 1]),
        "hands": lambda: float((body.hand[0] ** 2).sum() ** 0.5),
        "thighs": lambda: float(body.leg[0, 0]),
        "shanks": lambda: float(body.leg[0, 1]),
        "feet": lambda: float((body.foot[0] ** 2).sum() ** 0.5 + (body.toe[0] ** 2).sum() ** 0.5),
        "head": lambda: body.head,
    }
    return lengths[name]()


def grip_words(grip: float) -> str:
    """Finger curl as text."""
    return "open" if grip < -0.5 else "relaxed" if grip < 0.25 else "half closed" if grip < 0.75 else "fists"


class BodySection(Section):
    """Form section of all proportions of a character; every view follows a dragged slider."""

    def __init__(self, editor: Editor[Character | Performer], character_id: Callable[[], str]) -> None:
        super().__init__("Proportions")
        self._editor, self._character_id = editor, character_id
        reset = press_button(
            "Reset", lambda: self._put(ORIGINAL_PROPORTIONS, f"Reset proportions of {self._character.name}"), "link"
        )
        reset.setToolTip("Reset all proportions")
        self.head.addWidget(reset)
        self._preset = Choice("Preset", [(values, name) for name, values in PROPORTION_PRESETS.items()])
        self._preset.setPlaceholderText("Custom")
        self._preset.value_chosen.connect(self._choose)
        self.add_row("Preset", self._preset)
        self._blending = Choice("Skinning", SKINNING_CHOICES)
        self._blending.value_chosen.connect(self._blend)
        self.add_row("Skinning", self._blending)
        self._grip = ValueSlider("Finger curl", -1.0, 1.0)
        self._grip.slider.setToolTip("From open to fist. Double-click to reset.")
        self._grip.begun.connect(editor.begin)
        self._grip.edited.connect(self._close_hands)
        self._grip.ended.connect(editor.end)
        self._grip.restored.connect(lambda: self._close_hands(0.0))
        self.add_row("Finger curl", self._grip)
        self._growth = GrowthRow(editor, self, character_id)
        self._sliders = {field.name: self._make_slider(field.name) for field in fields(Proportions)}
        self._tags = TagField("hero, tall", "used by the outliner's search")
        self._tags.tags_edited.connect(self._set_tags)
        self.add_row("Tags", self._tags)
        self._odd = styled_label("", "hint")
        self.add_wide(self._odd)
        editor.document.playhead.changed.connect(self._playhead_moved)

    @property
    def _character(self) -> Character:
        return self._editor.document.project.characters[self._character_id()]

    def _make_slider(self, name: str) -> ValueSlider:
        words = SLIDER_NAMES.get(name, name.replace("_", " ").capitalize())
        slider = ValueSlider(words, MIN_PROPORTION, MAX_PROPORTION)
        slider.begun.connect(self._editor.begin)
        slider.edited.connect(lambda factor: self._set(name, words, factor))
        slider.ended.connect(self._editor.end)
        slider.restored.connect(lambda: self._set(name, words, 1.0))
        self.add_row(words, slider)
        return slider

    def refresh(self) -> None:
        """Update all lengths."""
        character = self._character
        self.refresh_now()
        self._blending.show_value(character.blending)
        self._tags.show_tags(character.tags)
        self._grip.setEnabled(character.skin.hands is not None)
        self._grip.show_value(character.grip, grip_words(character.grip))
        self._odd.setText("\n".join(f"Warning: {remark.sentence}" for remark in body_remarks(character.build)))
        self._odd.setVisible(bool(self._odd.text()))

    def refresh_now(self) -> None:
        """Update the sliders of a character with keyed proportions to those at the playhead."""
        character = self._character
        held = character.proportions_at(self._growth.now)
        body = held.applied_to(character.build)
        for name, slider in self._sliders.items():
            metres = measure_of(name, body)
            words = length_text(metres, "m", 2) if name == "stature" else length_text(metres, "cm", 1)
            slider.show_value(getattr(held, name), words)
        self._preset.show_value(held)
        self._growth.refresh()

    def _playhead_moved(self, _: float) -> None:
        if self._editor.entity is not None and isinstance(self._character.proportions, KeyedProportions):
            self.refresh_now()

    def _set(self, name: str, words: str, factor: float) -> None:
        proportions = with_fields(self._character.proportions_at(self._growth.now), **{name: factor})
        self._put(proportions, f"Set {words.lower()} of {self._character.name}")

    def _choose(self, values: Proportions) -> None:
        self._put(values, f"Set proportions of {self._character.name} to '{self._preset.currentText().lower()}'")

    def _blend(self, blending: Blending) -> None:
        make = lambda: replace(self._character, blending=blending)  # noqa: E731
        text = f"Set skinning of {self._character.name} to {dict(SKINNING_CHOICES)[blending].lower()}"
        self._editor.put_other("characters", self._character_id(), make, text)

    def _close_hands(self, grip: float) -> None:
        make = lambda: replace(self._character, grip=round(grip, 2))  # noqa: E731
        self._editor.put_other("characters", self._character_id(), make, f"Set finger curl of {self._character.name}")

    def _set_tags(self, tags: tuple[str, ...]) -> None:
        if self._editor.entity is not None:
            make = lambda: replace(self._character, tags=tags)  # noqa: E731
            text = f"Set tags of {self._character.name}"
            self._editor.put_other("characters", self._character_id(), make, text)

    def _put(self, held: Proportions, text: str) -> None:
        """Set proportions: constant, or as a key at the playhead if they are keyed."""
        keyed = self._character.proportions
        new = keyed.with_key(self._growth.now, held) if isinstance(keyed, KeyedProportions) else held
        make = lambda: replace(self._character, proportions=new)  # noqa: E731
        self._editor.put_other("characters", self._character_id(), make, text)


class CharacterEditor(Editor[Character]):
    """Form of a character that no performer uses."""

    remap_requested = Signal(str, object, str)
    """Emitted with the character's id, {part: joint} and the text of the undo step, to bind the character with another
    body map.
    """

    def __init__(self, document: Document, live: Live, collection: str, entity_id: str) -> None:
        super().__init__(document, live, collection, entity_id)
        section = Section("Character")
        self._name = EntityNameField(self)
        section.add_row("Name", self._name)
        self._body = BodySection(self, lambda: self.entity_id)
        self.column.addWidget(section)
        self.column.addWidget(self._body)
        self._body_map = character_section(self, lambda: self.entity_id, self.remap_requested.emit)
        self.column.addWidget(self._body_map)
        self.finish()

    def refresh(self) -> None:
        """Update name and proportions."""
        if self.entity is not None:
            self._name.show_name()
            self._body.refresh()
            self._body_map.refresh()
