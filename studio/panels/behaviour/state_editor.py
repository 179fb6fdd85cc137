"""Form of a state: its clip, and the reactions while it lasts."""

from collections.abc import Callable
from dataclasses import replace

from PySide6.QtCore import QSignalBlocker
from PySide6.QtWidgets import QVBoxLayout, QWidget

from studio.core.changed_records import with_fields
from studio.core.curves.keyed import KeyedNumber
from studio.core.curves.retiming import FASTEST_CLIP_SPEED, SLOWEST_CLIP_SPEED, speed_at
from studio.core.stage import behaviour_edits as edits
from studio.core.stage.behaviour import State
from studio.core.stage.clip import Clip
from studio.core.stage.clip_row import players_of
from studio.core.stage.project import new_id
from studio.core.stage.reactions import KeepDistance, LeanAway, Meet, Reaction
from studio.document.behaviour_commands import state_key
from studio.document.document import Document
from studio.engine.live_interface import Live
from studio.panels.behaviour.manner_section import REACTION_TITLES, MannerSection, PutManner
from studio.panels.behaviour.part_editor import PartEditor
from studio.panels.fields import FIELD_ICON_PX, Choice, NumberField, Section, TextField, check_box, styled_label

ADD_REACTION_LABEL = "Add reaction"
NEW_REACTIONS: dict[str, Reaction] = {
    REACTION_TITLES[type(each)]: each for each in (KeepDistance(), LeanAway(), Meet())
}


