"""Form of a prop: shape, size, and its placement on the stage or by a performer."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from PySide6.QtWidgets import QWidget

from studio.core.body.canonical import BodyPart
from studio.core.constraints.base import BodyPoint
from studio.core.constraints.procedural import ProceduralPlace
from studio.core.curves.keyed import KeyedPlace, Keys
from studio.core.rotations import from_matrix, to_matrix
from studio.core.stage.holding import HAND_REACH_SECONDS, reaching_time
from studio.core.stage.prop import Carried, Hold, InHand, Prop, PropShape
from studio.document.document import Document
from studio.document.grips import update_grips
from studio.document.obstacles import obstacles_of, set_obstacle
from studio.engine.live_interface import Live
from studio.engine.point_names import POINT_NAMES, point_words
from studio.engine.posed_performer import posed_performers
from studio.engine.prop_places import (
    PropPose,
    heading_of,
    hold_between_hands,
    hold_in_hand,
    moved_prop,
    prop_at,
    resized_prop,
    turned_prop,
    with_fixed_position,
    wrists_from,
)
from studio.panels.constraint_editors.procedural_rows import PROCEDURAL_KINDS, ProceduralRows, ruled_position
from studio.panels.constraint_editors.vector_row import VectorRow
from studio.panels.editor import Editor, EntityNameField
from studio.panels.fields import Choice, Section, check_box, press_button, styled_label
from studio.panels.rotation_row import RotationRow

LEAST_PROP_SIZE = 0.001
STAYING, KEYED_PLACE = "stays", "keyed"
PLACE_CHOICES = (
    (STAYING, "Fixed"),
    (KEYED_PLACE, "Animated"),
    *PROCEDURAL_KINDS,
    (InHand.kind, "Attached to a body point"),
    (Carried.kind, "Carried in both hands"),
)
RIGHT_HAND = BodyPoint(BodyPart.RIGHT_HAND)


class PropEditor(Editor[Prop]):
    """Form of a prop; position and rotation are those at the playhead."""

    def __init__(self, document: Document, live: Live, collection: str, entity_id: str) -> None:
        super().__init__(document, live, collection, entity_id)
        section = Section("Prop")
        self._name = EntityNameField(self)
        section.add_row("Name", self._name)
        self._shape = Choice("Shape", ())
        self._shape.value_chosen.connect(lambda shape: self.change(f"Shape of {self.entity.name}", shape=shape))
        section.add_row("Shape", self._shape)
        self._size = VectorRow(self, section, "Size", self._resize)
        self._size.set_least(LEAST_PROP_SIZE)
        self._where = Choice("Placement", PLACE_CHOICES)
        self._where.value_chosen.connect(self._place)
        section.add_row("Placement", self._where)
        self._holder = Choice("Carried by", ())
        self._holder.value_chosen.connect(self._give)
        self._holder_row = section.add_row("Carried by", self._holder)
        self._point = Choice("Point", [(point, name.capitalize()) for point, name in POINT_NAMES.items()])
        self._point.value_chosen.connect(self._fix)
        self._point_row = section.add_row("Point", self._point)
        self._held, self._always = styled_label("", "value"), press_button("Always", self._hold_always)
        self._held_row = section.add_row("Carried", self._held, self._always)
        self._position = VectorRow(self, section, "Position", self._move)
        self._rotation = RotationRow(self, section, "the stage", self._turn)
        self._rule = ProceduralRows(self, section, "position")
        self._keys = [press_button("Set key", self._set_key), press_button("Delete key", self._delete_key)]
        self._keys_row = section.add_row("Keys", *self._keys)
        self._collides = check_box("Collide with characters")
        self._collides.setAccessibleName("Characters collide with the prop")
        self._collides.clicked.connect(self._set_collides)
        section.add_row("Collision", self._collides)
        document.playhead.changed.connect(self._playhead_moved)
        self.column.addWidget(section)
        self.finish()

    @property
    def pose(self) -> PropPose:
        """Pose of the prop at the playhead."""
        return self._pose_of(self.entity_id)

    def _pose_of(self, prop_id: str) -> PropPose:
        project, time = self.document.project, self.document.playhead.time
        return prop_at(project, posed_performers(project, self.live.result, time), prop_id, time)

    def refresh(self) -> None:
        """Update all fields from the document."""
        prop: Prop | None = self.entity
        if prop is None:
            return
        self._name.show_name()
        shapes = [each for each in PropShape if each is not PropShape.MESH or prop.mesh is not None]
        self._shape.offer([(each, each.value.capitalize()) for each in shapes])
        self._shape.show_value(prop.shape)
        self._size.show_values(prop.size)
        self._where.show_value(placement_choice(prop))
        self._holder.offer([(key, each.name) for key, each in self.document.project.performers.items()])
        self._rule.refresh()
        self._collides.setChecked(bool(obstacles_of(self.document.project, self.entity_id)))
        self._show(placement_choice(prop) == KEYED_PLACE, self._keys_row, *self._keys)
        self._refresh_moment()

    def depends_on(self, collection: str, entity_id: str) -> bool:
        """True for props, for performers, which may hold the prop, and for constraints, which may make it an
        obstacle.
        """
        return super().depends_on(collection, entity_id) or collection in ("performers", "constraints")

    def _resize(self, size: tuple[float, ...]) -> None:
        """Apply the edited components of ``size`` to all selected props, and to the constraints that make them
        obstacles.
        """
        text, before, ground = f"Resize {self.entity.name}", self.entity.size, self.document.project.ground
        with self._objections_told(), self.document.group(text, self.gesture):
            for prop_id in self.edited_ids:
                pose = self._pose_of(prop_id)
                x, y, z = (
                    own if new == old else new for own, old, new in zip(pose.prop.size, before, size, strict=True)
                )
                self.document.replace("props", prop_id, resized_prop(pose, (x, y, z), ground), text)
                for key, each in obstacles_of(self.document.project, prop_id).items():
                    self.document.replace("constraints", key, replace(each, size=(x, y, z)), text)

    def _set_collides(self, collides: bool) -> None:
        set_obstacle(self.document, self.entity_id, collides)

    @property
    def _hold_now(self) -> InHand | Carried | None:
        """Hold of the prop at the playhead, else its first hold; None if it is never held."""
        prop: Prop = self.entity
        return prop.held_at(self.document.playhead.time) or prop.held

    def _refresh_hold(self) -> None:
        hold = self._hold_now
        self._holder.show_value(hold.performer_id if hold else None)
        if isinstance(hold, InHand):
            place = (hold.point.part, hold.point.at_end)
            if not self._point.offers(place):
                self._point.add(place, point_words(hold.point).capitalize())
            self._point.show_value(place)
        self._show(hold is not None, self._holder_row, self._holder)
        self._show(hold is not None and not hold.is_always, self._held_row, self._held, self._always)
        if hold is not None:
            self._where.show_value(hold.kind)
            self._held.setText(_span_words(hold))
        self._show(isinstance(hold, InHand), self._point_row, self._point)

    def _refresh_moment(self) -> None:
        self._refresh_hold()
        pose = self.pose
        self._position.show_values(pose.place.tolist())
        self._rotation.show_rotation(from_matrix(pose.axes))

    def _playhead_moved(self, _: float) -> None:
        if self.entity is not None and placement_choice(self.entity) != STAYING:
            self._refresh_moment()

    def _show(self, shown: bool, *widgets: QWidget) -> None:
        for widget in widgets:
            widget.setVisible(shown)

    def _set(self, verb: str, **values: object) -> None:
        self.change(f"{verb} {self.entity.name}", **values)

    def _put_made(self, verb: str, make: Callable[[], Prop], *, reaching: float = HAND_REACH_SECONDS) -> None:
        """Replace the prop: hands that carry it no longer leave it, others come to it in ``reaching`` seconds."""
        text, before = f"{verb} {self.entity.name}", self.document.project.props
        with self.document.group(text, self.gesture):
            self.replace_entity(make, text)
            for prop_id in self.edited_ids:
                update_grips(self.document, prop_id, before[prop_id], text, reaching=reaching)

    def _move(self, position: tuple[float, ...]) -> None:
        self._put_made("Move", lambda: moved_prop(self.pose, np.array(position)))

    def _turn(self, rotation: tuple[float, float, float, float]) -> None:
        pose = self.pose
        self._put_made("Rotate", lambda: turned_prop(pose, to_matrix(np.array(rotation)) @ pose.axes.T))

    def _place(self, where: str) -> None:
        if where in (STAYING, KEYED_PLACE):
            self._put_made("Set placement of", lambda: with_fixed_position(self.pose, keyed=where == KEYED_PLACE))
        elif where in dict(PROCEDURAL_KINDS):
            x, y, z = self.pose.place.tolist()
            self._put_made(
                "Set procedural motion of",
                lambda: replace(with_fixed_position(self.pose, keyed=False), position=ruled_position(where, (x, y, z))),
            )
        else:
            self._hold(where, self.document.active_performer_id or "")

    def _give(self, performer_id: str) -> None:
        hold = self._hold_now
        if hold is not None:
            self._hold(hold.kind, performer_id)

    def _hold(self, where: str, performer_id: str, point: BodyPoint = RIGHT_HAND) -> None:
        document, now = self.document, self._hold_now
        begin = now.begin if now else None
        time = document.playhead.time if begin is None or where == InHand.kind else begin
        posed = posed_performers(document.project, self.live.result, time)
        holder = posed.get(performer_id)
        if holder is None:
            document.problem_reported.emit("No character can carry it yet. Show one that has a clip first.")
            self.refresh()
        elif where == InHand.kind:
            self._put_made("Attach", lambda: self._meanwhile(hold_in_hand(self.pose, performer_id, point, holder)))
        elif begin is None:
            self._put_made("Carry", lambda: self._meanwhile(hold_between_hands(self.entity, performer_id, holder)))
        else:
            pose = prop_at(document.project, posed, self.entity_id, begin)
            hold = hold_between_hands(pose.prop, performer_id, holder, heading=heading_of(pose))
            self._put_made("Carry", lambda: self._meanwhile(hold), reaching=reaching_time(wrists_from(pose, holder)))

    def _meanwhile(self, hold: InHand | Carried) -> Prop:
        """Prop whose hold at the playhead is replaced by ``hold``, with the same start and end."""
        prop: Prop = self.entity
        old = self._hold_now
        return prop.with_hold(old, replace(hold, begin=old.begin, end=old.end)) if old else prop.with_holds([hold])

    def _hold_always(self) -> None:
        hold = self._hold_now
        if hold is not None:
            self._put_made("Always carry", lambda: self.entity.with_holds([replace(hold, begin=None, end=None)]))

    def _fix(self, choice: tuple[BodyPart, bool]) -> None:
        hold = self._hold_now
        if hold is not None:
            self._hold(InHand.kind, hold.performer_id, BodyPoint(choice[0], at_end=choice[1]))

    def _set_key(self) -> None:
        self._put_made("Key", lambda: turned_prop(self._keyed_here(), np.eye(3)))

    def _keyed_here(self) -> PropPose:
        pose = self.pose
        return PropPose(moved_prop(pose, pose.place), pose.place, pose.axes, pose.time)

    def _delete_key(self) -> None:
        """Delete the key at the playhead, unless it is the last one."""
        changes: dict[str, Keys] = {}
        for name in ("position", "heading", "tilt"):
            keyed = getattr(self.entity, name)
            place = keyed.key_at(self.document.playhead.time) if isinstance(keyed, Keys) else None
            if place is not None and len(keyed.times) > 1:
                changes[name] = keyed.without_key(place)
        if changes:
            self._set("Delete key of", **changes)


def _span_words(hold: Hold) -> str:
    begin = "start" if hold.begin is None else f"{hold.begin:.2f} s"
    return f"{begin} to {'end' if hold.end is None else f'{hold.end:.2f} s'}"


def placement_choice(prop: Prop) -> str:
    """Key of a prop's placement in ``PLACE_CHOICES``."""
    if prop.held is not None:
        return prop.held.kind
    if isinstance(prop.position, ProceduralPlace):
        return prop.position.kind
    return KEYED_PLACE if isinstance(prop.position, KeyedPlace) or isinstance(prop.heading, Keys) else STAYING
