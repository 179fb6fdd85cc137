"""Dual quaternion skinning, which keeps the girth of twisted limbs."""

import numpy as np

from studio.core.kernels.compiling import kernel


@kernel
def skin_by_dual_quaternions(vertices, normals, segments, weights, motions, out_vertices, out_normals):
    """Deform (V, 3) vertices and normals in world space by one blended screw motion each.

    q = sum w_j q_j, d = sum w_j (t_j q_j) / 2, both divided by |q|; v' = q v q* + 2 d q* (Kavan et al. 2008,
    "Geometric skinning with approximate dual quaternion blending"). ``motions`` (S, 16) are those of
    ``skinning.segment_motions``: translation in 9 to 11, quaternion x, y, z, w in 12 to 15.
    """
    for v in range(vertices.shape[0]):
        first = motions[segments[v, 0]]
        qx = qy = qz = qw = 0.0
        dx = dy = dz = dw = 0.0
        for influence in range(weights.shape[1]):
            w = np.float64(weights[v, influence])
            if w == 0.0:
                break
            m = motions[segments[v, influence]]
            if m[12] * first[12] + m[13] * first[13] + m[14] * first[14] + m[15] * first[15] < 0.0:
                w = -w
            qx += w * m[12]
            qy += w * m[13]
            qz += w * m[14]
            qw += w * m[15]
            h = 0.5 * w
            dx += h * (m[9] * m[15] + m[10] * m[14] - m[11] * m[13])
            dy += h * (m[10] * m[15] + m[11] * m[12] - m[9] * m[14])
            dz += h * (m[11] * m[15] + m[9] * m[13] - m[10] * m[12])
            dw -= h * (m[9] * m[12] + m[10] * m[13] + m[11] * m[14])
        n = 1.0 / (qx * qx + qy * qy + qz * qz + qw * qw)
        s = 2.0 * n
        r00, r01, r02 = 1 - s * (qy * qy + qz * qz), s * (qx * qy - qz * qw), s * (qx * qz + qy * qw)
        r10, r11, r12 = s * (qx * qy + qz * qw), 1 - s * (qx * qx + qz * qz), s * (qy * qz - qx * qw)
        r20, r21, r22 = s * (qx * qz - qy * qw), s * (qy * qz + qx * qw), 1 - s * (qx * qx + qy * qy)
        tx = s * (dx * qw - dw * qx + dz * qy - dy * qz)
        ty = s * (dy * qw - dw * qy + dx * qz - dz * qx)
        tz = s * (dz * qw - dw * qz + dy * qx - dx * qy)
        x, y, z = np.float64(vertices[v, 0]), np.float64(vertices[v, 1]), np.float64(vertices[v, 2])
        out_vertices[v, 0] = r00 * x + r01 * y + r02 * z + tx
        out_vertices[v, 1] = r10 * x + r11 * y + r12 * z + ty
        out_vertices[v, 2] = r20 * x + r21 * y + r22 * z + tz
        x, y, z = np.float64(normals[v, 0]), np.float64(normals[v, 1]), np.float64(normals[v, 2])
        out_normals[v, 0] = r00 * x + r01 * y + r02 * z
        out_normals[v, 1] = r10 * x + r11 * y + r12 * z
        out_normals[v, 2] = r20 * x + r21 * y + r22 * z
