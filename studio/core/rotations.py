"""Rotations as unit quaternions (x, y, z, w) and matrices, over arrays of any leading shape."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

FloatArray = NDArray[np.float64]

IDENTITY_QUATERNION: FloatArray = np.array([0.0, 0.0, 0.0, 1.0])
IDENTITY_QUATERNION.setflags(write=False)
UNIT_LENGTH_TOLERANCE = 4.0 * float(np.finfo(np.float64).eps)
"""Largest difference from 1, by rounding alone, of the length of a normalised vector."""
_SIX_DIGITS = 1e-6
_BLOCK = 1 << 14
"""Number of rotations processed at a time, so that the data stay in the processor's cache."""


def from_euler(order: str, angles: FloatArray) -> FloatArray:
    """Quaternions (..., 4) of intrinsic rotations by ``angles`` (..., n), radians, about one to three axes in
    ``order``.

    The order ``"ZXY"`` rotates about Z, then about the rotated X and Y: as a matrix R_Z R_X R_Y.
    """
    angles = np.asarray(angles, dtype=np.float64)
    flat, turned = angles.reshape(-1, len(order)), np.empty((angles.size // len(order), 4))
    for start in range(0, len(flat), _BLOCK):
        turned[start : start + _BLOCK] = _turn_about(order.upper(), 0.5 * flat[start : start + _BLOCK].T).T
    return turned.reshape(*angles.shape[:-1], 4)


def from_rotation_vector(vectors: FloatArray) -> FloatArray:
    """Unit quaternions (..., 4) of rotation vectors (..., 3) in radians."""
    vectors = np.asarray(vectors, dtype=np.float64)
    half = 0.5 * np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.concatenate([0.5 * np.sinc(half / np.pi) * vectors, np.cos(half)], axis=-1)


def to_rotation_vector(quaternions: FloatArray) -> FloatArray:
    """Rotation vectors (..., 3) in radians, at most pi long, of unit quaternions (..., 4)."""
    q = np.asarray(quaternions, dtype=np.float64)
    q = np.where(q[..., 3:] < 0.0, -q, q)
    sine = np.linalg.norm(q[..., :3], axis=-1, keepdims=True)
    half = np.arctan2(sine, q[..., 3:])
    return np.asarray(2.0 * q[..., :3] / np.maximum(np.sinc(half / np.pi), 1e-12))


def _turn_about(order: str, halves: FloatArray) -> FloatArray:
    """Quaternions as components (4, N) of successive rotations about the axes ``order``, each in the axes rotated
    before; ``halves`` (n, N) are half angles in radians.
    """
    q = np.zeros((4, halves.shape[1]))
    q[3] = 1.0
    for axis, sine, cosine in zip(order, np.sin(halves), np.cos(halves), strict=True):
        i = "XYZ".index(axis)
        j, k = (i + 1) % 3, (i + 2) % 3
        q[[i, j, k, 3]] = (
            q[i] * cosine + q[3] * sine,
            q[j] * cosine + q[k] * sine,
            q[k] * cosine - q[j] * sine,
            q[3] * cosine - q[i] * sine,
        )
    return q


def to_euler(order: str, quaternions: FloatArray) -> FloatArray:
    """Angles (..., 3) in radians of intrinsic rotations in ``order``: the inverse of ``from_euler``.

    At the gimbal lock of the middle angle the third angle is zero; the rotation is still exact.
    """
    x, y, z = ("XYZ".index(axis) for axis in order.upper())
    sign = 1.0 if (y - x) % 3 == 1 else -1.0
    matrices = to_matrix(quaternions)
    sine = np.clip(sign * matrices[..., x, z], -1.0, 1.0)
    cosine = np.hypot(matrices[..., x, x], matrices[..., x, y])
    locked = cosine < 1e-9
    first = np.arctan2(-sign * matrices[..., y, z], matrices[..., z, z])
    third = np.arctan2(-sign * matrices[..., x, y], matrices[..., x, x])
    first = np.where(locked, np.arctan2(sign * matrices[..., z, y], matrices[..., y, y]), first)
    return np.stack([first, np.arctan2(sine, cosine), np.where(locked, 0.0, third)], axis=-1)


def rotations_about_z(angles: ArrayLike) -> FloatArray:
    """Matrices (..., 3, 3) of rotations about Z by ``angles`` (...) in radians."""
    about = np.asarray(angles, dtype=np.float64)
    turns = np.zeros((*about.shape, 3, 3))
    turns[..., 0, 0] = turns[..., 1, 1] = np.cos(about)
    turns[..., 1, 0], turns[..., 0, 1], turns[..., 2, 2] = np.sin(about), -np.sin(about), 1.0
    return turns


def to_matrix(quaternions: FloatArray) -> FloatArray:
    """Matrices (..., 3, 3) that act on columns, of unit quaternions (..., 4)."""
    x, y, z, w = np.moveaxis(np.asarray(quaternions, dtype=np.float64), -1, 0)
    matrix = np.empty((*x.shape, 3, 3))
    matrix[..., 0, 0], matrix[..., 1, 1] = 1 - 2 * (y * y + z * z), 1 - 2 * (x * x + z * z)
    matrix[..., 2, 2] = 1 - 2 * (x * x + y * y)
    matrix[..., 0, 1], matrix[..., 1, 0] = 2 * (x * y - z * w), 2 * (x * y + z * w)
    matrix[..., 0, 2], matrix[..., 2, 0] = 2 * (x * z + y * w), 2 * (x * z - y * w)
    matrix[..., 1, 2], matrix[..., 2, 1] = 2 * (y * z - x * w), 2 * (y * z + x * w)
    return matrix


def from_matrix(matrices: FloatArray) -> FloatArray:
    """Unit quaternions (..., 4) of rotation matrices (..., 3, 3), by their largest component (Shepperd 1978).

    For a matrix that is not a rotation to six digits, the nearest rotation, found by scipy; ValueError for a
    reflection.
    """
    flat = np.reshape(np.asarray(matrices, dtype=np.float64), (-1, 3, 3))
    trace = flat[:, 0, 0] + flat[:, 1, 1] + flat[:, 2, 2]
    largest = np.argmax([flat[:, 0, 0], flat[:, 1, 1], flat[:, 2, 2], trace], axis=0)
    scaled = np.empty((len(flat), 4))  # four times the largest component times the quaternion
    for i in range(3):
        rows = np.flatnonzero(largest == i)
        m, j, k = flat[rows], (i + 1) % 3, (i + 2) % 3
        scaled[rows, i] = 1.0 - trace[rows] + 2.0 * m[:, i, i]
        scaled[rows, j], scaled[rows, k] = m[:, j, i] + m[:, i, j], m[:, k, i] + m[:, i, k]
        scaled[rows, 3] = m[:, k, j] - m[:, j, k]
    rows = np.flatnonzero(largest == 3)
    m = flat[rows]
    scaled[rows, 0], scaled[rows, 1] = m[:, 2, 1] - m[:, 1, 2], m[:, 0, 2] - m[:, 2, 0]
    scaled[rows, 2], scaled[rows, 3] = m[:, 1, 0] - m[:, 0, 1], 1.0 + trace[rows]
    squares = np.einsum("ni,ni->n", scaled, scaled)
    quaternions = scaled / np.sqrt(np.where(squares > 0.0, squares, 1.0))[:, None]
    # Sheared or mirrored; NaN is one as well.
    upright = np.abs(np.swapaxes(flat, 1, 2) @ flat - np.eye(3)).max(axis=(1, 2)) < _SIX_DIGITS
    other = ~(upright & (np.abs(squares - 4.0 * scaled[np.arange(len(flat)), largest]) < _SIX_DIGITS))
    if other.any():
        from scipy.spatial.transform import Rotation

        quaternions[other] = Rotation.from_matrix(flat[other]).as_quat()
    return quaternions.reshape(*np.shape(matrices)[:-2], 4)


def multiply(first: FloatArray, second: FloatArray) -> FloatArray:
    """Product (..., 4) of quaternions: the rotation ``second`` followed by ``first``, as with matrices."""
    a, b = np.broadcast_arrays(first, second)
    vector = a[..., 3:] * b[..., :3] + b[..., 3:] * a[..., :3] + np.cross(a[..., :3], b[..., :3])
    scalar = a[..., 3:] * b[..., 3:] - np.sum(a[..., :3] * b[..., :3], axis=-1, keepdims=True)
    return np.concatenate([vector, scalar], axis=-1)


def inverse(quaternions: FloatArray) -> FloatArray:
    """Inverse rotations (..., 4) of unit quaternions."""
    opposite: FloatArray = quaternions * np.array([-1.0, -1.0, -1.0, 1.0])
    return opposite


def rotate(quaternions: FloatArray, vectors: FloatArray) -> FloatArray:
    """Vectors (..., 3) rotated by unit quaternions (..., 4)."""
    axis, scalar = np.asarray(quaternions)[..., :3], np.asarray(quaternions)[..., 3:]
    twice = 2 * np.cross(axis, vectors)
    return np.asarray(vectors) + scalar * twice + np.cross(axis, twice)


def normalized(vectors: FloatArray) -> FloatArray:
    """Vectors or quaternions (..., N) scaled to unit length; zero vectors are unchanged."""
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    unit: FloatArray = np.asarray(vectors) / np.where(length > 0.0, length, 1.0)
    return unit


def unit_vectors(vectors: FloatArray) -> FloatArray:
    """Vectors (..., N) scaled to unit length; vectors of unit length are returned to the bit.

    Values read back from a file therefore equal the values written.
    """
    lengths = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.where(np.abs(lengths - 1.0) <= UNIT_LENGTH_TOLERANCE, vectors, vectors / lengths)


def sign_continuous(quaternions: FloatArray) -> FloatArray:
    """The same rotations (F, ..., 4), with signs such that consecutive quaternions have a positive inner product."""
    if len(quaternions) < 2:
        return np.array(quaternions, dtype=np.float64)
    dots = np.einsum("...k,...k->...", quaternions[1:], quaternions[:-1])
    flips = np.cumprod(np.where(dots < 0.0, -1.0, 1.0), axis=0)
    return np.concatenate([quaternions[:1], quaternions[1:] * flips[..., None]])


def angle_between(first: FloatArray, second: FloatArray) -> FloatArray:
    """Angles (...) in radians, 0 to pi, from ``first`` to ``second``; accurate for tiny angles too."""
    between = multiply(inverse(first), second)
    return np.asarray(2 * np.arctan2(np.linalg.norm(between[..., :3], axis=-1), np.abs(between[..., 3])))


def shortest_arc(start: FloatArray, end: FloatArray) -> FloatArray:
    """Matrices (..., 3, 3) of the shortest rotation from unit vectors ``start`` to ``end`` (METHOD (1)).

    c I + [v]x + v v^T / (1 + c) with v = start x end, c = start . end; opposite vectors give a half turn about a fixed
    perpendicular.
    """
    start, end = np.broadcast_arrays(start, end)
    cosine = np.sum(start * end, axis=-1)
    more = 0.5 * np.sum((start + end) ** 2, axis=-1)  # 1 + c, with all its digits where the two are nearly opposite
    opposite = more < 1e-12
    v = np.cross(start, end)
    scale = 1.0 / np.where(opposite, 1.0, more)
    arc = scale[..., None, None] * v[..., :, None] * v[..., None, :] + _cross_matrix(v)
    arc += cosine[..., None, None] * np.eye(3)
    least = np.eye(3)[np.argmin(np.abs(start), axis=-1)]
    axis = normalized(np.cross(start, least))
    half_turn = 2 * axis[..., :, None] * axis[..., None, :] - np.eye(3)
    return np.where(opposite[..., None, None], half_turn, arc)


def frame_along(bone: FloatArray, x_hint: FloatArray) -> FloatArray:
    """Rotation (3, 3) whose z axis is ``bone`` and whose x axis is as near to ``x_hint`` as possible."""
    z = normalized(bone)
    x = x_hint - x_hint @ z * z
    if np.linalg.norm(x) < 1e-6:
        x = np.array([z[1], -z[0], 0.0]) if abs(z[2]) < 0.9 else np.array([0.0, z[2], -z[1]])
    x = normalized(x)
    return np.stack([x, cross(z, x), z], axis=1)


def cross(first: FloatArray, second: FloatArray) -> FloatArray:
    """Cross product (3,) of two vectors (3,); ten times as fast as ``np.cross`` for a single pair."""
    (a, b, c), (x, y, z) = first.tolist(), second.tolist()
    return np.array([b * z - c * y, c * x - a * z, a * y - b * x])


def slerp(first: FloatArray, second: FloatArray, share: FloatArray | float) -> FloatArray:
    """Rotations (..., 4) at the fraction ``share``, from 0 to 1, of the shortest arc from ``first`` to ``second``."""
    share = np.asarray(share, dtype=np.float64)[..., None]
    dot = np.sum(first * second, axis=-1, keepdims=True)
    second = np.where(dot < 0.0, -second, second)
    angle = np.arctan2(np.linalg.norm(second - first, axis=-1), np.linalg.norm(second + first, axis=-1))[..., None] * 2
    sine = np.sin(angle)
    near = sine < 1e-9
    safe = np.where(near, 1.0, sine)
    weight_first = np.where(near, 1.0 - share, np.sin((1.0 - share) * angle) / safe)
    weight_second = np.where(near, share, np.sin(share * angle) / safe)
    return normalized(weight_first * first + weight_second * second)


def _cross_matrix(vectors: FloatArray) -> FloatArray:
    """Matrix [v]x with [v]x u = v x u."""
    matrix = np.zeros((*vectors.shape, 3))
    x, y, z = np.moveaxis(vectors, -1, 0)
    matrix[..., 0, 1], matrix[..., 0, 2], matrix[..., 1, 2] = -z, y, -x
    matrix[..., 1, 0], matrix[..., 2, 0], matrix[..., 2, 1] = z, -y, x
    return matrix
