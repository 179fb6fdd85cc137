"""Fingers are found below the hands by their names in every program's spelling."""

import numpy as np
import pytest

from studio.core.body.finger_joints import Digit, FingerJoint, find_fingers
from studio.core.body.humanoid import BodyMap
from studio.core.body.skeleton import Skeleton
from studio.io.importing import load_capture
from tests.builders import BODY_MAP, make_skeleton


def with_chains(*chains: tuple[str, ...]) -> Skeleton:
    """``make_skeleton`` with chains of joints below the left hand."""
    plain = make_skeleton()
    names, parents = list(plain.names), plain.parents.tolist()
    for chain in chains:
        above = names.index("LeftHand")
        for name in chain:
            parents.append(above)
            above = len(names)
            names.append(name)
    offsets = np.concatenate([plain.offsets, np.full((len(names) - plain.joint_count, 3), 0.02)])
    ends = np.concatenate([plain.end_sites, np.zeros(len(names) - plain.joint_count, bool)])
    return Skeleton(tuple(names), np.array(parents), offsets, ends)


SPELLINGS = {
    "HumanIK": ("LeftHandThumb1 LeftHandThumb2 LeftHandThumb3", "LeftHandRing1 LeftHandRing2 LeftHandRing3"),
    "Mixamo with tips": ("L_Thumb1 L_Thumb2 L_Thumb3 L_Thumb4", "L_Ring1 L_Ring2 L_Ring3 L_Ring4"),
    "Perception Neuron": ("LThumb1 LThumb2 LThumb3", "LeftInHandRing LeftHandRing1 LeftHandRing2 LeftHandRing3"),
    "Unreal": ("thumb_01_l thumb_02_l thumb_03_l", "ring_metacarpal_l ring_01_l ring_02_l ring_03_l"),
    "Biped": ("LFinger0 LFinger01 LFinger02", "LFinger3 LFinger31 LFinger32"),
    "MakeHuman": ("finger1-1.L finger1-2.L finger1-3.L", "finger4-1.L finger4-2.L finger4-3.L"),
    "H-Anim": ("l_thumb1 l_thumb2 l_thumb3", "l_ring_proximal l_ring_middle l_ring_distal"),
    "VRM 1": ("leftThumbMetacarpal leftThumbProximal leftThumbDistal", "leftRingProximal leftRingMid leftRingDistal"),
    "H-Anim 4": (
        "l_carpometacarpal_1 l_metacarpophalangeal_1 l_carpal_interphalangeal_1",
        "l_carpometacarpal_4 l_metacarpophalangeal_4 l_carpal_proximal_interphalangeal_4"
        " l_carpal_distal_interphalangeal_4",
    ),
    "MMD": ("左親指０ 左親指１ 左親指２", "左薬指１ 左薬指２ 左薬指３"),
    "palm without a number": ("LThumb1 LThumb2 LThumb3", "LHandRing LHandRing1 LHandRing2 LHandRing3"),
}
IN_PALM = {"LeftInHandRing", "ring_metacarpal_l", "LHandRing", "l_carpometacarpal_4"}


@pytest.mark.parametrize("program", SPELLINGS)
def test_thumb_and_ring_finger_are_found_joint_by_joint(program):
    thumb, ring = (names.split() for names in SPELLINGS[program])
    skeleton = with_chains(tuple(thumb), tuple(ring))
    found = find_fingers(skeleton, BodyMap.from_json(skeleton, BODY_MAP))
    named = {joint: skeleton.names[place] for joint, place in found.items()}
    outside = [name for name in ring if name not in IN_PALM]
    assert named == {FingerJoint(0, Digit.THUMB, place): thumb[place] for place in range(3)} | {
        FingerJoint(0, Digit.RING, place): outside[place] for place in range(3)
    }


def test_props_in_a_hand_are_no_fingers():
    skeleton = with_chains(("BowString", "Spring"), ("Sword",))
    assert find_fingers(skeleton, BodyMap.from_json(skeleton, BODY_MAP)) == {}


@pytest.mark.parametrize(
    ("stem", "count"), [("pybvh_test3_fingers", 30), ("rokoko_jesse_dance", 30), ("geno_bind_6ch", 30)]
)
def test_real_captures_have_three_joints_in_every_finger(captures, stem, count):
    [path] = (captures / "bvh").rglob(f"{stem}.bvh")
    capture = load_capture(path)
    assert len(find_fingers(capture.skeleton, capture.body_map)) == 30
