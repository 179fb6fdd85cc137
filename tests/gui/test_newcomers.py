"""New performers come into view, and the user's view is left alone where they are in it already."""

from dataclasses import replace

from studio.viewport.auto_framing import is_in_picture
from tests.gui.viewport_use import settle

SIZE = (900, 600)


def come(document, y):
    """A third body that plays what the others play, ``y`` metres to the left."""
    performer = replace(document.project.performers["performer 0"], name="Newcomer", position=(0.0, y))
    with document.group("Import"):
        return document.add("performers", performer, "Import")


def test_a_body_that_comes_on_outside_the_picture_is_brought_in_beside_those_that_were_seen(studio):
    viewport, document, _ = studio
    begin = viewport.camera
    key = come(document, 6.0)
    settle(viewport)
    assert all(is_in_picture(body, viewport.camera, SIZE) for body in viewport.posed.values())
    assert key in viewport.posed
    assert (viewport.camera.azimuth, viewport.camera.elevation) == (begin.azimuth, begin.elevation)
    assert viewport.camera.distance > begin.distance


def test_the_view_does_not_move_for_a_body_that_comes_on_within_it(studio):
    viewport, document, _ = studio
    viewport.set_camera(replace(viewport.camera, distance=20.0))
    settle(viewport)
    begin = viewport.camera
    come(document, 1.0)
    settle(viewport)
    assert viewport.camera == begin


def test_an_import_that_is_undone_takes_the_view_back_and_one_that_is_redone_takes_it_there_again(studio):
    viewport, document, _ = studio
    begin = viewport.camera
    come(document, 6.0)
    settle(viewport)
    after = viewport.camera
    document.undo_stack.undo()
    settle(viewport)
    assert viewport.camera == begin
    document.undo_stack.redo()
    settle(viewport)
    assert viewport.camera == after


def test_a_view_that_the_user_has_moved_since_stays_when_the_import_is_undone(studio):
    viewport, document, _ = studio
    come(document, 6.0)
    settle(viewport)
    moved = viewport.camera.orbited(0.4, 0.1)
    viewport.set_camera(moved)
    document.undo_stack.undo()
    settle(viewport)
    assert viewport.camera == moved


def test_a_close_view_of_one_body_is_left_no_farther_than_the_newcomer_needs(studio):
    viewport, document, _ = studio
    near = viewport.camera.framing(viewport.posed["performer 0"].points, SIZE, margin=1.05)
    viewport.set_camera(near)
    settle(viewport)
    key = come(document, 6.0)
    settle(viewport)
    assert is_in_picture(viewport.posed[key], viewport.camera, SIZE)
    assert is_in_picture(viewport.posed["performer 0"], viewport.camera, SIZE)
