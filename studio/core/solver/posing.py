"""Posing by hand in one frame: rotations of parts that bring a hand, foot or head to a target.

A limb is solved in closed form: the lower segment rotates about its hinge until the end has the target's distance from
the root, then the upper one aims it by the shortest arc; hand or foot keep their world rotation. The head is moved by
rotations of trunk and neck, each a part of the remainder (cyclic coordinate descent).
"""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from studio.core.body.canonical import BodyLayout, BodyPart
from studio.core.rotations import from_matrix, from_rotation_vector, shortest_arc, to_matrix, to_rotation_vector
from studio.core.solver.correction_layer import PosedFrames, segment_turns, with_segments_turned

FloatArray = NDArray[np.float64]
PartRotations = dict[BodyPart, FloatArray]
"""Rotation vectors (3,) of body parts, in the parts' own axes, radians."""

NEARLY_STRAIGHT = 0.999
"""Greatest extension of a limb that is dragged, as a fraction of its length."""
HEAD_CHAIN, HEAD_ROUNDS = (BodyPart.NECK, BodyPart.THORAX, BodyPart.ABDOMEN), 6
"""Parts that move the head, from top to bottom, and number of rounds over them."""
HEAD_GAINS = (0.4, 0.3, 0.6)
"""Fraction of the remaining rotation that each part of ``HEAD_CHAIN`` makes in a round."""


def limb_turns(
    layout: BodyLayout, positions: FloatArray, rotations: FloatArray, upper: BodyPart, target: FloatArray
) -> PartRotations:
    """Rotations of body parts that bring the end of a limb to ``target`` (3,), or as near as the limb reaches.

    ``upper`` is the limb's upper segment; ``positions`` (P, 3) and ``rotations`` (S, 3, 3) are one frame.
    """
    segment = layout.segment_of_part(upper)
    lower, end = layout.part_of_segment(segment + 1), layout.part_of_segment(segment + 2)
    root, middle, tip = positions[list(layout.proximal_points()[segment : segment + 3])]
    above, below = float(np.linalg.norm(middle - root)), float(np.linalg.norm(tip - middle))
    least, most = abs(above - below) + 1e-3, NEARLY_STRAIGHT * (above + below)
    wanted = float(np.clip(np.linalg.norm(target - root), least, max(most, least)))
    hinge = rotations[segment + 1, :, 0]
    angle = _bend(root, middle, tip, hinge, wanted)
    bent = to_matrix(from_rotation_vector(angle * hinge))
    tip = middle + bent @ (tip - middle)
    arc = shortest_arc(_unit(tip - root), _unit(target - root))
    own = rotations[segment]
    moved_end = arc @ bent @ rotations[segment + 2]
    return {
        upper: _vector(own.T @ arc @ own),
        lower: np.array([angle, 0.0, 0.0]),
        end: _vector(moved_end.T @ rotations[segment + 2]),
    }


def head_turns(layout: BodyLayout, positions: FloatArray, rotations: FloatArray, target: FloatArray) -> PartRotations:
    """Rotations of trunk and neck that bring the head's joint towards ``target`` (3,)."""
    found = {part: np.zeros(3) for part in HEAD_CHAIN}
    for _ in range(HEAD_ROUNDS):
        for part, gain in zip(HEAD_CHAIN, HEAD_GAINS, strict=True):
            posed, turns = _with(layout, positions, rotations, found)
            segment = layout.segment_of_part(part)
            pivot = posed[layout.proximal_points()[segment]]
            arc = _vector(shortest_arc(_unit(posed[layout.head_joint] - pivot), _unit(target - pivot)))
            step = gain * turns[segment].T @ arc
            found[part] = to_rotation_vector(_product(found[part], step))
    return found


def composed_rotations(turn: Mapping[BodyPart, FloatArray], before: Mapping[BodyPart, FloatArray]) -> PartRotations:
    """Rotation vectors of the rotations ``before`` followed, in the parts' own axes, by those of ``turn``."""
    return {part: to_rotation_vector(_product(before[part], step)) for part, step in turn.items()}


def _product(first: FloatArray, second: FloatArray) -> FloatArray:
    """Quaternion (4,) of two rotations given by rotation vectors (3,): ``first``, followed by ``second`` in its own
    axes.
    """
    matrices = to_matrix(from_rotation_vector(np.stack([first, second])))
    return from_matrix(matrices[0] @ matrices[1])


def _with(
    layout: BodyLayout, positions: FloatArray, rotations: FloatArray, turns: PartRotations
) -> tuple[FloatArray, FloatArray]:
    """Positions (P, 3) and rotations (S, 3, 3) of a frame with parts rotated by ``turns``."""
    batch = {part: vector[None] for part, vector in turns.items()}
    frame = PosedFrames(positions[None], rotations[None])
    posed = with_segments_turned(layout, frame, segment_turns(layout, batch))
    return posed.positions[0], posed.rotations[0]


def _bend(root: FloatArray, middle: FloatArray, tip: FloatArray, hinge: FloatArray, wanted: float) -> float:
    """Angle in radians about ``hinge`` through ``middle`` that puts the tip ``wanted`` metres from the root; the
    smaller one.
    """
    to_root, to_tip = root - middle, tip - middle
    along = to_tip - (to_tip @ hinge) * hinge
    across = np.cross(hinge, along)
    # |to_root - R(a) to_tip|^2 = |to_root|^2 + |to_tip|^2 - 2 (A cos a + B sin a + C)
    a, b = float(to_root @ along), float(to_root @ across)
    c = float((to_root @ hinge) * (to_tip @ hinge))
    dot = 0.5 * (to_root @ to_root + to_tip @ to_tip - wanted * wanted) - c
    amplitude = float(np.hypot(a, b))
    if amplitude < 1e-9:
        return 0.0
    phase, spread = float(np.arctan2(b, a)), float(np.arccos(np.clip(dot / amplitude, -1.0, 1.0)))
    angles = np.remainder(np.array([phase + spread, phase - spread]) + np.pi, 2.0 * np.pi) - np.pi
    return float(angles[np.abs(angles).argmin()])


def _unit(vector: FloatArray) -> FloatArray:
    """Unit vector (3,) in the direction of a vector."""
    return np.asarray(vector / max(float(np.linalg.norm(vector)), 1e-9))


def _vector(matrix: FloatArray) -> FloatArray:
    """Rotation vector (3,) of a matrix (3, 3)."""
    return to_rotation_vector(from_matrix(matrix))
