"""Walks that were adapted to stairs, written and read again: their steps are found, and bodies stand on them."""

import math

import pytest

from studio.core.grounds.ground import Ground
from studio.core.normalized.floor_guesses import with_floor_reported
from studio.core.normalized.normalize import captured_steps, detected_contacts, normalize_capture
from studio.core.quality.metrics import acceleration_ratio, contact_quality
from studio.core.solver.adapt import adapt
from studio.core.solver.request import AdaptRequest
from studio.core.solver.source import source_motion
from studio.io.importing import load_capture
from studio.io.project.character_file import bundled_characters
from tests.captures import outside
from tests.climbs import write_climb
from tests.real.taken import HUMANS, RECORDINGS, named, taken

BODIES = {name: character.morphology for name, character in bundled_characters().items()}


@pytest.fixture(scope="module", params=[0.16, -0.16], ids=["up", "down"])
def climbed(request, tmp_path_factory):
    """Steps in the motion's space, and the capture of a walk on them."""
    path = tmp_path_factory.mktemp("steps") / "climb.bvh"
    return write_climb(path, request.param), load_capture(path)


def test_the_steps_of_a_capture_are_found_where_its_feet_stood_and_offered(climbed):
    steps, capture = climbed
    found = captured_steps(capture)
    assert found.count == steps.count
    assert found.rise == pytest.approx(abs(steps.rise), abs=0.01)
    upwards = steps.direction if steps.rise > 0.0 else steps.direction + math.pi
    assert math.cos(found.direction - upwards) > math.cos(math.radians(3.0))
    assert "steps: 4 of 16 cm" in [guess.title[:17] for guess in with_floor_reported(capture).guesses]


def test_feet_on_found_steps_stand_as_long_as_on_the_floor(climbed):
    _, capture = climbed
    level, here = (_frames_by_foot(taken(named("walk"))[0]), _frames_by_foot(capture))
    on_steps = _frames_by_foot(capture, on_steps=True)
    assert sum(on_steps.values()) > 0.9 * sum(level.values())
    assert sum(on_steps.values()) > 1.1 * sum(here.values())


def _frames_by_foot(capture, *, on_steps=False):
    contacts = detected_contacts(capture, "", on_steps=on_steps)
    assert all(each.point.is_foot for each in contacts)
    return {(each.point, each.first): each.last - each.first + 1 for each in contacts}


@pytest.mark.parametrize("level", [False, True], ids=["on the steps", "on the level"])
def test_every_body_stands_on_found_steps_and_walks_on_the_level_without_them(climbed, level):
    _, capture = climbed
    motion, actor = normalize_capture(capture)
    contacts = detected_contacts(capture, "", on_steps=True)
    ground = Ground() if level else captured_steps(capture)
    source = source_motion(motion, actor)
    for name, body in {"actor": actor.morphology, **BODIES}.items():
        adapted = adapt(AdaptRequest(motion, body, contacts, (), ground), capture.first_frame)
        quality = contact_quality(adapted, contacts, ground)
        assert (quality.slide < 1e-3, quality.rise < 2e-3, quality.penetration < 3e-3) == (True, True, True), name
        assert acceleration_ratio(adapted, source) < 4.0, name


@pytest.mark.parametrize("stem", [*RECORDINGS, *outside(*(path.stem for path in HUMANS))])
def test_a_capture_on_a_level_floor_has_no_steps(stem):
    assert captured_steps(taken(named(stem))[0]) is None
