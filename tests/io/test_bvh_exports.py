"""The same body written as a dozen programs write it is read as the same body, whatever they call its joints."""

from pathlib import Path

import numpy as np
import pytest

from studio.core.body.kinematics import joint_world
from studio.core.captures.capture import Capture
from studio.core.normalized.normalize import normalize_capture
from studio.core.normalized.realize import restore_joint_poses
from studio.io.export import write_capture
from studio.io.importing import load_capture
from tests.builders import BODY_MAP
from tests.io.bvh_exports import EXTRAS, Exporter, body, exported, sided

HUMANIK = "Shoulder Arm ForeArm Hand UpLeg Leg Foot ToeBase"
XSENS = "Collar Shoulder Elbow Wrist Hip Knee Ankle Toe"
UNITY = "Shoulder UpperArm LowerArm Hand UpperLeg LowerLeg Foot Toes"
INCH, CMU = 0.0254, 0.0254 / 0.45

PROGRAMS = {
    "Blender, Rigify": Exporter(
        sided(
            "shoulder upper_arm forearm hand thigh shin foot toe",
            "{word}.{S}",
            "spine spine.001 spine.002 spine.004 spine.006",
        ),
        order="XYZ",
        unit=1.0,
        up="Z",
        indent="  ",
    ),
    "Blender, deforming bones below an armature": Exporter(
        sided(
            "DEF-shoulder DEF-upper_arm DEF-forearm DEF-hand DEF-thigh DEF-shin DEF-foot DEF-toe",
            "{word}.{S}",
            "DEF-spine DEF-spine.001 DEF-spine.003 DEF-neck DEF-head",
        ),
        order="XYZ",
        unit=1.0,
        up="Z",
        above="Armature",
        channels_above=False,
    ),
    "Maya, a namespace and rotations first": Exporter(
        sided(HUMANIK, "actor_01:rig:{Side}{word}", "actor_01:rig:Hips rig:Spine rig:Chest rig:Neck rig:Head"),
        order="XYZ",
        rotations_first=True,
    ),
    "MotionBuilder": Exporter(
        sided(HUMANIK, "Character1_{Side}{word}", "Character1_Hips x_Spine x_Chest x_Neck x_Head"),
        above="Character1_Reference",
        all_positions=True,
    ),
    "MotionBuilder, positions from the offsets": Exporter(sided(HUMANIK), all_positions=True, from_offsets=True),
    "Mixamo": Exporter(
        sided(HUMANIK, "mixamorig:{Side}{word}", "mixamorig:Hips x:Spine x:Chest mixamorig:Neck mixamorig:Head")
    ),
    "Rokoko": Exporter(sided("Shoulder Arm ForeArm Hand Thigh Shin Foot Toe"), order="YXZ"),
    "Xsens, 100STYLE": Exporter(
        sided(XSENS, trunk="Hips Chest Chest2 Neck Head"), order="YXZ", all_positions=True, number="{:.6f}"
    ),
    "Perception Neuron": Exporter(
        sided(HUMANIK, "Robot_{Side}{word}", "Robot_Hips x_Spine x_Chest Robot_Neck Robot_Head"),
        order="YXZ",
        all_positions=True,
        line="\r\n",
    ),
    "CMU, its own unit": Exporter(sided(HUMANIK, trunk="Hips LowerBack Spine1 Neck1 Head"), order="ZYX", unit=CMU),
    "CMU, Daz": Exporter(
        sided("Collar Shldr ForeArm Hand Thigh Shin Foot Toe", "{s}{word}", "hip abdomen chest neck head"),
        order="YZX",
        unit=INCH,
    ),
    "LAFAN1": Exporter(sided("Shoulder Arm ForeArm Hand UpLeg Leg Foot Toe"), order="ZYX", ends=False),
    "Bandai Namco": Exporter(
        sided(UNITY, "{word}_{S}"), order="ZYX", above="joint_Root", all_positions=True, number="{:.6f}"
    ),
    "OptiTrack": Exporter(
        sided("Shoulder UArm FArm Hand Thigh Shin Foot Toe", "Skeleton 001:{S}{word}", "Hip Ab Chest Neck Head"),
        order="XYZ",
        unit=1.0,
    ),
    "iPi Soft": Exporter(
        sided("Clavicle Shoulder Forearm Hand Thigh Shin Foot Toe", "{S}{word}", "Hip LowerSpine Chest Neck Head")
    ),
    "DeepMotion": Exporter(
        sided(
            "shoulder arm forearm hand upleg leg foot toebase",
            "{s}_{word}_JNT",
            "hips_JNT spine_JNT chest_JNT neck_JNT head_JNT",
        )
    ),
    "MakeHuman": Exporter(
        sided("Clavicle UpArm LoArm Hand UpLeg LoLeg Foot Toe", "{word}_{S}"), order="ZYX", number="{:.10e}"
    ),
    "Auto-Rig": Exporter(
        sided(
            "shoulder arm_stretch forearm_stretch hand thigh_stretch leg_stretch foot toes_01",
            "{word}.{s}",
            "root.x spine_01.x spine_02.x neck.x head.x",
        )
    ),
    "Unreal": Exporter(
        sided(
            "clavicle upperarm lowerarm hand thigh calf foot ball",
            "{word}_{s}",
            "pelvis spine_01 spine_02 neck_01 head",
        ),
        order="XZY",
        up="Z",
    ),
    "nine channels a joint": Exporter(sided(HUMANIK), order="XYZ", all_positions=True, scales="scale"),
    "scaling": Exporter(sided(HUMANIK), scales="Scaling", changes={"Scaling": "SCALING"}),
    "words of the format in names": Exporter(sided(HUMANIK, "{Side} {word} Joint")),
    "no colons": Exporter(sided(HUMANIK), changes={"Frames:": "Frames", "Frame Time:": "Frame Time"}),
    "a mark before the first letter": Exporter(sided(HUMANIK), line="\r\n", changes={"HIERARCHY": "\ufeffHIERARCHY"}),
    "whispered": Exporter(
        sided(HUMANIK),
        changes={word: word.lower() for word in ("HIERARCHY", "ROOT", "JOINT", "OFFSET", "CHANNELS", "MOTION", "Frame")}
        | {"End Site": "end site", "rotation": "rotation", "position": "position", "Time": "time"},
    ),
    "Reallusion": Exporter(
        sided(
            "Clavicle Upperarm Forearm Hand Thigh Calf Foot ToeBase",
            "CC_Base_{S}_{word}",
            "CC_Base_Hip CC_Base_Waist CC_Base_Spine01 CC_Base_NeckTwist01 CC_Base_Head",
        )
    ),
    "SMPL": Exporter(
        sided(
            "Collar Shoulder Elbow Wrist Hip Knee Ankle Foot",
            "m_avg_{S}_{word}",
            "m_avg_Pelvis m_avg_Spine1 m_avg_Spine2 m_avg_Neck m_avg_Head",
        )
    ),
    "3ds Max Biped": Exporter(
        sided(
            "Clavicle UpperArm Forearm Hand Thigh Calf Foot Toe0",
            "Bip01 {S} {word}",
            "Bip01 Bip01_Spine Bip01_Spine1 Bip01_Neck Bip01_Head",
        )
    ),
    "decimal commas and tabs": Exporter(sided(HUMANIK), changes={".": ",", " ": "\t"}),
    "comments and the end of DOS": Exporter(
        sided(HUMANIK), changes={"MOTION": "# exported on Tuesday\nMOTION\n// rows follow"}, end="\x1a"
    ),
    "old line ends and no indent": Exporter(sided(HUMANIK), line="\r", indent=""),
    "shouted": Exporter(sided(HUMANIK), changes={"rotation": "ROTATION", "Frames:": "FRAMES :", "End Site": "EndSite"}),
}


