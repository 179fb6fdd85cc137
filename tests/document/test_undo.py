"""Undo is exact: whatever was edited, undoing all gives the first bytes back, redoing all the last."""

import gc
import weakref
from dataclasses import replace
from random import Random
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from studio.core.body.canonical import BodyPart
from studio.core.captures.contacts import ContactInterval, ContactPoint
from studio.core.constraints.area import AreaConstraint
from studio.core.constraints.base import BodyPoint, Constraint
from studio.core.constraints.follow import UNTURNED, FollowPerformer, FollowProp, FollowTracked
from studio.core.curves.keyed import KeyedNumber, KeyedPlace, KeyedTurn, unit_quaternion
from studio.core.errors import StudioError
from studio.core.grounds.ground import Ground
from studio.core.stage.behaviour import Behaviour, Role, State, Transition
from studio.core.stage.behaviour_target import DistanceMeasure, FollowPartner
from studio.core.stage.clip import Clip
from studio.core.stage.conditions import DistanceCondition
from studio.core.stage.correction import PoseOffsets, new_correction
from studio.core.stage.footage import Footage
from studio.core.stage.project import GROUND_ID, Motion
from studio.core.stage.prop import Prop
from studio.core.stage.reactions import KeepDistance
from studio.core.stage.saved_camera import CAMERA_SLOTS, CameraPlacement
from studio.core.stage.sound_track import SoundTrack
from studio.document.clip_edits import set_speed
from studio.document.document import Document
from studio.document.stored_cameras import give_slot, store_camera
from studio.io.project.entity_json import project_json
from tests.builders import make_capture, make_constraint, make_contact, make_project

WRIST = BodyPoint(BodyPart.RIGHT_FOREARM, at_end=True)
PROJECT = make_project(characters=3, constraints=2, contacts=3)

EDITS = (
    "add", "add contact", "add prop", "drag", "drag", "trim", "remove", "ground", "group", "behave", "camera", "sound",
    "footage", "correct", "correct", "retime", "retime", "tilt", "weigh",
)  # fmt: skip
"""Kinds of random edits, the frequent ones twice."""
REMOVED = {
    "behaviours": 2, "cameras": 1, "sounds": 1, "footage": 1, "corrections": 3, "constraints": 6, "contacts": 6,
    "props": 6,    "performers": 2, "characters": 1, "motions": 0.1, "captures": 0.1,
}  # fmt: skip
"""Relative frequency with which something of each collection is removed."""


def state(document: Document) -> bytes:
    return project_json(document.project, {})


def behaviour_of(document: Document, chance: Random) -> Behaviour:
    """One about whoever and whatever is on the stage."""
    project = document.project
    players, motions, props = list(project.performers), list(project.motions), list(project.props)
    role = (Role(players[0], players[-1]),) if len(players) > 1 else ()
    clip = Clip(motions[0], 0, 9) if motions else None
    whoms = [FollowPartner(), *map(FollowProp, props), *(FollowPerformer(key, WRIST) for key in players)]
    near = DistanceCondition(DistanceMeasure(chance.choice(whoms)))
    rest = State("Rest", clip, manners=(KeepDistance(chance.choice(whoms), chance.uniform(0.5, 2.0)),))
    return Behaviour("Fighter", (rest, State("Go")), (Transition("Rest", "Go", (near,)),), cast=role)


def make_area(priority: int) -> AreaConstraint:
    """Table that the point of ``make_constraint`` keeps out of."""
    base = make_constraint()
    return AreaConstraint(base.motion_id, f"Table {priority}", base.point, base.chain, priority, base.activation)


