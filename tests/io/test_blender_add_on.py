"""The add-on in ``examples/blender``: rigs of other programs stand in Blender as the studio streams a body."""

import os
import subprocess
from pathlib import Path

import numpy as np
import pytest

from studio.core.body.standing import standing_points
from studio.core.normalized.normalize import normalize_capture
from studio.core.normalized.realize import realize_motion
from studio.io.importing import load_capture
from studio.live.streamer import packets_of
from studio.live.vmc import bone_segments, t_pose_axes
from tests.io.blender import VARIABLE
from tests.live.test_streamed_fingers import BODIES, CURL, curled
from tests.patience import SECONDS

ROOT = Path(__file__).parents[2]
ADD_ON, SCRIPT = ROOT / "examples" / "blender" / "morpho_studio_live.py", Path(__file__).with_name("in_blender_live.py")
MIXAMO = {"UpperArm": "Arm", "LowerArm": "ForeArm", "UpperLeg": "UpLeg", "LowerLeg": "Leg", "Toes": "ToeBase",
          "Chest": "Spine1", "UpperChest": "Spine2"}  # fmt: skip
BLENDER = {"UpperArm": "upper_arm", "LowerArm": "forearm", "UpperLeg": "thigh", "LowerLeg": "shin", "Toes": "toe",
           "Hips": "pelvis", "Foot": "foot", "Hand": "hand", "Shoulder": "shoulder", "Spine": "spine", "Chest": "chest",
           "UpperChest": "upper_chest", "Neck": "neck", "Head": "head"}  # fmt: skip


def mixamo(side: str, name: str) -> str:
    return f"mixamorig:{side}{MIXAMO.get(name, name)}"


def blender(side: str, name: str) -> str:
    return f"{BLENDER[name]}.{side[0]}" if side else BLENDER[name]


@pytest.mark.parametrize("lowered", [0.0, 1.0])
@pytest.mark.parametrize("named", [mixamo, blender])
@pytest.mark.parametrize("turned", [(0.0, 0.0, 0.0), (np.pi / 2, 0.0, 0.0)])
def test_a_rig_stands_where_the_streamed_body_does(tmp_path: Path, lowered: float, named, turned) -> None:
    """Joints within 2 mm; in a T-pose or with arms lowered by 57 degrees, Z or Y up inside the armature."""
    python = os.environ.get(VARIABLE)
    if not python:
        pytest.skip(f"{VARIABLE} names no Python with Blender's package bpy")
    motion, actor = normalize_capture(load_capture(ROOT / "examples" / "captures" / "front_kick.bvh"))
    body, frame = actor.morphology, 154
    positions, rotations = (each[frame] for each in realize_motion(motion, body))
    layout, segments = body.layout, bone_segments(body.layout)
    axes = t_pose_axes(body).copy()
    for side, sign in enumerate((1.0, -1.0)):
        turn = -sign * lowered
        about_x = np.array([[1, 0, 0], [0, np.cos(turn), -np.sin(turn)], [0, np.sin(turn), np.cos(turn)]])
        arm = layout.spine_count + 3 + 4 * side
        axes[arm : arm + 3] = about_x @ axes[arm : arm + 3]
    rest = standing_points(body, axes)
    near, far = layout.proximal_points(), layout.distal_points()
    names = [each.name for each in segments]
    split = [next((side for side in ("Left", "Right") if name.startswith(side)), "") for name in names]
    given = [named(side, name[len(side) :]) for side, name in zip(split, names, strict=True)]
    np.savez(
        tmp_path / "in.npz",
        names=given,
        parents=[names.index(each.parent) if each.parent else -1 for each in segments],
        heads=_in_blender(rest[[near[each.segment] for each in segments]]),
        tails=_in_blender(rest[[far[each.segment] for each in segments]]),
        packets=[packet.hex() for packet in packets_of(positions, rotations, body, 0.0)],
        turned=turned,
    )
    environment = {key: value for key, value in os.environ.items() if not key.startswith("PYTHON")}
    command = [python, str(SCRIPT), str(ADD_ON), str(tmp_path / "in.npz"), str(tmp_path / "out.npz")]
    done = subprocess.run(command, capture_output=True, text=True, timeout=SECONDS, env=environment)
    assert done.returncode == 0, done.stdout + done.stderr
    wanted = _in_blender(positions[[near[each.segment] for each in segments]])
    off = np.linalg.norm(np.load(tmp_path / "out.npz")["heads"] - wanted, axis=1)
    assert dict(zip(names, np.round(off, 4), strict=True)) == {name: pytest.approx(0.0, abs=0.002) for name in names}


