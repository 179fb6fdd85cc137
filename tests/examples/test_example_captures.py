"""The example captures keep the laws that a good animator keeps by eye."""

from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from examples.keyed.clips import CLIPS
from examples.keyed.performer import BODY, make_skeleton
from examples.keyed.solve import solve
from examples.keyed.strikes import SECOND_ACTOR, STRIKES
from examples.keyed.targets import Targets
from studio.core.body.kinematics import joint_world
from studio.core.captures.capture import Capture
from studio.core.captures.contacts import contact_mask
from studio.core.normalized.normalize import Contacts, capture_contacts
from studio.io.importing import load_capture

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
KEYED = {name: strike.targets for name, strike in STRIKES.items() if name not in SECOND_ACTOR} | dict(CLIPS)
"""Clips written as they were keyed; strikes of the second actor are adapted."""
SIDES = ("Left", "Right")


@dataclass(frozen=True)
class Example:
    name: str
    capture: Capture
    targets: Targets
    contacts: Contacts
    positions: np.ndarray
    rotations: np.ndarray

    @property
    def throws(self) -> bool:
        """True if limbs are thrown: at a target, or over the body."""
        return self.name in ("front_kick", "straight_punch", "handstand", "cartwheel", *STRIKES)

    @property
    def path(self) -> Path:
        return path_of(self.name)

    def track(self, joint: str) -> np.ndarray:
        return self.positions[:, self.capture.skeleton.index(joint)]

    def speed(self, joint: str) -> np.ndarray:
        return np.linalg.norm(np.gradient(self.track(joint), axis=0), axis=1) * self.capture.frame_rate

    def heel(self, side: int) -> np.ndarray:
        foot = self.capture.skeleton.index(f"{SIDES[side]}Foot")
        heel = np.array([-BODY.heel_length[side], 0.0, -BODY.ankle_height[side]])
        return self.positions[:, foot] + self.rotations[:, foot] @ heel

    def flexion(self, upper: str, lower: str, end: str) -> np.ndarray:
        """Degrees between two bones of a limb."""
        bones = np.diff([self.track(joint) for joint in (upper, lower, end)], axis=0)
        bones /= np.linalg.norm(bones, axis=-1, keepdims=True)
        return np.degrees(np.arccos(np.clip(np.sum(bones[0] * bones[1], axis=-1), -1, 1)))


def path_of(name: str) -> Path:
    return EXAMPLES / ("strikes" if name in STRIKES else "captures") / f"{name}.bvh"


@cache
def load(name: str) -> Example:
    capture = load_capture(path_of(name))
    positions, rotations = joint_world(capture.skeleton, capture.poses)
    return Example(name, capture, KEYED[name](), capture_contacts(capture), positions, rotations)


@pytest.fixture(params=KEYED)
def example(request) -> Example:
    return load(request.param)


def test_the_file_is_what_the_script_makes_to_a_hundredth_of_a_millimetre(example):
    skeleton = make_skeleton()
    made, _ = joint_world(skeleton, solve(example.targets))
    order = [example.capture.skeleton.index(name) for name in skeleton.names if not name.endswith("_end")]
    assert np.abs(example.positions[:, order] - made[:, : len(order)]).max() < 1e-5


def test_it_lasts_three_to_twelve_seconds_at_sixty_hertz_in_a_small_file(example):
    assert example.capture.frame_rate == pytest.approx(60.0, abs=1e-3)
    assert 3.0 <= len(example.positions) / 60.0 <= 12.0
    assert example.path.stat().st_size < 500_000


def test_nothing_about_it_has_to_be_guessed_wrong(example):
    assert example.capture.body_map is not None
    assert example.capture.first_frame == 0
    assert abs(example.capture.floor) < 0.005


def test_bones_keep_their_lengths_and_left_equals_right(example):
    parents = example.capture.skeleton.parents[1:]
    bones = np.linalg.norm(example.positions[:, 1:] - example.positions[:, parents], axis=2)
    assert np.ptp(bones, axis=0).max() < 1e-6
    lengths = dict(zip(example.capture.skeleton.names[1:], bones[0], strict=True))
    for name, length in lengths.items():
        if name.startswith("Left"):
            assert length == pytest.approx(lengths[name.replace("Left", "Right", 1)], abs=1e-6)


