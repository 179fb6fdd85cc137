"""Real walks, kicks and punches on the five characters: feet hold, knees do not pop, wrists meet their targets."""

from pathlib import Path

import numpy as np
import pytest

from studio.core.body.canonical import BodyPart
from studio.core.body.morphology import Morphology
from studio.core.constraints.base import Chain
from studio.core.curves.activation import ActivationCurve
from studio.core.grounds.ground import Ground
from studio.core.quality.metrics import acceleration_ratio, contact_quality, swing_depths
from studio.core.solver.adapt import adapt
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.core.solver.source import source_motion
from studio.io.project.character_file import bundled_characters
from tests.captures import outside
from tests.core.motions import target
from tests.real.taken import STRIKES, WALKS, contacts_of, named, taken

BODIES = {name: character.morphology for name, character in bundled_characters().items()}
SHOWN = (
    "bvhtoolbox_walk01", "pybvh_cmu_12_01_walk", "accad_female1_B03_Walk1", "accad_female1_B15_WalkTurnAround180",
    "accad_male2_E5_Retreat", "accad_male2_G2_FrontKick", "accad_male2_G11_RoundhouseLeadingRight", "mass_kick",
    "accad_male2_G4_SpinningBackKick", "accad_male2_E1_JabLeft", "accad_male2_E4_CrossRight",
    "accad_male2_E7_UppercutLeft",
)  # fmt: skip


def _adapted(path: Path, name: str) -> AdaptedMotion:
    capture, motion, _ = taken(path)
    return adapt(AdaptRequest(motion, BODIES[name], contacts_of(capture)))


def _faults(path: Path, name: str) -> list[str]:
    """Faults of a capture on a character, in words."""
    capture, motion, actor = taken(path)
    adapted = _adapted(path, name)
    quality = contact_quality(adapted, contacts_of(capture), Ground())
    ratio = acceleration_ratio(adapted, source_motion(motion, actor))
    depths = swing_depths(adapted, contacts_of(capture), Ground())
    measured = (
        ("slide mm", 1e3 * quality.slide, 1.0), ("rise mm", 1e3 * quality.rise, 2.0),
        ("penetration mm", 1e3 * quality.penetration, 2.0), ("acceleration ratio", ratio, 3.0),
        ("depth in swing mm", 1e3 * float(np.nanmax(depths, initial=0.0)), 1.0),
    )  # fmt: skip
    return [f"{path.stem} on {name}: {what} {value:.2f}" for what, value, most in measured if value > most]


@pytest.mark.parametrize("stem", ["walk", "walk_on_sinking_floor", "turn", "run", "punch", "kick", *outside(*SHOWN)])
def test_its_feet_hold_and_its_knees_do_not_pop(stem: str) -> None:
    assert [fault for name in BODIES for fault in _faults(named(stem), name)] == []


def test_every_walk_kick_and_punch_holds_its_feet_on_every_character(captures: Path) -> None:
    assert len(STRIKES) == 38
    assert len(WALKS) >= 6
    assert [fault for path in {*STRIKES, *WALKS} for name in BODIES for fault in _faults(path, name)] == []


@pytest.mark.parametrize("name", BODIES)
@pytest.mark.parametrize(
    "stem",
    ["walk", "kick", *outside("accad_male2_E1_JabLeft", "accad_male2_G2_FrontKick", "accad_female1_B03_Walk1")],
)
def test_the_character_keeps_its_own_measures(stem: str, name: str) -> None:
    adapted, body = _adapted(named(stem), name), BODIES[name]
    for side in range(2):
        for bone, length in enumerate(body.leg[side]):
            first = body.layout.hip_point(side) + bone
            spans = np.linalg.norm(adapted.positions[:, first + 1] - adapted.positions[:, first], axis=1)
            assert np.allclose(spans, length, atol=1e-9)
    heads = adapted.positions[:, body.layout.head_end, 2]
    assert 0.6 * body.stature < np.median(heads) < 1.05 * body.stature


def _punched(
    body: Morphology, stem: str, part: BodyPart, wrist: int
) -> tuple[AdaptedMotion, AdaptedMotion, np.ndarray]:
    """A punch, the same that hits 10 cm lower and inward, and the frames in which it is to be there."""
    capture, motion, _ = taken(named(stem))
    contacts = contacts_of(capture)
    before = adapt(AdaptRequest(motion, body, contacts))
    moved = before.positions[:, wrist] - before.positions[:, 0]
    hit = capture.first_frame + int(np.argmax(np.linalg.norm(moved[capture.first_frame :, :2], axis=1)))
    time = hit / motion.frame_rate
    curve = ActivationCurve(time - 0.25, time - 0.05, time + 0.05, time + 0.25)
    place = before.positions[hit, wrist] + body.stature * np.array([0.0, 0.0, -0.06])
    asked = target(part, place, Chain(trunk=1.0, root=1.0), activation=curve)
    after = adapt(AdaptRequest(motion, body, contacts, (asked,)))
    return before, after, curve.at(np.arange(motion.frame_count) / motion.frame_rate) == 1.0


@pytest.mark.parametrize("name", BODIES)
@pytest.mark.parametrize(
    "stem", ["punch", *outside("accad_male2_E1_JabLeft", "accad_male2_E3_CrossLeft", "accad_male2_E16_BodyJabLeft")]
)
def test_a_punch_hits_where_it_is_told_and_the_feet_still_hold(stem: str, name: str) -> None:
    body = BODIES[name]
    before, after, full = _punched(body, stem, BodyPart.LEFT_FOREARM, body.layout.wrist_point(0))
    assert full.any()
    assert after.residuals[0, full].max() < 2e-4
    capture, motion, actor = taken(named(stem))
    quality = contact_quality(after, contacts_of(capture), Ground())
    assert quality.slide < 1e-3
    assert max(quality.rise, quality.penetration) < 2e-3
    assert acceleration_ratio(after, source_motion(motion, actor)) < 3.0
    assert not np.array_equal(after.positions, before.positions)
