"""Things that are selected together are dragged together in the view, as one undo step."""

from dataclasses import replace

import numpy as np
import pytest

from studio.core.body.canonical import BodyPart
from studio.core.constraints.base import BodyPoint
from studio.core.stage.prop import Prop
from tests.builders import make_constraint
from tests.gui.viewport_use import drag, on_arrow, on_ring, settle


@pytest.fixture
def props(studio):
    """Two boxes that are selected."""
    viewport, document, _ = studio
    made = [document.add("props", Prop(f"Box {k}", position=(0.5 + k, 0.3 * k, 0.2)), "Add") for k in range(2)]
    document.selection.set(*(("props", key) for key in made))
    viewport.frame_selection()
    settle(viewport)
    return made


def up(viewport):
    drag(viewport, on_arrow(viewport, "z", 0.7), on_arrow(viewport, "z", 1.5))


def places(document, collection, field="position"):
    return {key: np.array(getattr(each, field)) for key, each in getattr(document.project, collection).items()}


def changes(before, after):
    return [after[key] - before[key] for key in before]


def test_two_props_move_by_the_same_way_in_one_step(studio, props):
    viewport, document, _ = studio
    before, steps = places(document, "props"), document.undo_stack.count()
    up(viewport)
    first, second = changes(before, places(document, "props"))
    assert first[2] > 0.02
    assert first == pytest.approx(second)
    assert document.undo_stack.count() == steps + 1
    assert document.undo_stack.undoText() == "Move 2 props"
    assert document.selection.of("props") == tuple(props)
    document.undo_stack.undo()
    assert all(change == pytest.approx(0.0) for change in changes(before, places(document, "props")))


def test_esc_in_the_drag_puts_both_back_without_a_step(studio, props):
    viewport, document, _ = studio
    before, steps = places(document, "props"), document.undo_stack.count()
    drag(viewport, on_arrow(viewport, "z", 0.7), on_arrow(viewport, "z", 1.5), release=False)
    assert changes(before, places(document, "props"))[0][2] > 0.02
    viewport.cancel_gesture()
    assert all(change == pytest.approx(0.0) for change in changes(before, places(document, "props")))
    assert document.undo_stack.count() == steps


def test_two_props_turn_each_about_itself(studio, props):
    viewport, document, _ = studio
    viewport.set_tool("rotate")
    before, where = places(document, "props", "heading"), places(document, "props")
    drag(viewport, on_ring(viewport, "z", 10), on_ring(viewport, "z", 60))
    first, second = changes(before, places(document, "props", "heading"))
    assert abs(first) > 0.2
    assert first == pytest.approx(second)
    assert all(change == pytest.approx(0.0) for change in changes(where, places(document, "props")))


def test_two_bodies_move_by_the_same_way(studio):
    viewport, document, _ = studio
    document.selection.set(("performers", "performer 0"), ("performers", "performer 1"))
    viewport.frame_selection()
    settle(viewport)
    before, steps = places(document, "performers"), document.undo_stack.count()
    movable = viewport.movable()
    movable.move(movable.place + np.array([0.3, -0.2, 0.0]), document.new_gesture())
    assert all(change == pytest.approx([0.3, -0.2]) for change in changes(before, places(document, "performers")))
    assert document.undo_stack.count() == steps + 1
    assert document.undo_stack.undoText() == "Move 2 characters"


def test_two_targets_move_by_the_same_way(studio):
    viewport, document, _ = studio
    point = BodyPoint(BodyPart.LEFT_FOREARM, at_end=True)
    other = document.add(
        "constraints", make_constraint(name="Left", point=point, priority=1, target=(0.2, 0.4, 1.0)), "Add"
    )
    document.selection.set(("constraints", other), ("constraints", "constraint 0"))
    viewport.frame_selection()
    settle(viewport)
    before = places(document, "constraints", "target")
    up(viewport)
    first, second = changes(before, places(document, "constraints", "target"))
    assert first[2] > 0.02
    assert first == pytest.approx(second)


def test_what_the_playhead_does_not_play_is_not_dragged(studio):
    viewport, document, _ = studio
    motion = document.add("motions", replace(document.project.motions["motion"], name="Other"), "Add")
    elsewhere = document.add("constraints", make_constraint(motion, name="Elsewhere"), "Add")
    document.selection.set(("performers", "performer 0"), ("constraints", elsewhere), ("constraints", "constraint 0"))
    settle(viewport)
    before = places(document, "constraints", "target")
    movable = viewport.movable()
    movable.move(movable.place + np.array([0.0, 0.0, 0.1]), document.new_gesture())
    after = places(document, "constraints", "target")
    assert after["constraint 0"][2] == pytest.approx(before["constraint 0"][2] + 0.1)
    assert after[elsewhere] == pytest.approx(before[elsewhere])