@pytest.mark.parametrize("side", [0, 1], ids=SIDES)
def test_a_planted_ball_does_not_move_and_a_flat_foot_does_not_either(example, side):
    foot = example.targets.feet[side]
    frames = np.flatnonzero(foot.planted)
    for stand in np.split(frames, np.flatnonzero(np.diff(frames) > 1) + 1):
        toes_down, flat = stand[foot.pitch[stand] >= 0], stand[np.abs(foot.pitch[stand]) < 0.01]
        for joint, still in (("ToeBase", toes_down), ("Foot", flat)):
            if len(still):
                assert np.ptp(example.track(SIDES[side] + joint)[still], axis=0).max() < 1e-3


@pytest.mark.parametrize("side", [0, 1], ids=SIDES)
def test_contacts_are_found_where_they_were_meant(example, side):
    foot, frames = example.targets.feet[side], len(example.positions)
    heel, toe = (contact_mask(example.contacts[f"{SIDES[side].lower()}_{point}"], frames) for point in ("heel", "toe"))
    flat = foot.planted & (np.abs(foot.pitch) < 1)
    flying = np.convolve(foot.planted, np.ones(11), mode="same") == 0
    assert (heel & toe)[flat].mean() > 0.95 if flat.any() else toe[foot.planted].mean() > 0.95
    assert not (heel | toe)[flying].any()


@pytest.mark.parametrize("side", [0, 1], ids=SIDES)
def test_no_part_of_a_foot_goes_into_the_ground(example, side):
    tip = example.track(f"{SIDES[side]}ToeBase_end")[:, 2] - (BODY.toe_height[side] + BODY.toe[side, 2])
    assert example.track(f"{SIDES[side]}ToeBase")[:, 2].min() > BODY.toe_height[side] - 0.001
    assert example.heel(side)[:, 2].min() > -0.001
    assert tip.min() > -0.008  # the toes' joint line; a bent toe is thinner at its tip


@pytest.mark.parametrize("side", [0, 1], ids=SIDES)
def test_knees_and_elbows_never_lock_and_never_pop(example, side):
    knee = example.flexion(*(SIDES[side] + bone for bone in ("UpLeg", "Leg", "Foot")))
    elbow = example.flexion(*(SIDES[side] + bone for bone in ("Arm", "ForeArm", "Hand")))
    for angle in (knee, elbow):
        assert angle.min() > 8.0
        assert angle.max() < 150.0
        assert np.abs(np.diff(angle, 2)).max() < (14.0 if example.throws else 4.5)


def test_accelerations_are_those_of_a_body(example):
    """Metres a second squared: a kicked foot and a thrown fist reach some hundred and fifty, the trunk far less."""
    acceleration = np.linalg.norm(np.diff(example.positions, 2, axis=0), axis=2) * 60.0**2
    trunk = [example.capture.skeleton.index(name) for name in ("Hips", "Spine2", "Head")]
    assert acceleration[:, trunk].max() < 25.0
    assert acceleration.max() < (220.0 if example.throws else 50.0)


@pytest.mark.parametrize(
    ("one", "other", "gap"),
    [
        ("LeftFoot LeftToeBase_end", "RightFoot RightToeBase_end", 0.09),
        ("LeftLeg LeftFoot", "RightLeg RightFoot", 0.09),
        ("LeftFoot LeftToeBase_end", "RightLeg RightFoot", 0.09),
        ("RightFoot RightToeBase_end", "LeftLeg LeftFoot", 0.09),
        ("LeftHand LeftHand_end", "RightHand RightHand_end", 0.06),
        ("LeftForeArm LeftHand_end", "Hips Neck", 0.14),
        ("RightForeArm RightHand_end", "Hips Neck", 0.14),
        ("LeftHand LeftHand_end", "LeftUpLeg LeftLeg", 0.09),
        ("RightHand RightHand_end", "RightUpLeg RightLeg", 0.09),
        ("LeftHand LeftHand_end", "Neck Head_end", 0.14),
        ("RightHand RightHand_end", "Neck Head_end", 0.14),
    ],
)
def test_no_part_of_the_body_goes_through_another(example, one, other, gap):
    assert closest(*map(example.track, (*one.split(), *other.split()))) > gap


def closest(start, end, other_start, other_end):
    """Least distance over all frames between two bones, each taken as a row of points."""
    share = np.linspace(0, 1, 15)[:, None, None]
    bone, other = start + share * (end - start), other_start + share * (other_end - other_start)
    return np.linalg.norm(bone[:, None] - other[None], axis=-1).min()


