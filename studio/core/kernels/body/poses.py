"""Quaternions of poses, as a ``PoseSequence`` holds them."""

import math

from studio.core.kernels.compiling import kernel


@kernel
def unite_signs(quaternions):
    """Make quaternions (F, J, 4) of any length above zero unit ones, each on the side of the frame before, in place."""
    for frame in range(quaternions.shape[0]):
        for joint in range(quaternions.shape[1]):
            size, dot = 0.0, 0.0
            for part in range(4):
                size += quaternions[frame, joint, part] * quaternions[frame, joint, part]
            length = math.sqrt(size)
            for part in range(4):
                quaternions[frame, joint, part] /= length
                if frame > 0:
                    dot += quaternions[frame, joint, part] * quaternions[frame - 1, joint, part]
            if dot < 0.0:
                for part in range(4):
                    quaternions[frame, joint, part] = -quaternions[frame, joint, part]
