"""Scope of a constraint: all who play a motion, one performer, or one clip."""

from dataclasses import replace

import pytest

from studio.core.captures.contacts import ContactPoint
from studio.core.constraints.objections import objection
from studio.core.constraints.scope import EVERYONE, Scope
from studio.core.solver.performers.stage import constraints_of_performer
from studio.core.stage.clip import Clip
from studio.core.stage.project import Project
from tests.builders import make_constraint, make_contact, make_project

FIRST, SECOND = (Scope(performer_id=f"performer {k}") for k in range(2))


def asked(project: Project, performer_id: str) -> list[str]:
    return [each.constraint_id for each in constraints_of_performer(project, performer_id)]


def test_two_performers_of_one_motion_are_asked_different_things() -> None:
    project = make_project(constraints=1)
    project = project.with_entity("constraints", "mine", make_constraint(priority=1, scope=FIRST))
    project = project.with_entity("constraints", "theirs", make_constraint(priority=1, scope=SECOND))
    assert asked(project, "performer 0") == ["constraint 0", "mine"]
    assert asked(project, "performer 1") == ["constraint 0", "theirs"]


def test_what_is_asked_of_a_clip_is_asked_in_each_of_its_repeats_and_of_no_other() -> None:
    project = make_project(constraints=0)
    performer = project.performers["performer 0"]
    clips = (Clip("motion", 0, 29, id="a"), Clip("motion", 0, 29, start=0.5, id="b", repeats=3))
    project = project.with_entity("performers", "performer 0", replace(performer, clips=clips))
    project = project.with_entity("constraints", "c", make_constraint(scope=Scope(clip_id="b")))
    assert [(each.clip, each.repeat) for each in constraints_of_performer(project, "performer 0")] == [
        (1, 0),
        (1, 1),
        (1, 2),
    ]
    assert asked(project, "performer 1") == []


def test_the_narrowest_contacts_of_a_point_count() -> None:
    project = make_project(contacts=0)
    for key, scope, first in (("all", EVERYONE, 3), ("own", FIRST, 7)):
        project = project.with_entity("contacts", key, make_contact(first=first, scope=scope))
    toe = make_contact(point=ContactPoint.LEFT_TOE)
    project = project.with_entity("contacts", "toe", toe)
    clip = project.performers["performer 0"].clips[0]
    assert {each.first for each in project.contacts_for("performer 0", clip).values() if each.point.is_heel} == {7}
    assert {each.first for each in project.contacts_for("performer 1", clip).values() if each.point.is_heel} == {3}
    assert toe in project.contacts_for("performer 0", clip).values()


def test_who_is_removed_takes_what_was_asked_of_it_alone_along() -> None:
    project = make_project()
    project = project.with_entity("constraints", "mine", make_constraint(scope=FIRST))
    assert ("constraints", "mine") in project.referring_to("performers", "performer 0")


def test_constraints_of_different_performers_do_not_contradict_each_other() -> None:
    one, other = (make_constraint(name=name, target=(x, 0.0, 1.0)) for name, x in (("a", 0.2), ("b", 0.6)))
    assert objection(one, [other]) is not None
    assert objection(replace(one, scope=FIRST), [replace(other, scope=SECOND)]) is None
    assert objection(replace(one, scope=FIRST), [other]) is not None


def test_a_scope_names_a_performer_or_a_clip() -> None:
    with pytest.raises(ValueError, match="not both"):
        Scope("somebody", "something")