def test_nothing_ever_stands_quite_still(example):
    """A hold breathes: in every second the head and the chest travel a little."""
    for joint in ("Head", "Spine2"):
        track = example.track(joint)
        travel = [np.ptp(track[k : k + 60], axis=0).max() for k in range(0, len(track) - 60, 20)]
        assert min(travel) > 0.001


def test_hardly_a_frame_rests_as_in_real_captures(example):
    """A living body turns some joint faster than 2 degrees a second; real captures rest in 0 to 1 % of frames."""
    turns = np.swapaxes(example.rotations[:-1], -1, -2) @ example.rotations[1:]
    cosine = np.clip((np.trace(turns, axis1=-2, axis2=-1) - 1.0) / 2.0, -1.0, 1.0)
    speed = np.degrees(np.arccos(cosine)).max(axis=1) * example.capture.frame_rate
    assert (speed < 2.0).mean() < 0.01


def test_the_walk_is_human():
    walk = load("walk_turn")
    hips = walk.track("Hips")
    straight = hips[130:200]
    assert 0.9 < np.linalg.norm(np.diff(straight, axis=0)[:, :2], axis=1).mean() * 60 < 1.5
    assert 0.015 < np.ptp(straight[:, 2]) < 0.05
    knee = walk.flexion("LeftUpLeg", "LeftLeg", "LeftFoot")
    assert 55 < knee[140:200].max() < 72
    assert np.linalg.norm(hips[-1, :2] - hips[0, :2]) < np.ptp(hips[:, 0]) / 2


def test_the_head_turns_before_the_chest_and_the_chest_before_the_hips():
    walk = load("walk_turn")
    yaw = {}
    for joint in ("Head", "Spine2", "Hips"):
        forward = walk.rotations[:, walk.capture.skeleton.index(joint), :, 0]
        heading = np.unwrap(np.arctan2(forward[:, 1], forward[:, 0]))
        yaw[joint] = 200 + int(np.argmax(heading[200:340] > np.radians(70)))
    assert yaw["Head"] + 8 < yaw["Spine2"] < yaw["Hips"]


def test_the_cross_travels_up_the_body_and_goes_straight():
    punch = load("straight_punch")
    fist = punch.track("RightHand")
    fastest = int(np.argmax(punch.speed("RightHand")))
    assert 5.0 < punch.speed("RightHand").max() < 11.0
    turn = {name: punch.rotations[:, punch.capture.skeleton.index(name)] for name in ("Hips", "Spine2")}
    rate = {name: np.linalg.norm(np.diff(matrix, axis=0), axis=(1, 2))[:240].argmax() for name, matrix in turn.items()}
    assert rate["Hips"] < rate["Spine2"] < fastest
    path = fist[fastest - 3 : fastest + 4]
    chord = (path[-1] - path[0]) / np.linalg.norm(path[-1] - path[0])
    aside = np.linalg.norm(np.cross(path - path[0], chord), axis=1)
    assert aside.max() < 0.06


def test_the_kick_reaches_above_the_hip_and_sinks_before_it_rises():
    kick = load("front_kick")
    foot, hips = kick.track("RightFoot"), kick.track("Hips")
    peak = int(np.argmax(np.linalg.norm(foot[:, :2] - hips[:, :2], axis=1)))
    assert foot[peak, 2] > hips[peak, 2]
    assert 6.0 < kick.speed("RightToeBase").max() < 14.0
    lowest = int(np.argmin(hips[:peak, 2]))
    assert hips[lowest, 2] < hips[:60, 2].mean() - 0.02
    assert hips[peak, 2] > hips[:60, 2].mean() + 0.02
    standing = kick.track("LeftFoot")[peak, :2]
    assert np.linalg.norm(hips[peak, :2] - standing) < 0.15


def test_the_hand_rests_where_the_thing_is_taken_and_where_it_is_put():
    reach = load("reach_grasp")
    still = np.flatnonzero(reach.speed("RightHand") < 0.05)
    hand = reach.track("RightHand")
    assert any(1.9 < frame / 60 < 2.4 and hand[frame, 2] > 1.25 for frame in still)
    assert any(4.7 < frame / 60 < 5.3 and hand[frame, 2] < 0.95 and hand[frame, 1] > 0.2 for frame in still)
