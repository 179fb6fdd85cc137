"""Hands that touch in captures of people touch on every body."""

import numpy as np
import pytest

from studio.core.captures.contacts import Touch
from studio.core.normalized.normalize import detected_contacts
from studio.core.solver.adapt import adapt
from studio.core.solver.request import AdaptRequest
from studio.core.solver.source import source_motion
from studio.io.project.character_file import bundled_characters
from tests.captures import outside
from tests.real.taken import named, taken

DANCES = ["dance", *outside("cmu_salsa_10", "rokoko_jesse_dance")]
CARRIERS = [
    "box_lift",
    *outside("accad_female1_A05_PickUpBox", "accad_female1_B21_PutDownBoxToWalk", "accad_male2_A6_BoxLift"),
]
BODIES = ("child", "tall_man", "stocky_man", "giant")


def _gaps(found) -> np.ndarray:
    layout = found.morphology.layout
    return np.linalg.norm(found.positions[:, layout.wrist_point(1)] - found.positions[:, layout.wrist_point(0)], axis=1)


def _adapted(stem: str, body: str):
    capture, motion, actor = taken(named(stem))
    character = bundled_characters()[body]
    contacts = detected_contacts(capture, "motion")
    request = AdaptRequest(
        motion, character.morphology, contacts, volume=character.volume, actor=actor.morphology, clears=True
    )
    return adapt(request), source_motion(motion, actor), contacts, capture.first_frame


@pytest.mark.parametrize("body", BODIES)
@pytest.mark.parametrize("stem", DANCES)
def test_wrists_that_are_near_each_other_are_as_near_on_every_body(stem, body):
    found, source, _, first = _adapted(stem, body)
    near = _gaps(source) < 0.25 / 0.85 * source.morphology.leg_length
    near[:first] = False
    scale = found.morphology.arm.sum() / source.morphology.arm.sum()
    off = np.abs(_gaps(found) - scale * _gaps(source))[near]
    assert off.mean() < 0.01


@pytest.mark.parametrize("body", BODIES)
@pytest.mark.parametrize("stem", CARRIERS)
def test_what_is_carried_is_found_and_keeps_its_size(stem, body):
    found, source, contacts, _ = _adapted(stem, body)
    [held] = [each for each in contacts if each.point is Touch.HANDS_ON_THING]
    off = np.abs(_gaps(found) - _gaps(source))[held.first : held.last + 1]
    assert off.mean() < 0.01
