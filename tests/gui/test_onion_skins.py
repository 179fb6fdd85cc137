"""Onion skins and kept ghosts: the same body at other moments, in the picture and in no file."""

from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest

from studio.app.preferences_dialog import PreferencesDialog
from studio.document import colours
from studio.engine.posed_performer import posed_performers
from studio.panels.fields import NumberField
from studio.viewport.onion_skins import OnionSkins, kept_ghosts, onion_ghosts
from tests.builders import make_morphology, make_project
from tests.gui.viewport_use import LEFT, chip, settle
from tests.viewport.standing import FRAMES, RATE, results_of


@pytest.fixture
def stage():
    project = make_project(characters=2)
    return project, posed_performers(project, results_of(project).get, 10 / RATE)


def frames_of(project, posed, skins):
    return [ghost.pose.frame for ghost in onion_ghosts(project, posed, skins, 10 / RATE, RATE)]


def test_skins_are_so_many_frames_apart_before_and_after_and_fade_away(stage):
    project, posed = stage
    pose = {"performer 0": posed["performer 0"]}
    assert frames_of(project, pose, OnionSkins(2, 3, 4)) == [6, 2, 14, 18, 22]
    ghosts = list(onion_ghosts(project, pose, OnionSkins(2, 3, 4), 10 / RATE, RATE))
    assert [ghost.colour for ghost in ghosts] == [colours.BEFORE_PLAYHEAD] * 2 + [colours.AFTER_PLAYHEAD] * 3
    opacities = [ghost.opacity for ghost in ghosts[2:]]
    assert opacities == sorted(opacities, reverse=True)
    assert opacities[-1] > 0.0


def test_no_skin_lies_beyond_the_ends_of_the_motion_and_none_twice(stage):
    project, posed = stage
    frames = frames_of(project, posed, OnionSkins(20, 20, 7))
    assert frames == [3, 0, 17, 24, FRAMES - 1] * 2
    assert frames_of(project, posed, OnionSkins(0, 0, 1)) == []


def test_a_kept_ghost_is_where_the_body_was_and_goes_with_its_performer(stage):
    project, posed = stage
    (ghost,) = kept_ghosts(project, posed, [("performer 1", 20 / RATE), ("gone", 0.1), ("performer 1", 10 / RATE)])
    assert (ghost.pose.frame, ghost.colour) == (20, colours.KEPT_GHOST)
    assert np.array_equal(ghost.pose.points[:, 1:], posed["performer 1"].points[:, 1:])


def test_a_motion_of_a_body_with_another_spine_casts_no_ghosts(stage):
    """Another character was put in place of the one that it was solved for."""
    pose = stage[1]["performer 0"]
    other = replace(pose.motion, morphology=make_morphology(spine_count=5))
    assert replace(pose, frames_around=other).over_time is pose.motion
    assert replace(pose, frames_around=replace(pose.motion)).over_time is not pose.motion


def test_the_chip_shows_skins_in_their_colours_and_takes_them_away(studio):
    viewport, document, _ = studio
    viewport.resize(1000, 500)
    document.selection.set(("performers", "performer 1"))
    viewport.frame_selection()
    settle(viewport)
    plain = viewport.grab_image()
    QTest.mouseClick(chip(viewport, "onion_skins_of_the_selected_character"), LEFT)
    settle(viewport)
    assert viewport.onion_shown
    assert viewport.grab_image() != plain
    QTest.mouseClick(chip(viewport, "onion_skins_of_the_selected_character"), LEFT)
    settle(viewport)
    assert viewport.grab_image() == plain


def test_a_kept_ghost_stays_while_the_playhead_moves_and_is_let_go_of(studio):
    viewport, document, _ = studio
    document.selection.set(("performers", "performer 0"))
    document.playhead.set_frame(29)
    settle(viewport)
    plain = viewport.grab_image()
    document.playhead.set_frame(0)
    viewport.keep_ghosts()
    viewport.keep_ghosts()
    assert viewport.kept_ghosts == (("performer 0", document.playhead.time),)
    document.playhead.set_frame(29)
    settle(viewport)
    assert viewport.grab_image() != plain
    viewport.clear_ghosts()
    settle(viewport)
    assert viewport.grab_image() == plain


def test_the_number_of_skins_is_a_preference_that_acts_at_once(window):
    dialog = PreferencesDialog(window.bench)
    fields = {field.accessibleName(): field for field in dialog.findChildren(NumberField)}
    dialog.show()
    fields["Step"].setFocus()
    fields["Step"].selectAll()
    QTest.keyClicks(fields["Step"], "9")
    QTest.keyClick(fields["Step"], Qt.Key.Key_Return)
    assert window.bench.preferences.onion_skins == OnionSkins(3, 3, 9)
    dialog.close()