def edit_at_random(document: Document, chance: Random, gesture: int) -> None:
    """One of the edits an animator makes; some belong to the current gesture."""
    project = document.project
    areas = [key for key, each in project.constraints.items() if isinstance(each, AreaConstraint)]
    constraints, contacts = [key for key in project.constraints if key not in areas], list(project.contacts)
    match chance.choice(EDITS):
        case "add" if project.motions:
            props = [FollowProp(key) for key in project.props]
            target = chance.choice([(0.4, -0.3, 1.2), KeyedPlace((0.1,), ((0.0, 0.1, 1.0),)), *props])
            added = make_constraint(name=f"T{chance.random()}", priority=chance.randrange(10**9), target=target)
            document.add("constraints", added, "Add target")
        case "add contact" if project.motions:
            document.add("contacts", make_contact(first=chance.randrange(12)), "Add contact")
        case "add prop":
            document.add("props", Prop("Box"), "Add prop")
        case "drag" if constraints:
            key = chance.choice(constraints)
            target = (chance.choice([0.0, 0.1, 0.2]), 0.0, 1.0)
            moved = replace(project.constraints[key], target=target)
            document.replace("constraints", key, moved, "Move target", gesture)
        case "weigh" if constraints:
            key = chance.choice(constraints)
            weight = chance.choice([0.0, chance.uniform(0.0, 9.0), KeyedNumber((0.1, 0.2), (chance.random(), 0.0))])
            document.replace("constraints", key, replace(project.constraints[key], weight=weight), "Weigh", gesture)
        case "tilt" if project.motions:
            key = chance.choice([document.add("constraints", make_area(chance.randrange(10**9)), "Add area"), *areas])
            turn = unit_quaternion([chance.uniform(-1.0, 1.0) for _ in range(3)] + [1.0])
            tilt = chance.choice([turn, KeyedTurn((0.1, 0.2), (turn, UNTURNED))])
            tilted = replace(document.project.constraints[key], tilt=tilt, heading=chance.uniform(-3.0, 3.0))
            document.replace("constraints", key, tilted, "Rotate area", gesture)
        case "trim" if contacts:
            key = chance.choice(contacts)
            trimmed = replace(project.contacts[key], last=12 + chance.randrange(5))
            document.replace("contacts", key, trimmed, "Trim contact")
        case "behave" if project.behaviours:
            key = chance.choice(list(project.behaviours))
            document.replace("behaviours", key, behaviour_of(document, chance), "Change behaviour", gesture)
        case "behave":
            document.add("behaviours", behaviour_of(document, chance), "Add behaviour")
        case "sound":
            sound = SoundTrack("Steps", "steps.wav", (0, 255), (0.01,), chance.uniform(0.0, 2.0))
            sound_id = chance.choice([document.add("sounds", sound, "Add sound"), *project.sounds])
            document.replace("sounds", sound_id, replace(sound, start=chance.random()), "Move sound", gesture)
        case "footage":
            film = Footage("Walk", "walk.mp4", 40, 24.0, chance.choice([12.0, 24.0]))
            film_id = chance.choice([document.add("footage", film, "Add footage"), *project.footage])
            document.replace("footage", film_id, replace(film, start=chance.random()), "Move footage", gesture)
        case "camera":
            placement = CameraPlacement((0.0, 0.0, chance.choice([0.0, 1.0])), 3.0, chance.uniform(-3.0, 3.0))
            camera_id = store_camera(document, placement, chance.choice([None, *CAMERA_SLOTS]))
            give_slot(document, chance.choice([camera_id, *document.project.cameras]), chance.choice(CAMERA_SLOTS))
        case "correct" if project.corrections:
            key = chance.choice(list(project.corrections))
            turn = (BodyPart.LEFT_FOREARM, (chance.uniform(-1.0, 1.0), 0.0, 0.0))
            posed = project.corrections[key].with_key(chance.uniform(0.0, 2.0), PoseOffsets((turn,)))
            document.replace("corrections", key, posed, "Pose elbow", gesture)
        case "correct" if project.performers:
            performer = chance.choice(list(project.performers))
            added = new_correction("Elbow", performer, 0.2)
            document.add("corrections", added, "Add correction")
        case "retime" if project.clips:
            speeds = [2.0, KeyedNumber((0.05, 0.1), (1.0, chance.uniform(0.4, 2.0)))]
            set_speed(document, chance.choice(list(project.clips)), chance.choice(speeds), "Key speed", gesture)
        case "remove":
            [name] = chance.choices(list(REMOVED), list(REMOVED.values()))
            keys = list(getattr(project, name))
            if keys:
                document.remove(name, chance.choice(keys), "Remove")
        case "ground":
            document.replace("grounds", GROUND_ID, Ground(chance.choice([0.0, 0.1])), "Raise ground", gesture)
        case "group":
            with document.group("Several", chance.choice([None, gesture])):
                edit_at_random(document, chance, gesture)
                edit_at_random(document, chance, gesture)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(seed=st.integers(0, 2**32))
