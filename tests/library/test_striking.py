"""The strike that was found takes over, and hits."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from studio.cli.live import guard_of
from studio.core.body.morphology import Proportions
from studio.core.curves.keyed import KeyedPlace
from studio.core.grounds.ground import Ground
from studio.core.normalized.pieces import MotionPiece
from studio.core.normalized.realize import realize_motion
from studio.core.quality.metrics import angular_acceleration, contact_quality, swing_depths
from studio.core.solver.adapt import adapt
from studio.core.stage.clip import Clip
from studio.io.project.character_file import bundled_characters
from studio.library.catalogue import Catalogue
from studio.library.clip_labels import Kind, Limb
from studio.library.hit_paths import hit_point_positions
from studio.library.indexing import bundled_library, index_folders
from studio.library.library import Library
from studio.library.scenes.choosing import target_of
from studio.library.searching import StrikeQuery, position_ahead_of, search_strikes, strike_path
from studio.library.striking import StrikeClip, aimed_constraint, make_strike

EXAMPLES = Path(__file__).resolve().parents[2] / "examples" / "captures"
BODIES = {name: character.morphology for name, character in bundled_characters().items()}


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    with Catalogue(tmp_path_factory.mktemp("library")) as catalogue:
        index_folders(catalogue, [EXAMPLES])
        return Library.of(catalogue)


@pytest.fixture(scope="module")
def bundled():
    return bundled_library()


def guard(library):
    """A fighter on guard, at the start of the punch."""
    take = library.clips[1].take
    return MotionPiece(take.motion, take.contacts, 0, 120)


def found_for(library, body, ahead, height, frame=60, **changes):
    playing = guard(library)
    pose = replace(playing.motion, channels=playing.motion.channels[frame : frame + 1])
    heading = pose.channels[0, 3]
    offset = [ahead * np.cos(-heading), ahead * np.sin(-heading), height]
    place = position_ahead_of(pose, body, offset)
    return search_strikes(library, StrikeQuery(pose, body, place, **changes))[0], place


@pytest.mark.parametrize("name", BODIES)
def test_a_target_that_can_be_reached_is_hit_within_a_millimetre(library, name):
    body = BODIES[name]
    reach = body.arm.sum(axis=1).mean()
    best, place = found_for(library, body, 1.25 * reach, 0.78 * body.stature)
    strike = make_strike(guard(library), 60, StrikeClip.of(best), body, tuple(place.tolist()))
    adapted = strike.adapted()
    point = hit_point_positions(
        adapted.positions, adapted.rotations, body, best.clip.label.limb, best.clip.label.segment
    )
    assert np.linalg.norm(point[strike.hit] - place) < 1e-3
    assert adapted.residuals[0, strike.hit] < 1e-3
    assert np.isnan(adapted.residuals[0, : strike.change]).all()


def test_a_blow_that_is_begun_a_frame_before_its_hit_is_aimed_all_the_same(library):
    body = BODIES["adult_woman"]
    best, place = found_for(library, body, 0.7, 1.25)
    late, where = replace(best, start=best.hit - 1), tuple(place.tolist())
    curve = aimed_constraint(late, Clip("punch", late.start, late.clip.label.last), where, body).activation
    assert curve.at(late.hit / late.clip.take.motion.frame_rate) == 1.0


def test_the_residual_is_told_when_a_target_is_out_of_reach(library):
    body = BODIES["child"]
    best, place = found_for(library, body, 3.0, 1.0)
    strike = make_strike(guard(library), 60, StrikeClip.of(best), body, tuple(place.tolist()))
    assert strike.adapted().residuals[0, strike.hit] > 0.5


def test_a_target_that_moves_on_is_hit_where_it_is_then(library):
    body = BODIES["adult_woman"]
    best, place = found_for(library, body, 0.7, 1.25)
    strike = make_strike(guard(library), 60, StrikeClip.of(best), body, tuple(place.tolist()))
    rate = strike.composite.timing.frame_rate
    moved = place + np.array([0.0, 0.1, 0.05])
    times = strike.change / rate, strike.hit / rate
    adapted = strike.adapted(KeyedPlace(times, (tuple(place.tolist()), tuple(moved.tolist()))))
    point = hit_point_positions(
        adapted.positions, adapted.rotations, body, best.clip.label.limb, best.clip.label.segment
    )
    assert np.linalg.norm(point[strike.hit] - moved) < 1e-3


def test_the_body_goes_on_smoothly_where_the_blow_takes_over(library):
    body = BODIES["tall_man"]
    best, place = found_for(library, body, 0.75, 1.4)
    strike = make_strike(guard(library), 60, StrikeClip.of(best), body, tuple(place.tolist()))
    adapted = strike.adapted()
    steps = np.linalg.norm(np.diff(adapted.positions, 2, axis=0), axis=2).max(axis=1)
    around = steps[strike.change - 3 : strike.change + 3].max()
    assert around < 1.5 * steps.max(where=np.arange(len(steps)) > strike.change + 3, initial=0.0)
    assert (
        np.linalg.norm(np.diff(adapted.positions[strike.change - 2 : strike.change + 2], axis=0), axis=2).max() < 0.05
    )
    assert contact_quality(adapted, adapted.contacts, Ground()).slide < 0.002


@pytest.mark.parametrize("height", [0.2, 0.45])
@pytest.mark.parametrize("name", BODIES)
def test_a_kick_at_a_low_target_keeps_its_foot_above_the_ground_and_swings_as_smoothly_as_it_was_found(
    bundled, name, height
):
    """A foot that was led on as it was lifted went into the ground by up to 20 cm, and turned 29 times as sharply."""
    body, playing = BODIES[name], guard_of(None)
    for ahead in (0.75, 1.0):
        asked = target_of(
            playing.motion, playing.first, body, (ahead * body.stature / 1.66, height * body.stature / 1.66)
        )
        [best] = search_strikes(bundled, replace(asked, limbs=[Limb.LEFT_LEG, Limb.RIGHT_LEG]), 1)
        place = tuple(np.asarray(asked.place).tolist())
        strike = make_strike(playing, playing.first, StrikeClip.of(best), body, place)
        request = strike.request()
        led, found = adapt(request), adapt(replace(request, constraints=()))
        assert led.residuals[0, strike.hit] < 1e-3
        assert np.nanmax(swing_depths(led, request.contacts, Ground())) < 0.015
        sharpness = [angular_acceleration(each.rotations[strike.change :], 60.0).max() for each in (led, found)]
        assert sharpness[0] < 2.0 * sharpness[1]


def test_another_body_finds_another_clip_for_the_same_target(library):
    small, usual = (Proportions(stature=scale).applied_to(BODIES["adult_woman"]) for scale in (0.7, 1.0))
    chosen = [found_for(library, body, 0.5, 0.9)[0].clip.label.kind for body in (small, usual)]
    assert chosen == [Kind.PUNCH, Kind.KICK]


def test_an_outline_starts_in_the_pose_and_passes_the_target_as_far_off_as_it_says(library):
    body = library.clips[0].actor.body
    playing = guard(library)
    pose = replace(playing.motion, channels=playing.motion.channels[60:61])
    place = position_ahead_of(pose, body, [0.9, 0.1, 1.3])
    asked = StrikeQuery(pose, body, place)
    best = search_strikes(library, asked)[0]
    points = strike_path(best, asked)
    cut = replace(best.clip.take.motion, channels=best.clip.take.motion.channels[best.start : best.hit + 1])
    _, rotations = realize_motion(cut, body)
    c, s = np.cos(best.turn), np.sin(best.turn)
    turned = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]) @ rotations
    passes = hit_point_positions(points, turned, body, best.clip.label.limb, best.clip.label.segment)[-1]
    assert np.linalg.norm(passes - place) == pytest.approx(best.reach, abs=0.005)
    assert np.abs(points[0] - realize_motion(pose, body)[0][0]).mean() < 0.1