@pytest.mark.parametrize("named", ["mixamorig:{side}Hand{digit}{n}", "{digit}_0{n}_{s}", "f_{digit}.0{n}.{S}"])
def test_fingers_of_a_rig_bend_as_those_of_the_streamed_body(tmp_path: Path, named: str) -> None:
    """Its fingers are bent by 10 degrees at rest and fanned; they stand within 0.1 mm."""
    python = os.environ.get(VARIABLE)
    if not python:
        pytest.skip(f"{VARIABLE} names no Python with Blender's package bpy")
    body = BODIES["child"]
    segments, near, far = bone_segments(body.layout), body.layout.proximal_points(), body.layout.distal_points()
    rest = standing_points(body, t_pose_axes(body))
    names = [each.name for each in segments]
    given, parents = [mixamo("", name) for name in names], [names.index(e.parent) if e.parent else -1 for e in segments]
    for place, name in enumerate(names):
        side = next((side for side in ("Left", "Right") if name.startswith(side)), "")
        given[place] = mixamo(side, name[len(side) :])
    heads, tails = rest[[near[each.segment] for each in segments]], rest[[far[each.segment] for each in segments]]
    expected = []
    for side, out in (("Left", 1.0), ("Right", -1.0)):
        hand = names.index(f"{side}Hand")
        for fan, digit in zip((0.2, 0.0, -0.1, -0.25), ("Index", "Middle", "Ring", "Pinky"), strict=True):
            ahead = np.array([np.sin(fan), out * np.cos(fan), 0.0])
            root = heads[hand] + 0.08 * ahead
            angles, place, own, parent = np.cumsum(CURL), root, root, hand
            for n in range(3):
                bent = np.cos(0.17) * ahead - np.sin(0.17) * np.array([0.0, 0.0, 1.0])
                spelling = digit.lower() if named.startswith(("{", "f_")) else digit
                given.append(named.format(side=side, digit=spelling, n=n + 1, s=side[0].lower(), S=side[0]))
                heads, tails = np.vstack([heads, own]), np.vstack([tails, own + 0.03 * bent])
                parents.append(parent)
                expected.append(place)
                # Straight in VMC's T-pose, then bent about the axis across the hand.
                straight = np.array([[1, 0, 0], [0, np.cos(angles[n]), 0], [0, -out * np.sin(angles[n]), 0]]) @ ahead
                place, own, parent = place + 0.03 * straight, own + 0.03 * bent, len(given) - 1
    positions, rotations = rest, t_pose_axes(body)
    np.savez(
        tmp_path / "in.npz", names=given, parents=parents, heads=_in_blender(heads), tails=_in_blender(tails),
        packets=[packet.hex() for packet in packets_of(positions, rotations, body, 0.0, curled())], turned=(0, 0, 0),
    )  # fmt: skip
    environment = {key: value for key, value in os.environ.items() if not key.startswith("PYTHON")}
    command = [python, str(SCRIPT), str(ADD_ON), str(tmp_path / "in.npz"), str(tmp_path / "out.npz")]
    done = subprocess.run(command, capture_output=True, text=True, timeout=SECONDS, env=environment)
    assert done.returncode == 0, done.stdout + done.stderr
    found = np.load(tmp_path / "out.npz")["heads"][len(names) :]
    assert np.abs(found - _in_blender(np.array(expected))).max() < 1e-4


def _in_blender(points: np.ndarray) -> np.ndarray:
    """Places (N, 3) of a body that looks along X, as one that looks along -Y."""
    return points @ np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
