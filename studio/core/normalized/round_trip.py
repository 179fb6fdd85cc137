"""Round-trip error of a capture that is normalised and then restored on its own actor."""

from dataclasses import dataclass

import numpy as np

from studio.core.body.kinematics import joint_world
from studio.core.captures.capture import Capture
from studio.core.normalized.actor import SourceRig
from studio.core.normalized.motion import NormalizedMotion
from studio.core.normalized.realize import restore_joint_poses
from studio.core.rotations import angle_between, from_matrix


@dataclass(frozen=True)
class RoundTrip:
    """Greatest errors over all joints and frames in world space, in metres and radians."""

    position: float
    rotation: float


def round_trip(capture: Capture, motion: NormalizedMotion, actor: SourceRig) -> RoundTrip:
    """Errors between ``capture`` and its normalised ``motion`` restored on its own ``actor``."""
    there, turned = joint_world(capture.skeleton, capture.poses)
    back, turned_back = joint_world(capture.skeleton, restore_joint_poses(motion, actor))
    angles = angle_between(from_matrix(turned), from_matrix(turned_back))
    return RoundTrip(float(np.linalg.norm(back - there, axis=2).max()), float(angles.max()))
