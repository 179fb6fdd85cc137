"""Recordings: keyed motions with the flaws of what a studio of motion capture delivers."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d
from scipy.spatial.transform import Rotation

from studio.core.body.pose import PoseSequence
from studio.core.body.skeleton import Skeleton
from studio.core.rotations import IDENTITY_QUATERNION, inverse, multiply, rotate
from studio.io.bvh.writer import write_bvh

from .box_lift import box_lift
from .cartwheel import cartwheel
from .crawl import crawl
from .curves import FloatArray
from .dance import dance
from .feet import FootPath
from .floor_reach import floor_reach
from .front_kick import front_kick
from .get_up import get_up
from .performer import OUTWARD, make_skeleton
from .run import run
from .solve import solve
from .straight_punch import straight_punch
from .straight_walk import straight_walk
from .targets import AirLeg, ArmTargets, Targets
from .walk_turn import walk_turn

_SLIP, _JITTER = (0.25, 0.95), (0.025, 0.3)
"""Noise of skin that slips and of markers that jitter: seconds of the Gaussian that smooths it, part of the whole."""
_LEVER, _PLANTED = 0.006, 0.002
"""Metres a degree: by how much hips and wrists in the air, and ankles and wrists that stand, are put wrong."""
_DECIMALS = 4


@dataclass(frozen=True)
class Recording:
    """A keyed motion and its flaws."""

    motion: Callable[[float], Targets]
    frame_rate: float
    noise: float = 0.5
    """Degrees, standard deviation of a segment's rotation about each axis."""
    tilt: float = 0.0
    """Degrees by which the floor rises to the left."""
    sinking: float = 0.0
    """Metres by which the floor sinks from the first frame to the last."""
    skipped: float | None = None
    """Part of the recording after which one frame is missing."""
    bent: bool = False
    """True if the skeleton rests with hanging arms and bent elbows and knees instead of in T-pose."""

    def kept(self, frames: int) -> NDArray[np.bool_]:
        """True (F,) for the keyed frames that are not skipped."""
        return np.arange(frames) != (-1 if self.skipped is None else int(self.skipped * frames))


RECORDINGS: Mapping[str, Recording] = {
    "walk": Recording(straight_walk, 120.0, bent=True),
    "walk_on_sinking_floor": Recording(straight_walk, 120.0, sinking=0.05),
    "turn": Recording(walk_turn, 30.0, skipped=0.6),
    "run": Recording(run, 60.0, tilt=2.0, sinking=0.05),
    "box_lift": Recording(box_lift, 24.0, sinking=0.05, bent=True),
    "crawl": Recording(crawl, 30.0, sinking=0.05),
    "get_up": Recording(get_up, 60.0, tilt=2.0, bent=True),
    "floor_reach": Recording(floor_reach, 24.0, tilt=2.0, skipped=0.3),
    "punch": Recording(straight_punch, 120.0, tilt=2.0, bent=True),
    "kick": Recording(front_kick, 60.0, sinking=0.05, skipped=0.7),
    "dance": Recording(dance, 30.0, tilt=2.0, sinking=0.05),
    "cartwheel": Recording(cartwheel, 120.0, skipped=0.4),
}
"""In centimetres with Y up, as BVH is written."""


def write_recording(name: str, path: Path) -> int:
    """Write the recording called ``name`` as BVH and return its number of frames."""
    recording = RECORDINGS[name]
    random = np.random.default_rng([*name.encode()])
    targets = _noisy(recording.motion(recording.frame_rate), recording.noise, random)
    skeleton, poses = make_skeleton(), solve(targets)
    if recording.bent:
        skeleton, poses = _rest_bent(skeleton, poses)
    poses = _flawed(poses, recording)
    write_bvh(path, skeleton, poses, recording.frame_rate, decimals=_DECIMALS)
    return poses.frame_count


