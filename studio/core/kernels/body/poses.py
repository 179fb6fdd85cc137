"""Normalisation of the quaternions of a ``PoseSequence``."""

import math

from studio.core.kernels.compiling import kernel


@kernel
def normalize_quaternions(quaternions):
    """Normalise quaternions (F, J, 4), in place, and give each the sign nearer to that of the frame before."""
    for frame in range(quaternions.shape[0]):
        for joint in range(quaternions.shape[1]):
            size, dot = 0.0, 0.0
            for component in range(4):
                size += quaternions[frame, joint, component] * quaternions[frame, joint, component]
            length = math.sqrt(size)
            for component in range(4):
                quaternions[frame, joint, component] /= length
                if frame > 0:
                    dot += quaternions[frame, joint, component] * quaternions[frame - 1, joint, component]
            if dot < 0.0:
                for component in range(4):
                    quaternions[frame, joint, component] = -quaternions[frame, joint, component]