def test_undoing_all_gives_the_first_bytes_and_redoing_all_the_last(qapp: Any, seed: int) -> None:
    document, chance = Document(PROJECT), Random(seed)
    first = state(document)
    gesture = document.new_gesture()
    for _ in range(40):
        if chance.random() < 0.2:
            gesture = document.new_gesture()
        if chance.random() < 0.15:
            document.undo_stack.setIndex(chance.randrange(document.undo_stack.count() + 1))
        edit_at_random(document, chance, gesture)
    last = state(document)
    now = document.undo_stack.index()
    document.undo_stack.setIndex(0)
    assert state(document) == first
    document.undo_stack.setIndex(now)
    assert state(document) == last
    document.undo_stack.clear()  # Qt crashes where Python collects commands before their stack


def moved(document: Document, x: float) -> Any:
    return replace(document.project.constraints["constraint 0"], target=(x, 0.0, 1.0))


def test_a_drag_is_one_undo_step(qapp: Any) -> None:
    document = Document(PROJECT)
    gesture = document.new_gesture()
    for x in (0.1, 0.2, 0.3):
        document.replace("constraints", "constraint 0", moved(document, x), "Move target", gesture)
    document.replace("constraints", "constraint 0", moved(document, 0.9), "Move target", document.new_gesture())
    assert document.history == ("Move target", "Move target")
    document.undo_stack.undo()
    assert document.project.constraints["constraint 0"].target[0] == 0.3


def test_what_a_thing_was_in_the_middle_of_a_drag_is_not_kept(qapp: Any) -> None:
    """One command of each move stayed for ever, with the values it had: a drag of a minute kept thousands."""
    document, gesture = Document(PROJECT), 7
    passed = [replace(PROJECT.constraints["constraint 0"], weight=0.1 + 0.1 * step) for step in range(5)]
    alive = [weakref.ref(each) for each in passed]
    while passed:
        document.replace("constraints", "constraint 0", passed.pop(0), "Drag", gesture)
    gc.collect()
    assert [each() is not None for each in alive] == [False] * 4 + [True]
    document.close()


def test_a_drag_back_to_its_start_vanishes(qapp: Any) -> None:
    document = Document(PROJECT)
    start, gesture = document.project.constraints["constraint 0"], document.new_gesture()
    document.replace("constraints", "constraint 0", moved(document, 0.1), "Move target", gesture)
    document.replace("constraints", "constraint 0", start, "Move target", gesture)
    assert document.history == ()
    assert not document.dirty


def test_a_drag_of_several_things_is_one_undo_step(qapp: Any) -> None:
    document = Document(PROJECT)
    before, gesture = state(document), document.new_gesture()
    for shift in (1, 2, 3):
        with document.group("Move contacts", gesture):
            for key in ("contact 0", "contact 1"):
                contact = document.project.contacts[key]
                document.replace("contacts", key, replace(contact, last=contact.last + shift), "Move contacts")
    assert document.history == ("Move contacts",)
    document.undo_stack.undo()
    assert state(document) == before


def test_removing_a_motion_takes_constraints_contacts_and_clips_along_and_undo_brings_all_back(
    qapp: Any,
) -> None:
    document = Document(PROJECT)
    before = state(document)
    document.remove("captures", "capture", "Remove capture")
    project = document.project
    for collection in (project.captures, project.motions, project.constraints, project.contacts):
        assert not collection
    assert [performer.clips for performer in project.performers.values()] == [(), (), ()]
    document.undo_stack.undo()
    assert state(document) == before


def test_undo_of_a_removal_restores_the_place_in_the_order(qapp: Any) -> None:
    document = Document(PROJECT)
    document.remove("characters", "character 1", "Remove")
    assert list(document.project.performers) == ["performer 0", "performer 2"]
    document.undo_stack.undo()
    assert list(document.project.performers) == ["performer 0", "performer 1", "performer 2"]


