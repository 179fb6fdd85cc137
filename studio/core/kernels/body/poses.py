"""Quaternions of poses, as a ``PoseSequence`` holds them."""

import math

from studio.core.kernels.compiling import kernel


@kernel
def normalize_quaternions(quaternions):
    """Normalise quaternions (F, J, 4) of any positive length, each with the sign nearer to the frame
    before, in place.
    """
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
