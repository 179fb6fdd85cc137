import numpy as np

from studio.core.body.canonical import BodyPart
from studio.io.project.character_file import bundled_characters
from studio.viewport.coarse import coarse_skin
from studio.viewport.offscreen import render_frame
from studio.viewport.seams import panel_field, panel_signs
from tests.builders import make_project
from tests.viewport.standing import results_of


def test_panels_on_either_side_of_a_turning_joint_have_other_signs():
    layout = bundled_characters()["child"].morphology.layout
    signs, parents = panel_signs(layout), layout.parent_segments()
    turning = [
        BodyPart.HEAD, BodyPart.LEFT_UPPER_ARM, BodyPart.LEFT_FOREARM, BodyPart.LEFT_HAND,
        BodyPart.LEFT_THIGH, BodyPart.LEFT_SHANK, BodyPart.LEFT_FOOT,
    ]  # fmt: skip
    for part in turning:
        segment = layout.segment_of_part(part)
        assert signs[segment] == -signs[parents[segment]], part


def test_the_field_is_whole_within_a_panel_and_crosses_nought_on_its_seams():
    for character in bundled_characters().values():
        for skin in (character.skin, coarse_skin(character.skin)):
            field = panel_field(skin, character.build.layout)
            own = panel_signs(character.build.layout)[skin.segments[:, 0]]
            assert np.abs(field).max() <= 1.0 + 1e-6
            assert (field[skin.weights[:, 0] > 0.99] * own[skin.weights[:, 0] > 0.99] > 0.97).all()
            ends = field[skin.triangles[:, [0, 1]]]
            assert (ends[:, 0] * ends[:, 1] < 0.0).sum() > 50


def test_a_picture_shows_dark_seams_on_a_body_of_one_colour():
    project = make_project(characters=1).with_entity("characters", "character 0", bundled_characters()["giant"])
    picture = render_frame(project, results_of(project), 0.2, (600, 800)).astype(int)
    brightness, purple = picture[..., :3].sum(axis=2), picture[..., 2] - picture[..., 1] > 12
    inside = purple[:-8] & purple[8:]
    across = brightness[4:-4] < 0.75 * np.minimum(brightness[:-8], brightness[8:])
    assert (inside & across).sum() > 200
