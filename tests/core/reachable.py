"""Targets known to be reachable: where a point is after the parts that may move have been turned at random."""

import numpy as np

from studio.core.body.canonical import BodyPart
from studio.core.body.morphology import Morphology
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.solver.request import AdaptedMotion
from studio.core.solver.task_assembly.points import limb_of, point_indices
from tests.core.twins.body import turn_part
from tests.core.twins.rotation import from_vector


class Mannequin:
    """One frame of an adapted motion, to be bent by hand."""

    def __init__(self, adapted: AdaptedMotion, frame: int, random: np.random.Generator) -> None:
        self.body: Morphology = adapted.morphology
        self.positions, self.rotations = adapted.positions[frame].copy(), adapted.rotations[frame].copy()
        self.random = random

    def turn(self, segment: int, vector: np.ndarray) -> None:
        self.positions, self.rotations = turn_part(
            self.body.layout, from_vector(vector), segment, self.positions, self.rotations
        )

    def jiggle(self, segment: int, most: float) -> None:
        axis = self.random.normal(size=3)
        self.turn(segment, self.random.uniform(0.0, most) * axis / np.linalg.norm(axis))

    def move_root(self) -> None:
        """A little over the ground and down, where standing legs allow it."""
        share = self.random.uniform([-0.02, -0.02, -0.06], [0.02, 0.02, -0.02])
        self.positions = self.positions + self.body.leg_length * share

    def bend(self, upper: int) -> None:
        """Elbow or knee about its hinge, further than it is."""
        self.turn(upper + 1, self.random.uniform(0.0, 0.3) * self.rotations[upper, :, 0])

    def place(self, point: BodyPoint) -> np.ndarray:
        origin, segment = point_indices(point, self.body.layout)
        return self.positions[origin] + self.rotations[segment] @ np.array(point.offset)


def reachable_target(
    adapted: AdaptedMotion, frame: int, point: BodyPoint, chain: Chain, random: np.random.Generator
) -> np.ndarray:
    """(3,) a place where ``point`` can be brought by turning what ``chain`` leaves free; feet keep their rotation."""
    body, spine = adapted.morphology, adapted.morphology.layout.spine_count
    doll = Mannequin(adapted, frame, random)
    limb, side = limb_of(point.part), 0 if point.part.startswith("left") else 1
    if chain.root:
        doll.move_root()
    for vertebra in range(1, spine) if chain.trunk else ():
        doll.jiggle(vertebra, 0.1)
    if chain.clavicle and (limb in (0, 1) or point.part.endswith("clavicle")):
        doll.jiggle(spine + 2 + 4 * side, 0.15)
    if point.part in (BodyPart.NECK, BodyPart.HEAD):
        doll.jiggle(spine, 0.2)
    if point.part is BodyPart.HEAD:
        doll.jiggle(spine + 1, 0.2)
    if limb < 0:
        return doll.place(point)
    upper = spine + (10 if limb >= 2 else 3) + 4 * side
    before = doll.positions[body.layout.ankle_point(side)], doll.place(point)
    doll.jiggle(upper, 0.5)
    doll.bend(upper)
    if point.part.endswith(("foot", "toe")):
        return before[1] + doll.positions[body.layout.ankle_point(side)] - before[0]
    return doll.place(point)
