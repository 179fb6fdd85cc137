"""Priorities are strict on moving captures: whatever is added, in any order, changes nothing of what stands higher."""

import numpy as np
import pytest

from studio.core.body.canonical import BodyPart
from studio.core.constraints.area import AreaConstraint, AreaShape
from studio.core.constraints.balance import BalanceConstraint, Support
from studio.core.constraints.base import BodyPoint, Chain, Constraint
from studio.core.constraints.clear import ClearConstraint
from studio.core.constraints.distance import DistanceConstraint
from studio.core.constraints.follow import FollowBody
from studio.core.constraints.look_at import EYES_POINT, LookAtConstraint
from studio.core.constraints.orientation import OrientationConstraint
from studio.core.constraints.position import PositionConstraint
from studio.core.grounds.ground import Ground
from studio.core.rotations import from_matrix
from studio.core.solver.adapt import body_point_positions, solve_constraints
from studio.core.solver.grounding.grounded_motion import ground_motion
from studio.core.solver.request import AdaptedMotion
from studio.io.project.character_file import bundled_characters
from tests.captures import outside
from tests.core.motions import ALWAYS
from tests.core.twins.rotation import from_vector
from tests.real.taken import contacts_of, named, taken

BODIES = bundled_characters()
CLIPS = (
    "accad_female1_B03_Walk1", "accad_female1_A11_CrawlForward", "accad_male2_A6_BoxLift", "accad_male2_G2_FrontKick",
)  # fmt: skip
KINDS = ("position",) * 4 + ("orientation",) * 2 + ("follow", "look_at", "distance", "area", "balance", "clear")
PARTS = tuple(
    map(
        BodyPart,
        (
            "left_forearm", "right_forearm", "left_hand", "right_hand", "left_upper_arm", "right_upper_arm", "head",
            "thorax", "left_clavicle", "left_shank", "right_shank", "left_thigh", "right_foot",
        ),
    )
)  # fmt: skip
CHANGE = 2e-4
"""Metres or radians."""
SETS, MOST, PARTED = 30, 8, 3
"""Sets a clip and body, wishes in one at most, and by how many tests the sets are tried: slow machines have as much
time for each.
"""
EASED_SETS, LENGTH = 3, 41
"""The same of what is eased, and its frames."""


class _Wishes:
    """Random wishes of one frame of a standing motion: at hand or far out of reach."""

    def __init__(self, before: AdaptedMotion, random: np.random.Generator) -> None:
        self.before, self.random = before, random

    def draw(self, number: int, priority: int, kind: str) -> Constraint:
        part = PARTS[self.random.integers(len(PARTS))]
        weights = np.where(self.random.random(5) < 0.4, 0.0, self.random.uniform(0.1, 1.0, 5))
        weights[0] = 1.0
        common = "motion", f"{number}", BodyPoint(part, at_end=True), Chain(*weights), priority, ALWAYS
        return getattr(self, kind)(*common)

    def near(self, point: BodyPoint) -> tuple[float, ...]:
        """A place 2 cm to 3 m from where a point is."""
        away = self.random.choice([0.02, 0.05, 0.1, 0.2, 0.4, 1.0, 3.0])
        return tuple((body_point_positions(point, self.before)[0] + away * self.random.normal(size=3)).tolist())

    def position(self, motion: str, name: str, point: BodyPoint, *rest: object) -> Constraint:
        return PositionConstraint(motion, name, point, *rest, target=self.near(point))

    def follow(self, motion: str, name: str, point: BodyPoint, *rest: object) -> Constraint:
        other = BodyPart.PELVIS if point.part is BodyPart.HEAD else BodyPart.HEAD
        followed = BodyPoint(other, tuple(0.15 * self.random.normal(size=3)))
        return PositionConstraint(motion, name, point, *rest, target=FollowBody(followed))

    def orientation(self, motion: str, name: str, point: BodyPoint, *rest: object) -> Constraint:
        segment = self.before.morphology.layout.segment_of_part(point.part)
        turn = from_vector(self.random.choice([0.1, 0.4, 1.0]) * self.random.normal(size=3))
        turned = from_matrix(turn @ self.before.rotations[:1, segment])[0]
        return OrientationConstraint(motion, name, BodyPoint(point.part), *rest, target=tuple(turned))

    def look_at(self, motion: str, name: str, _: BodyPoint, *rest: object) -> Constraint:
        return LookAtConstraint(motion, name, EYES_POINT, *rest, target=self.near(EYES_POINT))

    def distance(self, motion: str, name: str, _: BodyPoint, *rest: object) -> Constraint:
        left, right = BodyPoint(BodyPart.LEFT_HAND), BodyPoint(BodyPart.RIGHT_HAND)
        other = (right, BodyPoint(BodyPart.LEFT_THIGH), self.near(left))[self.random.integers(3)]
        return DistanceConstraint(motion, name, left, *rest, other=other, distance=self.random.choice([0.0, 0.2, 0.5]))

    def area(self, motion: str, name: str, _: BodyPoint, *rest: object) -> Constraint:
        point, shapes = BodyPoint(BodyPart.RIGHT_HAND, at_end=True), list(AreaShape)
        shapes.remove(AreaShape.MESH)
        shape = shapes[self.random.integers(len(shapes))]
        return AreaConstraint(motion, name, point, *rest, shape=shape, centre=self.near(point), size=(0.6, 0.6, 0.6))

    def balance(self, motion: str, name: str, _: BodyPoint, chain: Chain, *rest: object) -> Constraint:
        trunk, root = self.random.integers(2, size=2)
        chain = Chain(0.0, 0.0, 0.0, trunk, root, free_arms=self.random.choice([0.5, 1.0]), free_legs=root)
        place = Support() if self.random.random() < 0.5 else None
        return BalanceConstraint(motion, name, BodyPoint(BodyPart.PELVIS), chain, *rest, place=place)

    def clear(self, motion: str, name: str, point: BodyPoint, *rest: object) -> Constraint:
        arms, margin = self.random.choice(["both", "left", "right"]), float(self.random.choice([0.0, 0.02, 0.05]))
        return ClearConstraint(motion, name, point, *rest, arms=arms, margin=margin)


