"""Form row for keyed proportions and their keys."""

from collections.abc import Callable
from dataclasses import replace

from studio.core.body.growth import KeyedProportions
from studio.core.body.morphology import Proportions
from studio.core.mesh.character import Character
from studio.core.stage.project import Performer
from studio.panels.constraint_editors.target_rows import KeyRow
from studio.panels.editor import Editor
from studio.panels.fields import Section, check_box


class GrowthRow(KeyRow):
    """Checkbox that keys the proportions over stage time, and a row with the keys."""

    def __init__(
        self, editor: Editor[Character | Performer], section: Section, character_id: Callable[[], str]
    ) -> None:
        self._character_id = character_id
        self._over_time = check_box("Animated")
        self._over_time.setAccessibleName("Proportions are animated")
        self._over_time.setToolTip("Animate proportions: a slider sets a key at the playhead.")
        self._over_time.clicked.connect(self._toggle)
        section.add_row("Proportions", self._over_time)
        super().__init__(editor, section, "proportions")

    def refresh(self, known: bool = True) -> None:
        """Show if the proportions are keyed, and the key at the playhead."""
        self._over_time.setChecked(self._keyed() is not None)
        super().refresh(known)

    @property
    def _character(self) -> Character:
        return self._editor.document.project.characters[self._character_id()]

    def _keyed(self) -> KeyedProportions | None:
        proportions = self._character.proportions
        return proportions if isinstance(proportions, KeyedProportions) else None

    def _seconds(self) -> float:
        """Stage time in seconds of the playhead, rounded to a frame."""
        playhead = self._editor.document.playhead
        return playhead.frame / playhead.frame_rate

    def _go_to_time(self, seconds: float) -> None:
        self._editor.document.playhead.set_time(seconds)

    def _set(self) -> None:
        keyed, now = self._keyed(), self._seconds()
        if keyed is not None:
            self._change(keyed.with_key(now, keyed.proportions_at(now)), "Set key of")

    def _toggle(self, keyed: bool) -> None:
        now = self._seconds()
        held = self._character.proportions_at(now)
        self._change(
            KeyedProportions((now,), (held,)) if keyed else held,
            "Animate the proportions of" if keyed else "Delete keys of the proportions of",
        )

    def _change(self, value: Proportions | KeyedProportions, text: str) -> None:
        character = self._character
        make = lambda: replace(character, proportions=value)  # noqa: E731
        self._editor.put_other("characters", self._character_id(), make, f"{text} {character.name}")
