"""Arms stay out of their own body by default, softly."""

from dataclasses import replace

import numpy as np
import pytest

from studio.core.body.canonical import BodyPart
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.constraints.position import PositionConstraint
from studio.core.curves.activation import ActivationCurve
from studio.core.normalized.normalize import detected_contacts
from studio.core.quality.metrics import angular_acceleration
from studio.core.quality.motion_quality import limb_elevations
from studio.core.solver.adapt import adapt
from studio.core.solver.grounding.grounded_motion import grounded_motion_of
from studio.core.solver.request import AdaptRequest
from studio.core.solver.task_assembly.clearance import actor_clearances, arm_distances
from studio.io.project.character_file import bundled_characters
from tests.captures import outside
from tests.real.taken import contacts_of, named, taken

TAKES = ("cmu_max_jumping_jacks", "accad_male2_E11_BlockLeftHigh", "mass_kick", "accad_female1_C20_RunToJumpToWalk")
BODIES = ("child", "stocky_man", "giant")


def _adapted(stem: str, body: str, clears: bool):
    capture, motion, actor = taken(named(stem))
    character = bundled_characters()[body]
    return adapt(
        AdaptRequest(
            motion,
            character.morphology,
            detected_contacts(capture, "motion"),
            volume=character.volume,
            actor=actor.morphology,
            clears=clears,
        )
    )


@pytest.mark.parametrize("body", BODIES)
@pytest.mark.parametrize("stem", ["run", "dance", *outside(*TAKES)])
def test_arms_are_out_of_the_body_where_the_actors_are(stem, body):
    capture, motion, actor = taken(named(stem))
    own, _ = actor_clearances(motion, actor.morphology)
    room = arm_distances(_adapted(stem, body, clears=True))
    deep = np.where(own >= 0.0, np.maximum(-room, 0.0), 0.0)[capture.first_frame :]
    assert deep.max() < 0.005


@pytest.mark.captures
@pytest.mark.parametrize("body", ["adult_woman", "tall_man", "giant"])
def test_a_hand_on_the_hip_does_not_sink_in_with_its_fingers(body):
    """Fingers that lie along the forearm in the capture go into the actor themselves; longer ones go no deeper."""
    capture, motion, actor = taken(named("bvh11_cmu131_metres"))
    own, _ = actor_clearances(motion, actor.morphology)
    depth = -arm_distances(_adapted("bvh11_cmu131_metres", body, clears=True))[capture.first_frame :]
    deeper = depth.max(axis=(1, 2)) + own.min()
    assert (deeper > 0.02).mean() < 0.01


@pytest.mark.parametrize("stem", ["dance", "punch", *outside("cmu_salsa_10")])
def test_the_actors_own_arms_stay_as_they_are(stem):
    """However thick it is taken to be: what touches or seems to be inside touches or is inside."""
    capture, motion, actor = taken(named(stem))
    contacts = contacts_of(capture)
    kept, through = (
        limb_elevations(adapt(AdaptRequest(motion, actor.morphology, contacts, actor=actor.morphology, clears=clears)))
        for clears in (True, False)
    )
    assert np.degrees(np.abs(kept - through)).max() < 3.0


@pytest.mark.parametrize("body", BODIES)
@pytest.mark.parametrize(
    "stem", ["punch", *outside("accad_male2_E4_CrossRight", "accad_male2_E1_JabLeft", "accad_male2_E13_BodyCrossLeft")]
)
def test_a_guard_beside_wide_ribs_is_opened_and_not_lifted(stem, body):
    """An elbow that comes out takes the wrist along, instead of tipping the forearm over."""
    kept, through = (limb_elevations(_adapted(stem, body, clears)) for clears in (True, False))
    assert np.degrees(np.abs(kept - through)).max() < 30.0


@pytest.mark.parametrize("body", BODIES)
@pytest.mark.parametrize("stem", ["run", "dance", *outside(*TAKES)])
def test_coming_out_of_the_body_jolts_no_segment(stem, body):
    first = taken(named(stem))[0].first_frame
    peaks = [
        angular_acceleration(found.rotations[first:], found.frame_rate).max(axis=0)
        for found in (_adapted(stem, body, clears) for clears in (False, True))
    ]
    assert (peaks[1] / np.maximum(peaks[0], 20.0)).max() < 2.0


@pytest.mark.parametrize("stem", ["punch", *outside("accad_male2_E11_BlockLeftHigh")])
def test_any_window_of_frames_is_as_in_the_whole(stem):
    capture, motion, actor = taken(named(stem))
    character = bundled_characters()["stocky_man"]
    contacts = detected_contacts(capture, "motion")
    request = AdaptRequest(
        motion, character.morphology, contacts, volume=character.volume, actor=actor.morphology, clears=True
    )
    np.testing.assert_array_equal(adapt(request, 20, 40).positions, adapt(request).positions[20:41])


@pytest.mark.parametrize("side", [0, 1])
@pytest.mark.parametrize("body", BODIES)
@pytest.mark.parametrize("stem", ["cartwheel", "crawl", *outside("mass_cart")])
def test_a_hand_on_the_ground_stays_there_whatever_is_asked_of_an_arm_around(stem, body, side):
    """Pushing arms out of the solved body leaves it where it is before and after something acts, too."""
    capture, motion, actor = taken(named(stem))
    character, contacts = bundled_characters()[body], contacts_of(capture)
    known = {"volume": character.volume, "actor": actor.morphology, "clears": True}
    request = AdaptRequest(motion, character.morphology, contacts, **known)
    standing = grounded_motion_of(request)
    wrist = character.morphology.layout.wrist_point(side)
    [stands] = [each.standing for each in standing.holds if each.point.value == f"{('left', 'right')[side]}_hand"]
    moment = motion.times[int(np.median(np.flatnonzero(stands)))]
    curve = ActivationCurve(moment - 0.5, moment - 0.25, moment + 0.25, moment + 0.5)
    point = BodyPoint((BodyPart.LEFT_FOREARM, BodyPart.RIGHT_FOREARM)[side], at_end=True)
    target = tuple((standing.positions[round(moment * motion.frame_rate), wrist] + [0.15, 0.1, 0.1]).tolist())
    asked = PositionConstraint("motion", "Reach", point, Chain(trunk=1.0, root=1.0), 0, curve, target=target)
    found = adapt(replace(request, constraints=(asked,), eased=True))
    for hold in standing.holds:
        if hold.point.member == "hand":
            own = character.morphology.layout.wrist_point(hold.point.side)
            moved = np.linalg.norm(found.positions[:, own] - standing.positions[:, own], axis=1)
            assert moved[hold.standing].max() < 1e-3


@pytest.mark.captures
@pytest.mark.parametrize("body", ["adult_woman", "giant"])
def test_arms_that_hang_straight_between_the_knees_swing_out_and_do_not_bend(body):
    """A straight arm comes a little nearer to its shoulder only by bending its elbow a lot."""
    kept, through = (
        limb_elevations(_adapted("accad_female1_A08_CrouchToLie", body, clears=clears)) for clears in (True, False)
    )
    assert np.degrees(np.abs(kept - through)[:49].max()) < 30.0