def _drawn(before: AdaptedMotion, random: np.random.Generator) -> tuple[list[Constraint], np.ndarray]:
    """Random wishes, what keeps clear among them, and their priorities."""
    kinds = random.choice(KINDS, size=random.integers(2, MOST + 1)).tolist()
    kinds = [kind for index, kind in enumerate(kinds) if kind != "balance" or index == kinds.index(kind)]
    kinds.insert(random.integers(len(kinds) + 1), "clear")
    drawing, levels = _Wishes(before, random), np.cumsum(random.random(len(kinds)) < 0.8)
    return [drawing.draw(number, int(levels[number]), kind) for number, kind in enumerate(kinds)], levels


@pytest.mark.parametrize("name", BODIES)
@pytest.mark.parametrize("stem", ["box_lift", *outside(*CLIPS)])
@pytest.mark.parametrize("part", range(PARTED))
def test_whatever_is_added_below_changes_nothing_of_what_stands_above(part: int, stem: str, name: str) -> None:
    capture, motion, actor = taken(named(stem))
    body, contacts = BODIES[name], contacts_of(capture)
    standing = ground_motion(motion, body.morphology, contacts, Ground(), body.volume, actor.morphology)
    for seed in range(part, SETS, PARTED):
        random = np.random.default_rng([seed, *name.encode()])
        frame = int(random.integers(capture.first_frame, motion.frame_count))
        wishes, levels = _drawn(solve_constraints(standing, (), frame, frame), random)
        missed = np.full(len(wishes), np.nan)
        for count, added in enumerate(order := random.permutation(len(wishes))):
            now = missed.copy()
            now[order[: count + 1]] = solve_constraints(
                standing, [wishes[c] for c in order[: count + 1]], frame, frame
            ).residuals[:, 0]
            change = np.abs(now - missed)[levels < levels[added]]
            assert not (change > CHANGE).any(), (seed, frame, wishes[added])
            missed = now


@pytest.mark.parametrize("name", ["adult_woman", "giant"])
@pytest.mark.parametrize("stem", ["box_lift", *outside(*CLIPS, "accad_female1_D6_CartWheel")])
@pytest.mark.parametrize("seed", range(1, EASED_SETS + 1))
def test_nor_in_moments_that_are_eased_in_time(seed: int, stem: str, name: str) -> None:
    """But for one in some thousand, where arms are kept clear on the edge of an activation, eased or not."""
    capture, motion, actor = taken(named(stem))
    body, contacts = BODIES[name], contacts_of(capture)
    standing = ground_motion(motion, body.morphology, contacts, Ground(), body.volume, actor.morphology)
    random = np.random.default_rng([seed, *stem.encode(), *name.encode()])
    frame = int(random.integers(capture.first_frame, motion.frame_count))
    wishes, levels = _drawn(solve_constraints(standing, (), frame, frame), random)
    count = len(solve_constraints(standing, (), frame, frame + LENGTH - 1).positions)
    missed, order = np.full((len(wishes), count), np.nan), random.permutation(len(wishes))
    for index in range(0, len(order), 2):  # two at a time: what is eased takes long
        now = missed.copy()
        asked, added = order[: index + 2], order[index : index + 2]
        now[asked] = solve_constraints(
            standing, [wishes[c] for c in asked], frame, frame + LENGTH - 1, eased=True
        ).residuals
        change = np.abs(now - missed)[levels < levels[added].min()]
        assert not (change > CHANGE).any(), (seed, frame, [wishes[c] for c in added])
        missed = now
