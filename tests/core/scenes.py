"""Random scenes: sets of constraints of every kind, with chains, priorities and targets that move smoothly."""

from collections.abc import Sequence

import numpy as np

from studio.core.body.canonical import BodyPart
from studio.core.constraints.area import AreaConstraint, AreaShape
from studio.core.constraints.balance import BalanceConstraint
from studio.core.constraints.base import BodyPoint, Chain, Constraint
from studio.core.constraints.clear import ClearConstraint
from studio.core.constraints.distance import DistanceConstraint
from studio.core.constraints.follow import FollowTracked
from studio.core.constraints.look_at import EYES_POINT, LookAtConstraint
from studio.core.constraints.orientation import OrientationConstraint
from studio.core.constraints.position import PositionConstraint
from studio.core.solver.adapt import body_point_positions
from studio.core.solver.request import AdaptedMotion
from studio.core.solver.task_assembly.tracks import Track, Tracks
from tests.core.motions import ALWAYS, RATE
from tests.core.twins.rotation import from_vector

HANDLED = tuple(
    BodyPart(part)
    for part in (
        "left_forearm", "right_forearm", "left_hand", "right_hand", "left_upper_arm", "right_upper_arm",
        "head", "thorax", "left_clavicle", "right_clavicle",
    )
)  # fmt: skip
KINDS = "position", "orientation", "look_at", "distance", "balance", "area", "clear"
SHAPES = [shape for shape in AreaShape if shape is not AreaShape.MESH]
FASTEST, WIDEST = 0.8, 0.25
"""Hertz and metres: how targets swing about where the body has its points."""


class Scene:
    """Some constraints on a body that moves as ``before``, and the tracks of what they follow."""

    def __init__(self, before: AdaptedMotion, seed: int, kinds: Sequence[str] = ()) -> None:
        """``kinds`` in order, or one to five drawn at random."""
        self.before, self.random = before, np.random.default_rng(seed)
        self.tracks: Tracks = {}
        drawn = kinds or self.random.choice([*KINDS, "position"], size=self.random.integers(1, 6))
        self.constraints = tuple(getattr(self, kind)(number) for number, kind in enumerate(drawn))

    def common(self, number: int, part: BodyPart | None = None) -> dict[str, object]:
        part = part or HANDLED[self.random.integers(len(HANDLED))]
        weights = np.where(self.random.uniform(size=5) < 0.4, 0.0, self.random.uniform(0.1, 1.0, size=5))
        weights[0] = 1.0
        return {
            "motion_id": "motion", "name": f"{number}", "point": BodyPoint(part, at_end=True), "chain": Chain(*weights),
            "priority": int(self.random.integers(4)), "activation": ALWAYS,
        }  # fmt: skip

    def swing(self, number: int, places: np.ndarray, widest: float = WIDEST) -> FollowTracked:
        """Something to follow that swings smoothly about ``places`` (F, 3)."""
        times = np.arange(self.before.frame_count)[:, None] / RATE
        phase = 2 * np.pi * (self.random.uniform(0.1, FASTEST) * times + self.random.uniform(size=3))
        aside = widest * self.random.normal(size=3)
        follow = FollowTracked(f"{number}")
        turn = from_vector(0.5 * self.random.normal(size=3))
        turns = np.broadcast_to(turn, (len(times), 3, 3))
        self.tracks = {**self.tracks, follow: Track(places + aside * np.sin(phase) + aside[::-1], turns)}
        return follow

    def position(self, number: int) -> Constraint:
        fields = self.common(number)
        return PositionConstraint(
            **fields, target=self.swing(number, body_point_positions(fields["point"], self.before))
        )

    def orientation(self, number: int) -> Constraint:
        fields = self.common(number)
        segment = self.before.morphology.layout.segment_of_part(fields["point"].part)
        follow, times = FollowTracked(f"{number}"), np.arange(self.before.frame_count)[:, None] / RATE
        vectors = 0.4 * self.random.normal(size=3) * np.sin(2 * np.pi * FASTEST * times)
        turned = self.before.rotations[0, segment] @ np.array([from_vector(each) for each in vectors])
        self.tracks = {**self.tracks, follow: Track(np.zeros((len(times), 3)), turned)}
        return OrientationConstraint(**fields, target=follow)

    def look_at(self, number: int) -> Constraint:
        ahead = body_point_positions(EYES_POINT, self.before) + np.array([2.0, 0.0, 0.0])
        fields = {**self.common(number), "point": EYES_POINT}
        return LookAtConstraint(**fields, target=self.swing(number, ahead, 0.5))

    def distance(self, number: int) -> Constraint:
        left, right = self.common(number, BodyPart.LEFT_HAND), BodyPoint(BodyPart.RIGHT_HAND)
        return DistanceConstraint(**left, other=right, distance=float(self.random.choice([0.0, 0.2, 0.5])))

    def balance(self, number: int) -> Constraint:
        fields = {**self.common(number, BodyPart.PELVIS), "chain": Chain(1.0, 0.0, 0.0, 0.0, 1.0)}
        return BalanceConstraint(**fields)

    def area(self, number: int) -> Constraint:
        fields = self.common(number, BodyPart(self.random.choice(["left_hand", "right_hand"])))
        centre = (
            np.median(body_point_positions(fields["point"], self.before), axis=0) + self.random.normal(size=3) * 0.2
        )
        return AreaConstraint(**fields, shape=self.random.choice(SHAPES), centre=tuple(centre), size=(0.6, 0.6, 0.6))

    def clear(self, number: int) -> Constraint:
        return ClearConstraint(**self.common(number, BodyPart.PELVIS), margin=float(self.random.choice([0.0, 0.05])))
