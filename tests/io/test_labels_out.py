"""Labels on their way out: in the frames of what is played, and as events of C3D."""

from dataclasses import replace

import pytest

from studio.core.captures.annotations import Annotations, Label, labels_in_range
from studio.core.stage.clip import Clip
from studio.io.export import take_of_capture, write_take
from studio.io.importing import read_capture
from studio.io.project.project_file import read_project, write_project
from studio.io.staged_export import labels_played
from tests.builders import make_capture, make_contact, make_project


def playing(*clips, **labels):
    """A project in which the first performer plays ``clips`` of a motion with labels, (first, last) by name."""
    project = make_project(frames=61)
    performer = replace(project.performers["performer 0"], clips=clips)
    project = project.with_entity("performers", "performer 0", performer)
    for name, (first, last) in labels.items():
        project = project.with_entity("labels", name, Label(name, first, last, "motion"))
    return project


def spans(project):
    return [(each.name, each.first, each.last) for each in labels_played(project, "performer 0")]


def test_labels_of_one_plain_clip_count_from_its_first_frame():
    project = playing(Clip("motion", 10, 50, id="a"), early=(0, 4), crossing=(5, 12), inside=(20, 30))
    assert spans(project) == [("crossing", 0, 2), ("inside", 10, 20)]


def test_labels_of_a_clip_at_double_speed_come_twice_as_early_and_with_every_repeat():
    clip = Clip("motion", 0, 40, start=1.0, id="a", speed=2.0, repeats=2)
    project = playing(clip, kick=(20, 24))
    assert spans(project) == [("kick", 10, 12), ("kick", 30, 32)]


def test_a_label_that_ends_behind_the_frames_is_cut_and_one_behind_them_left_out():
    labels = (Label("cut", 5, 99), Label("gone", 30, 40))
    assert labels_in_range(labels, 4, 20) == (Label("cut", 1, 16),)


def test_labels_come_back_from_c3d_as_its_events(tmp_path):
    labels = (Label("Left Foot Strike", 4, 4), Label("kick", 11, 19))
    contacts = (make_contact(first=6, last=20),)
    write_take(take_of_capture(make_capture(), Annotations(contacts, labels=labels)), tmp_path / "walk.c3d")
    back = read_capture(tmp_path / "walk.c3d").annotations.labels
    assert [(each.name, each.first) for each in back if "Off" not in each.name] == [
        ("Left Foot Strike", 4),
        ("kick", 11),
    ]


def test_events_of_a_c3d_are_written_again_as_they_were(tmp_path):
    labels = (Label("Left Foot Strike", 4, 4), Label("kick", 11, 11), Label("Right Foot Off", 17, 17))
    write_take(take_of_capture(make_capture(), Annotations((), labels=labels)), tmp_path / "first.c3d")
    first = read_capture(tmp_path / "first.c3d").annotations
    assert first.labels == labels
    write_take(take_of_capture(make_capture(), first), tmp_path / "second.c3d")
    assert read_capture(tmp_path / "second.c3d").annotations.labels == labels


@pytest.mark.parametrize("schema", [1, 2])
def test_projects_of_earlier_schemas_open_without_labels_and_take_some(tmp_path, schema):
    from tests.architecture.sources import ROOT

    project = read_project(ROOT / "tests" / "data" / "versions" / f"schema_{schema}.studio").project
    assert dict(project.labels) == {}
    label = Label("kick", 0, 1, next(iter(project.motions)))
    write_project(tmp_path / "new.studio", project.with_entity("labels", "label", label), "document")
    opened = read_project(tmp_path / "new.studio")
    assert opened.problems == ()
    assert dict(opened.project.labels) == {"label": label}