class StateEditor(PartEditor[State]):
    """Form of a state of a behaviour."""

    def __init__(self, document: Document, live: Live, collection: str, entity_id: str) -> None:
        super().__init__(document, live, collection, entity_id)
        self.column.addWidget(self._general())
        self.column.addWidget(self._playing())
        self._kinds: tuple[type, ...] = ()
        self._manners: list[MannerSection] = []
        self._box = QVBoxLayout()
        self.column.addLayout(self._box)
        below = QWidget()
        row = QVBoxLayout(below)
        row.setContentsMargins(FIELD_ICON_PX, 12, FIELD_ICON_PX, 0)
        self._add = Choice("Add reaction", [(None, ADD_REACTION_LABEL), *((title, title) for title in NEW_REACTIONS)])
        self._add.value_chosen.connect(self._add_manner)
        row.addWidget(self._add)
        row.addWidget(styled_label("Constraints of the clip stay active while the state lasts.", "hint"))
        self.column.addWidget(below)
        self.finish()

    def _general(self) -> Section:
        section = Section("State")
        self._name = TextField()
        self._name.editingFinished.connect(self._rename)
        section.add_row("Name", self._name)
        self._starts = check_box("Start state")
        self._starts.toggled.connect(self._begin_here)
        section.add_row("Start", self._starts)
        self._event = TextField()
        self._event.setPlaceholderText("none")
        self._event.setToolTip(
            "Event sent to the partner when this state begins; the partner's transitions can wait for it"
        )
        self._event.editingFinished.connect(self._set_event)
        section.add_row("Send event", self._event)
        return section

    def _playing(self) -> Section:
        section = Section("Clip")
        self._clip = Choice("Clip", ())
        self._clip.value_chosen.connect(self._choose_clip)
        section.add_row("Clip", self._clip)
        self._first = self.bind(NumberField("First frame", "", 0, 1e6, 1, 0), lambda frame: self._trim(first=frame))
        self._last = self.bind(NumberField("Last frame", "", 0, 1e6, 1, 0), lambda frame: self._trim(last=frame))
        section.add_row("Frame range", self._first, self._last)
        self._speed = self.bind(
            NumberField("Speed", "×", SLOWEST_CLIP_SPEED, FASTEST_CLIP_SPEED, 0.05),
            lambda speed: self._set_clip("Set speed", speed=speed),
        )
        section.add_row("Speed", self._speed)
        self._loop, self._mirrored = check_box("Loop clip"), check_box("Mirror left/right")
        self._loop.toggled.connect(lambda on: self._set("Loop" if on else "Play once", loop=on))
        self._mirrored.toggled.connect(lambda on: self._set_clip("Mirror", mirrored=on))
        section.add_row("Loop", self._loop)
        section.add_row("Mirror", self._mirrored)
        self._clip_fields = (self._first, self._last, self._speed, self._loop, self._mirrored)
        return section

    def refresh(self) -> None:
        """Update all fields from the document."""
        state: State | None = self.entity
        if state is None:
            return
        for field, text in ((self._name, state.name), (self._event, state.event)):
            if not field.isModified() or not field.hasFocus():
                field.setText(text)
        clip = state.clip
        self._clip.offer(self._clips().items())
        self._clip.show_value(self._chosen_clip(clip))
        for widget in self._clip_fields:
            widget.setEnabled(clip is not None)
        if clip is not None:
            speed = float(speed_at(clip.speed, clip.first / self.document.project.frame_rate_of(clip)))
            self._speed.setEnabled(not isinstance(clip.speed, KeyedNumber))
            for number, value in ((self._first, clip.first), (self._last, clip.last), (self._speed, speed)):
                number.show_value(value)
        starts = self.behaviour.start == state.name
        mirrored = clip is not None and clip.mirrored
        for box, on in ((self._starts, starts), (self._loop, state.loop), (self._mirrored, mirrored)):
            with QSignalBlocker(box):
                box.setChecked(on)
        self._starts.setEnabled(not starts)
        kinds = tuple(type(each) for each in state.manners)
        if kinds != self._kinds:
            self._make_sections(state.manners)
            self._kinds = kinds
        for section, manner in zip(self._manners, state.manners, strict=True):
            section.show_manner(manner, self.document.project)
        self._add.show_value(None)

    def _make_sections(self, manners: tuple[Reaction, ...]) -> None:
        for old in self._manners:
            self._box.removeWidget(old)
            old.hide()
            old.deleteLater()
        self._manners = [MannerSection(self, each, self._putter(index)) for index, each in enumerate(manners)]
        for section in self._manners:
            self._box.addWidget(section)

    def _clips(self) -> dict[object, str]:
        """Label of each choice of the state's clip: none, every whole motion, and every clip of the project."""
        project = self.document.project
        found: dict[object, str] = {None: "None (holds its pose)"}
        for key, motion in project.motions.items():
            if project.captures[motion.capture_id].body_map is not None:
                found["motions", key] = motion.name
        for key, clip in project.clips.items():
            player = next(iter(players_of(project, key).values()))
            found["clips", key] = f"{project.motions[clip.motion_id].name} · {player.name}"
        return found

    def _chosen_clip(self, clip: Clip | None) -> object:
        if clip is None:
            return None
        return ("clips", clip.id) if clip.id in self.document.project.clips else ("motions", clip.motion_id)

    def _choose_clip(self, choice: tuple[str, str] | None) -> None:
        project, clip = self.document.project, None
        if choice is not None and choice[0] == "clips":
            clip = replace(project.clips[choice[1]], start=0.0)
        elif choice is not None:
            capture = project.captures[project.motions[choice[1]].capture_id]
            clip = Clip(choice[1], capture.first_frame, capture.frame_count - 1, id=new_id())
        self._set("Set clip", clip=clip)

    def _trim(self, **frame: float) -> None:
        [(name, number)] = frame.items()
        clip = self.entity.clip
        if clip is not None:
            project = self.document.project
            count = project.captures[project.motions[clip.motion_id].capture_id].frame_count
            low, high = (0, clip.last) if name == "first" else (clip.first, count - 1)
            self._set_clip("Trim clip", **{name: min(max(round(number), low), high)})

    def _set_clip(self, text: str, **values: object) -> None:
        """Change values of the state's clip; a clip of the project is first replaced by a copy owned by the state."""
        clip = self.entity.clip
        if clip is not None:
            own = new_id() if clip.id in self.document.project.clips else clip.id
            self._set(text, clip=with_fields(clip, id=own, **values))

    def _begin_here(self, on: bool) -> None:
        name = self.entity.name
        if on:
            self.edit(lambda old: replace(old, start=name), f"Set {name} as start state")

    def _rename(self) -> None:
        old, new, behaviour_id = self.entity, self._name.text().strip(), self.behaviour_id
        self._name.setModified(False)
        if old is None or not new or new == old.name:
            return
        performers = [item for item in self.document.selection.items if item[0] == "performers"]
        if self.edit(lambda all_of: edits.with_state_put(all_of, old.name, replace(old, name=new)), "Rename state"):
            self.document.selection.set(*performers, ("states", state_key(behaviour_id, new)))

    def _set_event(self) -> None:
        self._event.setModified(False)
        if self.entity is not None and self._event.text().strip() != self.entity.event:
            self._set("Set event", event=self._event.text())

    def _add_manner(self, title: str | None) -> None:
        if title is not None:
            self._set(f"{self.entity.name}: {title.lower()}", manners=(*self.entity.manners, NEW_REACTIONS[title]))

    def _putter(self, index: int) -> PutManner:
        def put(make: Callable[[], Reaction] | None, text: str) -> None:
            state, manners = self.entity, self.entity.manners

            def made() -> tuple[Reaction, ...]:
                return (*manners[:index], *((make(),) if make else ()), *manners[index + 1 :])

            self.edit(lambda old: edits.with_state_put(old, state.name, replace(state, manners=made())), text)

        return put

    def _set(self, text: str, **values: object) -> None:
        state = self.entity
        if state is not None:
            self.edit(lambda old: edits.with_state_put(old, state.name, with_fields(state, **values)), text)
