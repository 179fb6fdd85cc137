"""Real captures come back out of their morphology-independent motion: every joint, every frame."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from studio.core.kernels import channel_columns as channel
from studio.core.normalized.realize import realize_motion
from studio.core.normalized.round_trip import round_trip
from tests.builders import make_morphology
from tests.captures import outside
from tests.real.taken import HUMANS, RECORDINGS, REPRESENTATIVE, named, taken

POSITION, ROTATION = 1e-4, np.deg2rad(0.01)


@pytest.mark.parametrize("stem", [*RECORDINGS, *outside(*REPRESENTATIVE)])
def test_it_comes_back(stem: str) -> None:
    errors = round_trip(*taken(named(stem)))
    assert errors.position < POSITION
    assert errors.rotation < ROTATION


def test_all_humans_come_back(captures: Path) -> None:
    lost = {}
    for path in HUMANS:
        errors = round_trip(*taken(path))
        if errors.position >= POSITION or errors.rotation >= ROTATION:
            lost[path.stem] = errors
    assert lost == {}


@pytest.mark.parametrize("stem", [*RECORDINGS, *outside(*REPRESENTATIVE)])
def test_its_actor_has_the_measures_of_a_person(stem: str) -> None:
    body = taken(named(stem))[2].morphology
    assert 1.2 < body.stature < 2.1
    assert 0.7 < body.leg_length < 1.0
    assert np.allclose(body.leg[0], body.leg[1], rtol=0.1)
    assert ((body.ankle_height > 0.02) & (body.ankle_height < 0.2)).all()


@pytest.mark.parametrize("stem", [*RECORDINGS, *outside(*REPRESENTATIVE)])
def test_single_precision_is_enough_to_store_it(stem: str) -> None:
    """Channels rounded to 32 bits still put every point within a tenth of a millimetre."""
    _, motion, actor = taken(named(stem))
    rounded = replace(motion, channels=motion.channels.astype(np.float32))
    apart = realize_motion(rounded, actor.morphology)[0] - realize_motion(motion, actor.morphology)[0]
    far = 1.0 + np.abs(motion.channels[:, channel.HIPS : channel.HIPS + 2]).max()
    assert np.linalg.norm(apart, axis=-1).max() < 1e-4 * far


@pytest.mark.parametrize(
    "stem", ["kick", "crawl", *outside("accad_male2_G2_FrontKick", "accad_female1_D6_CartWheel", "fair_dab_zup")]
)
def test_more_vertebrae_only_round_the_back(stem: str) -> None:
    """The neck base lies elsewhere on a rounder back; the arms hang from it as before."""
    motion = taken(named(stem))[1]
    necks, arms = [], []
    for count in (3, 4, 6, 12):
        layout = make_morphology(spine_count=count).layout
        positions, _ = realize_motion(motion, make_morphology(spine_count=count))
        necks.append(positions[:, layout.neck_base] - positions[:, 0])
        arms.append(positions[:, layout.collar_point(0) : layout.hip_point(0)] - positions[:, [layout.neck_base]])
    assert np.allclose(arms, arms[0], atol=1e-12)
    assert np.linalg.norm(np.array(necks) - necks[0], axis=-1).max() < 0.03
