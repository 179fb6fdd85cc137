"""Edits of keys, tangents and weights are steps that the journal keeps and a recovered session undoes."""

from dataclasses import replace

import pytest

from studio.core.curves.keyed import KeyedPlace
from studio.core.curves.tangents import Beyond, TangentMode
from studio.document.channels import with_mode
from studio.document.document import Document
from studio.document.key_edits import KeyDrag, delete_keys, edit_selected, nudge_keys, replace_fields, set_beyond
from studio.document.keyed_fields import KeyedField, KeyRef
from studio.document.recovery import recoverable_sessions
from tests.builders import make_constraint, make_project
from tests.document.test_journal import died

TARGET = KeyedField("constraints", "reach", "target")
KEYS = KeyedPlace((0.1, 0.2, 0.3), ((0.4, -0.3, 1.2), (0.5, -0.2, 1.3), (0.4, -0.1, 1.2)))


@pytest.fixture
def project():
    project = make_project(characters=1, constraints=0, contacts=0)
    return project.with_entity("constraints", "reach", make_constraint(target=KEYS))


def test_keys_tangents_and_weights_are_recovered_after_a_crash(qapp, tmp_path, project):
    document = Document(project, journal_folder=tmp_path)
    document.selection.set(("constraints", "reach"))
    document.keys.set([KeyRef(TARGET, 1)])
    edit_selected(document, lambda value, place: with_mode(value, place, TangentMode.SMOOTH), "Smooth tangents")
    set_beyond(document, [TARGET], "after", Beyond.LOOP)
    nudge_keys(document, 1)
    activation = document.project.constraints["reach"].activation.with_weight(1, 2.0)
    replace_fields(document, {TARGET._replace(name="activation"): activation}, "Move tangent")
    after = document.project
    died(document)
    [session] = recoverable_sessions(tmp_path)
    recovered = Document(journal_folder=tmp_path)
    recovered.recover(session)
    assert recovered.project.constraints == after.constraints
    assert recovered.project.constraints["reach"].target.after is Beyond.LOOP
    for _ in range(4):
        recovered.undo_stack.undo()
    assert recovered.project.constraints == project.constraints
    recovered.close()


def test_a_saved_project_has_its_tangents(qapp, tmp_path, project):
    document = Document(project)
    document.keys.set([KeyRef(TARGET, 1)])
    edit_selected(document, lambda value, place: with_mode(value, place, TangentMode.LINEAR), "Linear tangents")
    document.save(tmp_path / "keys.morpho")
    again = Document()
    assert not again.open(tmp_path / "keys.morpho").problems
    assert again.project.constraints == document.project.constraints
    document.close()
    again.close()


def test_a_drag_of_thousands_of_states_is_one_step(qapp, project):
    document = Document(project)
    document.selection.set(("constraints", "reach"))
    document.keys.set([KeyRef(TARGET, 0), KeyRef(TARGET, 1)])
    drag = KeyDrag(document)
    for step in range(1, 200):
        drag.move(step * 0.01)
    assert document.undo_stack.count() == 1
    assert document.project.constraints["reach"].target.times == pytest.approx((0.3, 2.09, 2.19))
    drag.move(0.0)
    assert document.project == project
    assert document.undo_stack.count() == 0
    document.close()


def test_keys_of_what_is_deselected_or_gone_are_selected_no_more(qapp, project):
    document = Document(project)
    document.selection.set(("constraints", "reach"))
    document.keys.set([KeyRef(TARGET, 2)])
    reach = document.project.constraints["reach"]
    document.replace("constraints", "reach", replace(reach, target=KEYS.without_key(0)), "Delete")
    assert document.keys.items == {KeyRef(TARGET, 1)}
    document.replace("constraints", "reach", replace(reach, target=KEYS.without_keys({1, 2})), "Delete")
    assert not document.keys.items
    document.keys.set([KeyRef(TARGET, 1)])
    document.selection.clear()
    assert not document.keys.items
    assert not delete_keys(document)
    document.close()


def selected_times(document):
    return [document.project.constraints["reach"].target.times[place] for place in document.keys.by_field()[TARGET]]


def test_undo_selects_the_keys_that_were_moved_past_others_and_redo_too(qapp, project):
    """It followed their order: the keys that had been passed were selected, and moved by the next drag."""
    document = Document(project)
    document.selection.set(("constraints", "reach"))
    document.keys.set([KeyRef(TARGET, 0)])
    drag = KeyDrag(document)
    for seconds in (0.05, 0.15, 0.25):
        drag.move(seconds)
    assert selected_times(document) == [pytest.approx(0.35)]
    document.undo_stack.undo()
    assert selected_times(document) == [0.1]
    document.undo_stack.redo()
    assert selected_times(document) == [pytest.approx(0.35)]


def test_undo_selects_the_keys_that_were_deleted(qapp, project):
    document = Document(project)
    document.selection.set(("constraints", "reach"))
    document.keys.set([KeyRef(TARGET, 0), KeyRef(TARGET, 2)])
    delete_keys(document)
    document.undo_stack.undo()
    assert selected_times(document) == [0.1, 0.3]


def test_undo_of_an_edit_of_something_else_leaves_the_selected_keys(qapp, project):
    document = Document(project)
    document.selection.set(("constraints", "reach"))
    document.keys.set([KeyRef(TARGET, 0)])
    name = replace(document.project.constraints["reach"], name="Other")
    document.replace("constraints", "reach", name, "Rename")
    document.keys.set([KeyRef(TARGET, 2)])
    document.undo_stack.undo()
    assert selected_times(document) == [0.3]
    document.keys.clear()
    document.undo_stack.redo()
    assert not document.keys.items


def test_a_new_edit_after_an_undo_keeps_the_selection_of_now(qapp, project):
    document = Document(project)
    document.selection.set(("constraints", "reach"))
    document.keys.set([KeyRef(TARGET, 0)])
    nudge_keys(document, 1)
    document.undo_stack.undo()
    document.keys.set([KeyRef(TARGET, 1)])
    nudge_keys(document, 1)
    assert selected_times(document) == [document.project.constraints["reach"].target.times[1]]