def test_what_fails_inside_a_group_leaves_nothing_behind(qapp: Any) -> None:
    document = Document(PROJECT)
    before = state(document)

    def remove_two() -> None:
        with document.group("Two things"):
            document.remove("constraints", "constraint 0", "Remove")
            document.remove("constraints", "no such", "Remove")

    with pytest.raises(StudioError):
        remove_two()
    assert state(document) == before
    assert document.history == ()


def test_an_edit_that_refers_to_nothing_is_refused_before_the_push(qapp: Any) -> None:
    document = Document(PROJECT)
    for edit in (
        lambda: document.add("constraints", make_constraint("no such motion"), "Add"),
        lambda: document.replace("props", "no such", Prop("Box"), "Move"),
        lambda: document.remove("grounds", GROUND_ID, "Remove"),
    ):
        with pytest.raises(StudioError):
            edit()
    assert document.history == ()


def test_a_change_tells_its_ids_once_the_whole_project_is_in_place(qapp: Any) -> None:
    document = Document(PROJECT)
    heard: list[tuple[str, str, bool]] = []
    document.entity_changed.connect(lambda name, key: heard.append((name, key, bool(document.project.constraints))))
    document.remove("motions", "motion", "Remove motion")
    assert ("constraints", "constraint 1", False) in heard
    assert all(not constraints_left for _, _, constraints_left in heard)


def test_what_is_gone_is_no_longer_selected(qapp: Any) -> None:
    document = Document(PROJECT)
    document.selection.set(("constraints", "constraint 0"), ("contacts", "contact 0"))
    document.remove("contacts", "contact 0", "Remove")
    assert document.selection.items == (("constraints", "constraint 0"),)


def test_the_active_performer_is_the_selected_one_else_the_first_visible(qapp: Any) -> None:
    document = Document(PROJECT)
    hidden = replace(document.project.performers["performer 0"], visible=False)
    document.replace("performers", "performer 0", hidden, "Hide")
    assert document.active_performer_id == "performer 1"
    document.selection.set(("performers", "performer 2"))
    assert document.active_performer_id == "performer 2"
    assert document.active_motion_id == "motion"


def test_who_was_selected_last_stays_active_while_a_prop_is_selected_and_when_all_is_let_go(qapp: Any) -> None:
    document = Document(PROJECT)
    prop_id = document.add("props", Prop("Box"), "Add box")
    document.selection.set(("performers", "performer 2"))
    document.selection.set(("props", prop_id))
    assert document.active_performer_id == "performer 2"
    document.selection.clear()
    assert document.active_performer_id == "performer 2"


def test_a_range_that_the_stage_has_left_is_the_whole_stage_again(qapp: Any) -> None:
    document = Document(PROJECT)
    [first, *_] = document.project.performers
    performer = document.project.performers[first]
    whole = document.playhead.first, document.playhead.last
    late = replace(performer.clips[0], start=60.0)
    document.replace("performers", first, replace(performer, clips=(late,)), "Move")
    begin = round(60.0 * document.playhead.frame_rate)
    document.playhead.set_range(begin, begin + 10)
    document.playhead.set_frame(begin + 5)
    document.undo_stack.undo()
    assert (document.playhead.first, document.playhead.last) == whole
    assert document.playhead.frame == whole[0]


def test_a_dropped_document_with_a_history_is_collected(qapp: Any) -> None:
    document = Document(PROJECT)
    document.remove("constraints", "constraint 0", "Remove")
    document.undo_stack.undo()
    ghost = weakref.ref(document)
    del document
    gc.collect()
    assert ghost() is None


def add_and_change(document: Document, rival: Constraint) -> None:
    with document.group("Both"):
        document.add("constraints", replace(rival, priority=7), "Add")
        document.replace("constraints", "constraint 1", rival, "Change")


