"""Of whom something is asked, chosen in its form."""

from dataclasses import replace

import pytest
from PySide6.QtWidgets import QComboBox

from studio.core.captures.contacts import ContactPoint
from studio.core.constraints.scope import EVERYONE, Scope
from studio.document.document import Document
from studio.panels.inspector import Inspector
from tests.builders import make_constraint, make_contact, make_project
from tests.timeline.fakes import FakeLive

FIRST, SECOND = "performer 0", "performer 1"


@pytest.fixture
def document(qapp):
    project = make_project(characters=2, constraints=0, contacts=0)
    project = project.with_entity("constraints", "wrist", make_constraint())
    for key, first, last in (("early", 2, 6), ("late", 12, 20)):
        contact = make_contact(point=ContactPoint.LEFT_HEEL, first=first, last=last)
        project = project.with_entity("contacts", key, contact)
    document = Document(project)
    yield document
    document.close()


@pytest.fixture
def inspector(document, qtbot):
    inspector = Inspector(document, FakeLive(document))
    qtbot.addWidget(inspector)
    return inspector


def choose(inspector, text):
    form = inspector.current_form()
    field = next(each for each in form.findChildren(QComboBox) if each.accessibleName() == "Applies to")
    field.setCurrentIndex(field.findText(text))
    field.activated.emit(field.currentIndex())


def contacts_of(document, performer_id):
    clip = document.project.performers[performer_id].clips[0]
    return document.project.contacts_for(performer_id, clip)


def test_a_constraint_is_asked_of_one_body_alone_and_again_of_all(document, inspector):
    document.selection.set(("constraints", "wrist"))
    name = document.project.performers[SECOND].name
    choose(inspector, f"{name} only")
    assert document.project.constraints["wrist"].scope == Scope(performer_id=SECOND)
    assert not document.project.constraints_for(FIRST, document.project.performers[FIRST].clips[0])
    choose(inspector, "All characters")
    assert document.project.constraints["wrist"].scope == EVERYONE
    assert document.undo_stack.count() == 2


def test_a_constraint_is_asked_of_one_clip(document, inspector):
    performer = document.project.performers[SECOND]
    own = replace(performer.clips[0], id="own", start=2.0)
    document.replace("performers", SECOND, replace(performer, clips=(own,)), "")
    document.selection.set(("constraints", "wrist"))
    choose(inspector, f"Clip at 2.00 s of {performer.name}")
    assert document.project.constraints["wrist"].scope == Scope(clip_id="own")


def test_a_body_gets_contacts_of_its_own_that_begin_as_those_of_all(document, inspector):
    document.selection.set(("contacts", "late"))
    before = contacts_of(document, FIRST)
    choose(inspector, f"{document.project.performers[SECOND].name} only")
    collection, contact_id = document.selection.current
    assert (collection, contact_id != "late") == ("contacts", True)
    own = contacts_of(document, SECOND)
    assert [(each.first, each.last) for each in own.values()] == [(2, 6), (12, 20)]
    document.replace("contacts", contact_id, replace(own[contact_id], last=25), "")
    assert contacts_of(document, FIRST) == before
    choose(inspector, "All characters")
    assert contacts_of(document, SECOND) == before
    assert document.selection.current == ("contacts", "late")
