"""Form section of the body map (characterization): the joint of each body part, presets, and JSON files."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PySide6.QtWidgets import QFileDialog, QHBoxLayout, QWidget

from studio.core.body.canonical import BodyPart
from studio.core.body.humanoid import BodyMap
from studio.core.body.kinematics import joint_positions, rest_poses
from studio.core.body.skeleton import Skeleton
from studio.core.captures.capture import Capture
from studio.core.errors import StudioError
from studio.core.mesh.character import Character
from studio.core.mesh.rig import rig_body_map
from studio.io.figure.body_maps import NamingFamily, find_preset, naming_families, read_body_map
from studio.io.json_text import write_json
from studio.panels.constraint_editors.body_figure import SEGMENT_SHAPES, BodyFigure
from studio.panels.editor import Editor
from studio.panels.fields import Choice, Section, press_button
from studio.panels.joint_figure import JointFigure

FloatArray = NDArray[np.float64]

BODY_MAP_FILTER = "Body maps (*.json)"
_CLICKED = frozenset(SEGMENT_SHAPES) - {BodyPart.ABDOMEN}


@dataclass(frozen=True, eq=False)
class MappedBody:
    """Joints of a capture or character in its rest pose, ``positions`` (J, 3) in metres with Z up, and its body map."""

    name: str
    skeleton: Skeleton
    positions: FloatArray
    body_map: BodyMap

    @property
    def joints(self) -> dict[str, str]:
        """Joint name by body part, as stored in JSON files."""
        return self.body_map.to_json(self.skeleton)


def body_of_capture(capture: Capture) -> MappedBody | None:
    """Body of a capture in its reference pose; None if no body was found in it."""
    if capture.body_map is None:
        return None
    rest = joint_positions(capture.skeleton, rest_poses(capture.skeleton, capture.reference_rotations))[0]
    return MappedBody(capture.name, capture.skeleton, rest, capture.body_map)


def body_of_character(character: Character) -> MappedBody | None:
    """Body of a character in its bind pose; None if it has no joints of its own."""
    rig = character.skin.rig
    if rig is None:
        return None
    parents = rig.parents.astype(np.int64)
    offsets = rig.positions - np.where((parents < 0)[:, None], 0.0, rig.positions[parents])
    skeleton = Skeleton(rig.names, parents, offsets, np.zeros(len(parents), dtype=bool))
    return MappedBody(character.name, skeleton, rig.positions, rig_body_map(rig, character.build.layout.spine_count))


class PartFigure(BodyFigure):
    """Figure of the body parts; the part whose joint is being chosen is highlighted."""

    def tip(self, part: BodyPart | None) -> str:
        """Tooltip for the part under the mouse."""
        return "Click a part, then its joint." if part is None else f"{part.label}. Click, then click its joint."


class BodyMapSection(Section):
    """Form section of the body map, collapsed at first, since most detected maps are right."""

    def __init__(
        self,
        editor: Editor[object],
        find: Callable[[], MappedBody | None],
        put: Callable[[Mapping[str, str], str], None],
    ) -> None:
        super().__init__("Body map (characterization)")
        self._editor, self._find, self._put = editor, find, put
        self._choices: dict[str, Choice] = {}
        self._part = BodyPart.PELVIS
        self._fold = press_button("Show", self._unfold, "link")
        self.head.addWidget(self._fold)

    def refresh(self) -> None:
        """Update the joint of every part."""
        body = self._find()
        self.setVisible(body is not None)
        if body is None or not self._choices:
            return
        for part, choice in self._choices.items():
            choice.offer([("", "none"), *((name, name) for name in body.skeleton.names)])
            choice.show_value(body.joints.get(part, ""))
        self._parts.show_weights({part: 1.0 if part is self._part else 0.25 for part in _CLICKED})
        chosen = body.body_map.spine[-1] if self._part is BodyPart.THORAX else body.body_map.get(self._part)
        self._joints.show_body(body.skeleton, body.positions, body.body_map, chosen)

    def _unfold(self) -> None:
        self._fold.hide()
        body = self._find()
        if body is None:
            return
        self._parts = PartFigure("Parts of the body: click one, then its joint")
        self._parts.clicked.connect(self._choose_part)
        self._joints = JointFigure()
        self._joints.clicked.connect(self._choose_joint)
        figures = QWidget()
        row = QHBoxLayout(figures)
        row.setContentsMargins(0, 0, 0, 0)
        row.addWidget(self._parts)
        row.addWidget(self._joints, 1)
        self.add_wide(figures)
        self._preset = Choice("Preset", [(family, family.name) for family in naming_families()])
        self._preset.setPlaceholderText("Joint naming preset…")
        self._preset.setCurrentIndex(-1)
        self._preset.value_chosen.connect(self._choose_preset)
        self.add_row("Preset", self._preset)
        self.add_row("File", press_button("Load…", self._ask_load), press_button("Save…", self._ask_save))
        spine = [part for part in body.joints if part.startswith("spine")]
        for part in (BodyPart.PELVIS.value, *spine, *(each.value for each in BodyPart)):
            if part in self._choices or part in (BodyPart.ABDOMEN, BodyPart.THORAX):
                continue
            words = part.replace("_", " ").capitalize()
            choice = Choice(words, [])
            choice.value_chosen.connect(partial(self._map, part, words))
            self.add_row(words, choice)
            self._choices[part] = choice
        self.refresh()

    def _choose_part(self, part: BodyPart) -> None:
        self._part = part
        self.refresh()

    def _choose_joint(self, joint: str) -> None:
        if self._part is not BodyPart.THORAX:
            self._map(self._part.value, self._part.label, joint)
            return
        body = self._find()
        if body is None:
            return
        path = body.skeleton.path(body.body_map.spine[0], body.skeleton.index(joint))
        names = {part: name for part, name in body.joints.items() if not part.startswith("spine")}
        names |= {f"spine_{index}": body.skeleton.names[each] for index, each in enumerate(path[1:], 1)}
        self._apply(names, f"Map chest of {body.name} to {joint}")

    def _map(self, part: str, words: str, joint: str) -> None:
        """Assign a joint to a part; another part that had this joint gets the part's former one."""
        body = self._find()
        if body is not None:
            joints = body.joints
            exchanged = {other: joints.get(part, "") for other, name in joints.items() if joint and name == joint}
            self._apply(
                joints | exchanged | {part: joint}, f"Map {words.lower()} of {body.name} to {joint or 'nothing'}"
            )

    def _choose_preset(self, family: NamingFamily) -> None:
        body = self._find()
        if body is None:
            return
        try:
            found = find_preset(body.skeleton, body.positions[None], family)
        except StudioError as error:
            self._editor.document.problem_reported.emit(f"{error}")
            return
        self._apply(found.to_json(body.skeleton), f"Map {body.name} by names of {family.name}")

    def _apply(self, names: Mapping[str, str], text: str) -> None:
        self._put({part: name for part, name in names.items() if name}, text)
        self.refresh()

    def _ask_load(self) -> None:
        dialog = QFileDialog(self, "Load body map", "", BODY_MAP_FILTER)
        dialog.setFileMode(QFileDialog.FileMode.ExistingFile)
        dialog.fileSelected.connect(lambda name: self.load_from(Path(name)))
        dialog.open()

    def _ask_save(self) -> None:
        dialog = QFileDialog(self, "Save body map", "", BODY_MAP_FILTER)
        dialog.setAcceptMode(QFileDialog.AcceptMode.AcceptSave)
        dialog.setDefaultSuffix("json")
        if body := self._find():
            dialog.selectFile(f"{body.name}.json")
        dialog.fileSelected.connect(lambda name: self.save_to(Path(name)))
        dialog.open()

    def load_from(self, path: Path) -> None:
        """Apply the body map in a JSON file; errors are reported as messages."""
        body = self._find()
        try:
            names = read_body_map(path)
        except StudioError as error:
            self._editor.document.problem_reported.emit(f"{error}")
            return
        if body is not None:
            self._apply(names, f"Load body map of {body.name}")

    def save_to(self, path: Path) -> None:
        """Write the body map to a JSON file; errors are reported as messages."""
        body = self._find()
        try:
            if body is not None:
                write_json(path, body.joints)
        except StudioError as error:
            self._editor.document.problem_reported.emit(f"{error}")


def capture_section(editor: Editor[Capture]) -> BodyMapSection:
    """Section for the body map of the capture shown in ``editor``."""

    def put(names: Mapping[str, str], text: str) -> None:
        editor.replace_entity(lambda: editor.entity.with_body_map(names), text)

    return BodyMapSection(editor, lambda: body_of_capture(editor.entity), put)


def character_section(
    editor: Editor[object], character_id: Callable[[], str], remap: Callable[[str, Mapping[str, str], str], None]
) -> BodyMapSection:
    """Section for the body map of a character, shown in the form of the character or of a performer.

    ``remap`` is called with the character's id, the joint of each part and the text of the undo step; it measures and
    binds the character in the background.
    """

    def put(names: Mapping[str, str], text: str) -> None:
        remap(character_id(), names, text)

    return BodyMapSection(editor, lambda: body_of_character(editor.document.project.characters[character_id()]), put)