def opened(folder: Path, program: Exporter) -> Capture:
    (folder / "take.bvh").write_bytes(exported(program).encode())
    return load_capture(folder / "take.bvh")


@pytest.mark.parametrize("program", PROGRAMS)
def test_its_body_is_found_and_moves_as_it_did(tmp_path: Path, program: str) -> None:
    export = PROGRAMS[program]
    capture = opened(tmp_path, export)
    skeleton, poses = body()
    assert capture.body_map is not None, [guess.reason for guess in capture.guesses]
    found = capture.body_map.to_json(capture.skeleton)
    assert found == {part: export.names[name] for part, name in BODY_MAP.items()}
    assert (capture.up_axis, capture.frame_rate) == (export.up, 60.0)
    expected, _ = joint_world(skeleton, poses)
    places, _ = joint_world(capture.skeleton, capture.poses)
    for name, joint in zip(skeleton.names, range(skeleton.joint_count), strict=True):
        if not skeleton.end_sites[joint]:
            own = capture.skeleton.index(export.names.get(name, name))
            assert np.abs(places[:, own] - expected[:, joint]).max() < 1e-4, name


@pytest.mark.parametrize("program", ["Blender, Rigify", "Perception Neuron", "Bandai Namco"])
def test_fingers_eyes_twists_and_props_travel_through_to_the_file_that_is_written(tmp_path: Path, program: str) -> None:
    capture = opened(tmp_path, PROGRAMS[program])
    motion, actor = normalize_capture(capture)
    restored = restore_joint_poses(motion, actor)
    write_capture(capture, tmp_path / "out.bvh")
    back = load_capture(tmp_path / "out.bvh")
    assert back.skeleton.names == capture.skeleton.names
    for name in EXTRAS:
        joint = capture.skeleton.index(name)
        turned = capture.poses.local_rotations[:, joint]
        assert np.abs(back.poses.local_rotations[:, joint] - turned).max() < 1e-6
        assert np.array_equal(np.abs(restored.local_rotations[:, joint]).round(9), np.abs(turned).round(9))


