"""Forward kinematics of a whole clip."""

import numpy as np
from numpy.typing import NDArray

from studio.core.kernels.algebra.rotation_matrices import quaternion_to_matrix
from studio.core.kernels.compiling import allocating_kernel

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


@allocating_kernel
def joint_world(
    parents: IntArray,
    local_rotations: FloatArray,
    local_translations: FloatArray,
    out_positions: FloatArray,
    out_rotations: FloatArray,
) -> None:
    """Write world positions (F, J, 3) and rotations (F, J, 3, 3) of joints from their local poses.

    R_j = R_parent Q_j and p_j = p_parent + R_parent t_j, with Q the matrix of the unit quaternion xyzw. ``parents``
    (J,) is -1 for a root; parents come before their children.
    """
    local = np.empty((3, 3))
    for frame in range(local_rotations.shape[0]):
        for joint in range(local_rotations.shape[1]):
            x, y, z, w = local_rotations[frame, joint]
            quaternion_to_matrix(x, y, z, w, local)
            parent = parents[joint]
            for row in range(3):
                if parent < 0:
                    out_positions[frame, joint, row] = local_translations[frame, joint, row]
                    for column in range(3):
                        out_rotations[frame, joint, row, column] = local[row, column]
                    continue
                position = out_positions[frame, parent, row]
                for inner in range(3):
                    position += out_rotations[frame, parent, row, inner] * local_translations[frame, joint, inner]
                out_positions[frame, joint, row] = position
                for column in range(3):
                    total = 0.0
                    for inner in range(3):
                        total += out_rotations[frame, parent, row, inner] * local[inner, column]
                    out_rotations[frame, joint, row, column] = total
