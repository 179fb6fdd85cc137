"""Pelvic obliquity under an upright trunk (METHOD section 4)."""

import math

from studio.core.kernels.compiling import kernel, small_kernel

LEG_JOINTS = 5
"""Number of joints of one leg: hip, knee, ankle, ball and tip of the toes."""


@kernel
def tilt_pelvis(hips, apart, most, positions, rotations, out_moved):
    """Tilt each frame's pelvis, in place, so that its left hip rises relative to its right one by ``apart`` (F,)
    metres.

    The tilt stays below ``most`` radians; trunk, arms and legs translate along. ``hips`` are the indices of both hip
    points in ``positions`` (F, P, 3), of which the legs are the last; ``rotations`` (F, S, 3, 3). Writes the
    displacements of the hips, (2, F, 3).
    """
    left, right = hips
    for frame in range(apart.shape[0]):
        points, pelvis = positions[frame], rotations[frame, 0]
        across, aside = points[left, 0] - points[right, 0], points[left, 1] - points[right, 1]
        level = math.hypot(across, aside)
        wide = level**2 + (points[left, 2] - points[right, 2]) ** 2
        angle = most * math.tanh(apart[frame] * level / (wide * most)) if level > 0.0 else 0.0
        if angle == 0.0:
            for side in range(2):
                for axis in range(3):
                    out_moved[side, frame, axis] = 0.0
            continue
        about = aside / level, -across / level, math.cos(angle), math.sin(angle)
        _rotate_pelvis_points(about, hips, points, out_moved[:, frame])
        for axis in range(3):
            column = _rotate_about_level_axis(about, pelvis[0, axis], pelvis[1, axis], pelvis[2, axis])
            pelvis[0, axis], pelvis[1, axis], pelvis[2, axis] = column


@kernel
def _rotate_pelvis_points(about, hips, points, out_moved):
    """Move the ``points`` (P, 3) of a body with its tilting pelvis; writes the displacements (2, 3) of its hips.

    ``about`` has the x and y of the level axis, and cosine and sine of the angle.
    """
    root = points[0]
    for side in range(2):
        hip = points[hips[side]]
        x, y, z = hip[0] - root[0], hip[1] - root[1], hip[2] - root[2]
        turned = _rotate_about_level_axis(about, x, y, z)
        out_moved[side, 0], out_moved[side, 1], out_moved[side, 2] = turned[0] - x, turned[1] - y, turned[2] - z
        for joint in range(hips[side], hips[side] + LEG_JOINTS):
            for axis in range(3):
                points[joint, axis] += out_moved[side, axis]
    x, y, z = points[1, 0] - root[0], points[1, 1] - root[1], points[1, 2] - root[2]
    turned = _rotate_about_level_axis(about, x, y, z)
    x, y, z = turned[0] - x, turned[1] - y, turned[2] - z
    for joint in range(1, hips[0]):
        points[joint, 0] += x
        points[joint, 1] += y
        points[joint, 2] += z


@small_kernel
def _rotate_about_level_axis(about, x, y, z):
    """Vector (x, y, z) rotated about a level axis; ``about`` has the axis' x and y, and cosine and sine of the
    angle.
    """
    axis_x, axis_y, cosine, sine = about
    along = (1.0 - cosine) * (axis_x * x + axis_y * y)
    return (
        cosine * x + sine * axis_y * z + along * axis_x,
        cosine * y - sine * axis_x * z + along * axis_y,
        cosine * z + sine * (axis_x * y - axis_y * x),
    )