def _noisy(targets: Targets, degrees: float, random: np.random.Generator) -> Targets:
    """Add noise of markers on slipping skin; what stands on the ground jitters by a millimetre only."""

    def noise(*shape: int) -> FloatArray:
        """Noise (F, *shape) in degrees."""
        total = np.zeros((len(targets.times), *shape))
        for seconds, part in (_SLIP, _JITTER):
            wandering = gaussian_filter1d(random.normal(size=total.shape), seconds * targets.frame_rate, axis=0)
            total += degrees * part * wandering / wandering.std()
        return total

    def noisy_arm(arm: ArmTargets) -> ArmTargets:
        return replace(
            arm,
            wrist=arm.wrist + _LEVER * noise(3),
            held=None if arm.held is None else arm.held + _PLANTED * noise(3),
            elbow=arm.elbow + np.radians(noise(3)),
            pronation=arm.pronation + noise(),
            flexion=arm.flexion + noise(),
            deviation=arm.deviation + noise(),
            shrug=arm.shrug + noise(),
            thrust=arm.thrust + noise(),
        )

    def noisy_foot(foot: FootPath) -> FootPath:
        return replace(foot, ankle=foot.ankle + _PLANTED * noise(3), yaw=foot.yaw + noise(), toe=foot.toe + noise())

    def noisy_leg(leg: AirLeg) -> AirLeg:
        return replace(leg, thigh=leg.thigh + noise(), knee=leg.knee + noise(), foot=leg.foot + noise())

    left_arm, right_arm = targets.arms
    left_foot, right_foot = targets.feet
    return replace(
        targets,
        pelvis=targets.pelvis + _LEVER * noise(3),
        pelvis_turn=targets.pelvis_turn + noise(3),
        chest_turn=targets.chest_turn + noise(3),
        head_turn=targets.head_turn + noise(3),
        arms=(noisy_arm(left_arm), noisy_arm(right_arm)),
        feet=(noisy_foot(left_foot), noisy_foot(right_foot)),
        air={side: noisy_leg(leg) for side, leg in targets.air.items()},
    )


def _flawed(poses: PoseSequence, recording: Recording) -> PoseSequence:
    frames = poses.frame_count
    rotations = poses.local_rotations.copy()
    translations = poses.local_translations.copy()
    floor = Rotation.from_euler("x", recording.tilt, degrees=True)
    rotations[:, 0] = multiply(floor.as_quat(), rotations[:, 0])
    translations[:, 0] = floor.apply(translations[:, 0])
    translations[:, 0, 2] -= np.linspace(0.0, recording.sinking, frames)
    kept = recording.kept(frames)
    return PoseSequence(rotations[kept], translations[kept])


def _rest_bent(skeleton: Skeleton, poses: PoseSequence) -> tuple[Skeleton, PoseSequence]:
    """The same motion of a skeleton whose zero pose hangs its arms and bends elbows and knees."""
    bends = {"Spine": (0.0, 4.0, 0.0)}
    for side, out in zip(("Left", "Right"), OUTWARD, strict=True):
        bends[f"{side}Arm"] = (-60.0 * out, 0.0, 0.0)
        bends[f"{side}ForeArm"] = (0.0, 0.0, -20.0 * out)
        bends[f"{side}UpLeg"] = (0.0, -10.0, 0.0)
        bends[f"{side}Leg"] = (0.0, 18.0, 0.0)
        bends[f"{side}Foot"] = (0.0, -8.0, 0.0)
    rest = np.tile(IDENTITY_QUATERNION, (skeleton.joint_count, 1))
    for joint, name in enumerate(skeleton.names):
        bend = Rotation.from_euler("xyz", bends.get(name, (0.0, 0.0, 0.0)), degrees=True).as_quat()
        rest[joint] = multiply(rest[skeleton.parents[joint]], bend) if joint else bend
    carriers = np.concatenate([[IDENTITY_QUATERNION], rest[skeleton.parents[1:]]])
    offsets = rotate(carriers, skeleton.offsets)
    translations = np.tile(offsets, (poses.frame_count, 1, 1))
    translations[:, 0] = poses.local_translations[:, 0]
    rotations = multiply(multiply(carriers, poses.local_rotations), inverse(rest))
    return Skeleton(skeleton.names, skeleton.parents, offsets, skeleton.end_sites), PoseSequence(
        rotations, translations
    )
