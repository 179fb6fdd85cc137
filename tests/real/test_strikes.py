"""The assistant's proposals on real captures, beside the labels that came with them."""

import re

import pytest

from examples.keyed import front_kick, straight_punch
from studio.core.normalized.realize import realize_motion
from studio.library.clip_labels import Limb
from studio.library.proposed_strikes import proposed_labels
from tests.captures import CAPTURES, outside
from tests.real.taken import RECORDINGS, named, taken

FROM_ITS_SOURCE = re.compile(r"kind( and side)?: (file name|CMU index)")
NO_STRIKES = (
    "accad_male2_E11_BlockLeftHigh", "accad_male2_E20_DodgeRight", "accad_male2_E21_DuckLeft",
    "accad_male2_D15_SwitchStance", "accad_male2_E5_Retreat", "accad_male2_A6_BoxLift", "cmu_max_jumping_jacks",
    "accad_female1_C03_Run", "accad_female1_C20_RunToJumpToWalk", "accad_female1_D3_ConversationGestures",
    "accad_female1_D5_RandomStuff2", "accad_female1_D6_CartWheel", "mass_backflip", "mass_cart", "mass_pirouette",
    "accad_female1_B03_Walk1", "fair_dab_zup", "cmu01_03_climb", "cmu_salsa_10", "pybvh_cmu_12_01_walk",
    "rokoko_jesse_dance", "bvh11_cmu131_metres",
)  # fmt: skip


def proposals(stem):
    capture, motion, actor = taken(named(stem))
    posed = realize_motion(motion, actor.morphology, play=True)
    return proposed_labels(*posed, actor.morphology, motion.frame_rate, capture.first_frame), motion.frame_rate


def labelled_rows():
    """(file, limb, frame) of the strikes whose kind their source tells."""
    text = (CAPTURES / "MANIFEST.md").read_text(encoding="utf-8")
    table = text.partition("## Strike table")[2].partition("\n## ")[0]
    cells = [[cell.strip() for cell in line.strip("| ").split("|")] for line in table.splitlines() if ".bvh |" in line]
    known = [row for row in cells if FROM_ITS_SOURCE.match(row[-1])]
    return [(row[0].removesuffix(".bvh"), Limb[row[3].upper().replace(" ", "_")], int(row[5])) for row in known]


@pytest.mark.parametrize(
    ("stem", "limb", "hit"), [("punch", Limb.RIGHT_ARM, straight_punch.HIT), ("kick", Limb.RIGHT_LEG, front_kick.HIT)]
)
def test_a_recorded_strike_is_proposed_where_it_was_keyed(stem, limb, hit):
    clips, rate = proposals(stem)
    assert any(clip.limb is limb and abs(clip.hit / rate - hit) <= 0.1 for clip in clips)


@pytest.mark.captures
def test_limbs_and_hits_are_those_of_the_labels():
    rows = labelled_rows()
    assert len(rows) == 52
    limbs = hits = 0
    for stem, limb, frame in rows:
        clips, rate = proposals(stem)
        near = [clip for clip in clips if abs(clip.hit - frame) <= 0.4 * rate]
        limbs += bool(near) and all(clip.limb is limb for clip in near)
        hits += any(clip.limb is limb and abs(clip.hit - frame) <= 3 for clip in near)
    assert limbs >= 0.95 * len(rows)
    assert hits >= 0.90 * len(rows)


@pytest.mark.parametrize(
    "stem", [*(name for name in RECORDINGS if name not in ("punch", "kick")), *outside(*NO_STRIKES)]
)
def test_what_is_no_strike_is_not_called_one(stem):
    assert proposals(stem)[0] == []


@pytest.mark.parametrize(
    "stem", ["punch", "kick", *outside("cmu_135_04", "cmu_135_09", "cmu_135_11", "cmu_salsa_10", "bvh11_cmu131_metres")]
)
def test_a_motion_has_the_same_strikes_at_a_quarter_of_its_frame_rate(stem):
    _, motion, actor = taken(named(stem))
    points, turns = realize_motion(motion, actor.morphology, play=True)
    whole = proposed_labels(points, turns, actor.morphology, motion.frame_rate)
    quarter = proposed_labels(points[::4], turns[::4], actor.morphology, motion.frame_rate / 4)
    assert [clip.limb for clip in quarter] == [clip.limb for clip in whole]
    assert all(abs(4 * few.hit - many.hit) <= 8 for few, many in zip(quarter, whole, strict=True))