def test_contradictory_constraints_are_refused_when_added_or_changed_and_nothing_is_left_behind():
    document = Document(make_project(constraints=2))
    first, second = document.project.constraints.values()
    rival = replace(second, name="Rival", priority=0, target=(0.0, 0.0, 1.0))
    with pytest.raises(StudioError, match="'Rival' conflicts with 'Target 0'"):
        document.add("constraints", rival, "Add")
    with pytest.raises(StudioError, match="'Rival' conflicts with 'Target 0'"):
        document.replace("constraints", "constraint 1", rival, "Change")
    with pytest.raises(StudioError, match="conflicts"):
        add_and_change(document, rival)
    assert tuple(document.project.constraints.values()) == (first, second)
    assert document.undo_stack.count() == 0


def test_within_a_group_priorities_may_be_exchanged():
    document = Document(make_project(constraints=2))
    first, second = document.project.constraints.values()
    document.replace("constraints", "constraint 1", replace(second, target=(0.0, 0.0, 1.0)), "Move")
    with document.group("Reorder"):
        document.replace("constraints", "constraint 0", replace(first, priority=1), "Down")
        document.replace("constraints", "constraint 1", replace(second, priority=0, target=(0.0, 0.0, 1.0)), "Up")
    assert [each.priority for each in document.project.constraints.values()] == [1, 0]


def test_what_follows_a_joint_that_the_capture_has_not_is_refused():
    document = Document(make_project())
    with pytest.raises(StudioError, match="No joint is called 'Bal'"):
        document.add("constraints", make_constraint(name="Kick", target=FollowTracked("Bal")), "Add")


def test_thousands_added_at_once_are_one_step_told_by_one_signal_and_taken_back_exactly(qapp: Any) -> None:
    document = Document(make_project())
    before = state(document)
    heard: list[tuple[str, str]] = []
    document.entity_changed.connect(lambda name, key: heard.append((name, key)))
    contacts = [ContactInterval("motion", ContactPoint.LEFT_HEEL, first, first + 3) for first in range(0, 10_000, 5)]
    ids = document.add_all("contacts", contacts, "Find contacts")
    assert heard == [("contacts", "")]
    assert [document.project.contacts[key] for key in ids] == contacts
    assert document.history == ("Find contacts",)
    document.undo_stack.undo()
    assert state(document) == before


def test_the_ruler_is_that_of_the_motion_that_plays_after_undo_and_redo(qapp):
    document = Document(make_project(frames=30))
    with document.group("Import walk.bvh"):
        capture = document.add("captures", make_capture("walk", frames=120, frame_rate=30.0), "Import")
        motion = document.add("motions", Motion("walk", capture), "Import")
        for key, performer in document.project.performers.items():
            document.replace("performers", key, replace(performer, clips=(Clip(motion, 0, 119),)), "Import")
    ruler = document.playhead
    assert (ruler.frame_rate, ruler.last) == (30.0, 119)
    ruler.set_frame(100)
    document.undo_stack.undo()
    assert (ruler.frame_rate, ruler.last, ruler.frame) == (60.0, 29, 0)
    document.undo_stack.redo()
    assert (ruler.frame_rate, ruler.last) == (30.0, 119)
    document.close()


def test_who_hears_that_another_project_is_there_finds_nothing_of_the_old_one_selected() -> None:
    document = Document(PROJECT)
    document.replace("constraints", "constraint 0", make_constraint(name="Other"), "Edit")
    document.selection.set(("performers", "performer 0"), ("constraints", "constraint 1"))
    heard: list[str | None] = []
    document.undo_stack.indexChanged.connect(lambda _: heard.append(document.active_motion_id))
    document.new(make_project(constraints=0))
    assert heard == ["motion"]


def test_undo_of_a_deletion_selects_what_comes_back_and_leaves_other_selections(qapp):
    document = Document(PROJECT)
    first, second = (("constraints", key) for key in list(PROJECT.constraints)[:2])
    document.selection.set(first)
    document.remove("constraints", first[1], "Delete")
    document.replace("constraints", second[1], replace(PROJECT.constraints[second[1]], name="Other"), "Rename")
    document.selection.set(second)
    document.undo_stack.undo()
    assert document.selection.items == (second,)
    document.undo_stack.undo()
    assert document.selection.items == (first,)
    document.close()
