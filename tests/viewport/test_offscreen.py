import numpy as np

from studio.io.project.character_file import bundled_characters
from studio.viewport.offscreen import render_frame, render_video
from tests.builders import make_project
from tests.viewport.standing import results_of

SIZE = (320, 200)


def stage_with_a_woman():
    project = make_project(characters=1)
    return project.with_entity("characters", "character 0", bundled_characters()["adult_woman"])


def coloured(picture):
    """Pixels that are clearly of the character's blue and not of the grey room."""
    red, blue = picture[..., 0].astype(int), picture[..., 2].astype(int)
    return (blue - red > 25).sum()


def test_a_picture_shows_the_body_in_its_colour_before_a_grey_room():
    project = stage_with_a_woman()
    picture = render_frame(project, results_of(project), 0.2, SIZE)
    assert picture.shape == (200, 320, 4)
    empty = render_frame(project, {}, 0.2, SIZE)
    assert coloured(picture) > 800
    assert coloured(empty) == 0


def test_a_film_moves_and_keeps_its_camera():
    project = stage_with_a_woman()
    first, last = list(render_video(project, results_of(project), (0.0, 0.4), SIZE))
    assert (first != last).any()
    floor = (slice(150, 200), slice(0, 30))
    assert np.abs(first[floor].astype(int) - last[floor]).max() <= 8
