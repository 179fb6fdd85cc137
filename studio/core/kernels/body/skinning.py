"""Skinning: vertices transformed by the segments to which they are bound."""

import numpy as np

from studio.core.kernels.compiling import allocating_kernel, kernel


@allocating_kernel
def segment_motions(rest_rotations, rest_origins, rotations, origins, out_motions):
    """Write the motion of each segment from rest as (S, 16): matrix (9), translation (3), quaternion x, y, z, w (4).

    R = R' R_rest^T, t = o' - R o; the quaternion by the largest of its four components (Shepperd 1978).
    """
    for s in range(rotations.shape[0]):
        r = np.zeros((3, 3))
        for i in range(3):
            for j in range(3):
                for k in range(3):
                    r[i, j] += rotations[s, i, k] * rest_rotations[s, j, k]
                out_motions[s, 3 * i + j] = r[i, j]
        for i in range(3):
            moved = r[i, 0] * rest_origins[s, 0] + r[i, 1] * rest_origins[s, 1] + r[i, 2] * rest_origins[s, 2]
            out_motions[s, 9 + i] = origins[s, i] - moved
        trace = r[0, 0] + r[1, 1] + r[2, 2]
        largest = 3
        most = trace
        for i in range(3):
            if r[i, i] > most:
                largest, most = i, r[i, i]
        q = np.zeros(4)
        if largest == 3:
            q[0], q[1], q[2] = r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]
            q[3] = 1 + trace
        else:
            i = largest
            j, k = (i + 1) % 3, (i + 2) % 3
            q[i] = 1 + 2 * r[i, i] - trace
            q[j], q[k], q[3] = r[j, i] + r[i, j], r[k, i] + r[i, k], r[k, j] - r[j, k]
        norm = np.sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3])
        for i in range(4):
            out_motions[s, 12 + i] = q[i] / norm


@kernel
def skin_by_rotation_centres(vertices, normals, centres, segments, weights, motions, out_vertices, out_normals):
    """Deform (V, 3) vertices and normals in world space by the motions (S, 16) of up to four segments each.

    v' = R(q)(v - c) + sum w_j (R_j c + t_j), q the normalised blend of the segments' quaternions and c the
    vertex's centre of rotation: no collapsing elbows (Le and Hodgins 2016, "Real-time skeletal skinning with
    optimized centers of rotation"). Influences are sorted, the heaviest first; zeros end the row.
    """
    for v in range(vertices.shape[0]):
        cx, cy, cz = centres[v, 0], centres[v, 1], centres[v, 2]
        first = motions[segments[v, 0]]
        qx = qy = qz = qw = 0.0
        tx = ty = tz = 0.0
        for influence in range(weights.shape[1]):
            w = np.float64(weights[v, influence])
            if w == 0.0:
                break
            m = motions[segments[v, influence]]
            tx += w * (m[0] * cx + m[1] * cy + m[2] * cz + m[9])
            ty += w * (m[3] * cx + m[4] * cy + m[5] * cz + m[10])
            tz += w * (m[6] * cx + m[7] * cy + m[8] * cz + m[11])
            if m[12] * first[12] + m[13] * first[13] + m[14] * first[14] + m[15] * first[15] < 0.0:
                w = -w
            qx += w * m[12]
            qy += w * m[13]
            qz += w * m[14]
            qw += w * m[15]
        s = 2.0 / (qx * qx + qy * qy + qz * qz + qw * qw)
        r00, r01, r02 = 1 - s * (qy * qy + qz * qz), s * (qx * qy - qz * qw), s * (qx * qz + qy * qw)
        r10, r11, r12 = s * (qx * qy + qz * qw), 1 - s * (qx * qx + qz * qz), s * (qy * qz - qx * qw)
        r20, r21, r22 = s * (qx * qz - qy * qw), s * (qy * qz + qx * qw), 1 - s * (qx * qx + qy * qy)
        x, y, z = vertices[v, 0] - cx, vertices[v, 1] - cy, vertices[v, 2] - cz
        out_vertices[v, 0] = r00 * x + r01 * y + r02 * z + tx
        out_vertices[v, 1] = r10 * x + r11 * y + r12 * z + ty
        out_vertices[v, 2] = r20 * x + r21 * y + r22 * z + tz
        x, y, z = normals[v, 0], normals[v, 1], normals[v, 2]
        out_normals[v, 0] = r00 * x + r01 * y + r02 * z
        out_normals[v, 1] = r10 * x + r11 * y + r12 * z
        out_normals[v, 2] = r20 * x + r21 * y + r22 * z