def test_a_body_whose_root_has_no_positions_stands_at_its_offset(tmp_path: Path) -> None:
    capture = opened(tmp_path, Exporter(sided(HUMANIK), travels=False))
    travelling = opened(tmp_path, Exporter(sided(HUMANIK)))
    assert capture.body_map is not None
    assert np.abs(capture.poses.local_translations - capture.skeleton.offsets).max() < 1e-12
    own, expected = (joint_world(each.skeleton, each.poses)[0] for each in (capture, travelling))
    assert np.abs((own - own[:, :1]) - (expected - expected[:, :1])).max() < 1e-6


@pytest.mark.parametrize(("spelled", "rate"), [
    ("0.0083333", 120), ("0.00833", 120), ("0.008333333", 120), (".0333", 30), ("0.0333333", 30), ("0.0417", 24),
    ("0.041708", 1 / 0.041708), ("0.016683", 1 / 0.016683), ("8.333333e-03", 120), ("0.01", 100), ("0.0041667", 240),
])  # fmt: skip
def test_a_rounded_frame_time_is_a_whole_rate_where_its_digits_allow_it(
    tmp_path: Path, spelled: str, rate: float
) -> None:
    capture = opened(tmp_path, Exporter(sided(HUMANIK), changes={f"{1 / 60:.8f}": spelled}))
    assert capture.frame_rate == rate


def test_of_two_bodies_in_a_file_the_first_is_the_actor_and_both_are_kept(tmp_path: Path) -> None:
    text = exported(Exporter(sided(HUMANIK)))
    hierarchy, motion = text.split("MOTION\n")
    head, rows = motion.split(f"{1 / 60:.8f}\n")
    both = hierarchy + hierarchy.removeprefix("HIERARCHY\n") + "MOTION\n" + head + f"{1 / 60:.8f}\n"
    both += "".join(f"{row} {row}\n" for row in rows.splitlines())
    (tmp_path / "duet.bvh").write_text(both)
    capture = load_capture(tmp_path / "duet.bvh")
    assert capture.body_map is not None
    assert capture.body_map.to_json(capture.skeleton)["pelvis"] == "Hips"
    assert capture.skeleton.names[0] == "World"
    assert "Hips_2" in capture.skeleton.names
    assert any("another root" in repair for repair in capture.repairs)


def test_a_calibration_pose_before_the_motion_is_left_out(tmp_path: Path) -> None:
    text = exported(Exporter(sided(HUMANIK)))
    head, rows = text.split(f"{1 / 60:.8f}\n")
    width = len(rows.splitlines()[0].split())
    pose = "0 91 0" + " 60" * (width - 3)
    (tmp_path / "take.bvh").write_text(head.replace("Frames: 40", "Frames: 41") + f"{1 / 60:.8f}\n{pose}\n{rows}")
    assert load_capture(tmp_path / "take.bvh").first_frame == 1
