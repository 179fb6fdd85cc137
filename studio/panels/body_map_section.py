"""Form section of a capture's body map: the joint of each body part, each of which can be changed."""

from functools import partial

from studio.core.body.canonical import BodyPart
from studio.core.captures.capture import Capture
from studio.panels.editor import Editor
from studio.panels.fields import Choice, Section, press_button


class BodyMapSection(Section):
    """Form section of the body map, folded at first, since most maps are right."""

    def __init__(self, editor: Editor) -> None:
        super().__init__("Body map")
        self._editor = editor
        self._choices: dict[str, Choice] = {}
        self._fold = press_button("Show", self._unfold, "link")
        self.head.addWidget(self._fold)

    def refresh(self) -> None:
        """Fetch the joints of all parts that are on show."""
        capture: Capture = self._editor.entity
        self.setVisible(capture.body_map is not None)
        names = capture.body_map.to_json(capture.skeleton) if capture.body_map else {}
        for part, choice in self._choices.items():
            choice.show_value(names.get(part, ""))

    def _unfold(self) -> None:
        self._fold.hide()
        capture: Capture = self._editor.entity
        joints = [("", "none"), *((name, name) for name in capture.skeleton.names)]
        spine = (
            [part for part in capture.body_map.to_json(capture.skeleton) if part.startswith("spine")]
            if capture.body_map
            else []
        )
        for part in (BodyPart.PELVIS.value, *spine, *(each.value for each in BodyPart)):
            if part in self._choices or part in (BodyPart.ABDOMEN, BodyPart.THORAX):
                continue
            words = part.replace("_", " ").capitalize()
            choice = Choice(words, joints)
            choice.chosen.connect(partial(self._choose, part, words))
            self.add_row(words, choice)
            self._choices[part] = choice
        self.refresh()

    def _choose(self, part: str, words: str, joint: str) -> None:
        editor = self._editor

        def make() -> Capture:
            capture: Capture = editor.entity
            names = capture.body_map.to_json(capture.skeleton) if capture.body_map else {}
            names |= {part: joint}
            return capture.with_body_map({key: name for key, name in names.items() if name})

        editor.put(make, f"Map {words.lower()} of {editor.entity.name} to {joint or 'nothing'}")
        self.refresh()
