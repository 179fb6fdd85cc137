"""Smooth targets have smooth answers, by METHOD's figure: three times what the source and the target bring.

A wish brings a and v^2 / l, the greatest acceleration and speed of its target beside the point that it is for, over a
lever of l = 0.3 m: what a bone of that length must turn at to follow it. The peak of all joints of trunk and arms is to
be at most three times that and the peak of the source together.
"""

import numpy as np
import pytest

from studio.core.body.canonical import BodyPart
from studio.core.constraints.balance import BalanceConstraint
from studio.core.constraints.base import BodyPoint, Chain, Constraint
from studio.core.constraints.follow import FollowTracked
from studio.core.constraints.look_at import EYES, LookAtConstraint
from studio.core.constraints.position import PositionConstraint
from studio.core.grounds.ground import Ground
from studio.core.normalized.transition import QUIET_PEAK
from studio.core.quality.metrics import angular_acceleration
from studio.core.solver.adapt import body_point_positions, solve_constraints
from studio.core.solver.asking.tracks import Track
from studio.core.solver.request import AdaptedMotion
from studio.core.solver.standing.stand import stand
from studio.io.project.character_file import bundled_characters
from tests.core.motions import ALWAYS, local_rotations, walk

BODIES = tuple(character.morphology for character in bundled_characters().values())
WALK, CONTACTS = walk(90)
STANDING = tuple(stand(WALK, body, CONTACTS, Ground()) for body in BODIES)
BEFORE = tuple(solve_constraints(standing, ()) for standing in STANDING)
ARM, TRUNK, WHOLE = Chain(), Chain(trunk=1.0), Chain(trunk=1.0, root=1.0)
KINDS = "wrist", "hand", "elbow", "head", "pelvis", "balance", "look"
PARTS = {"wrist": "forearm", "hand": "hand", "elbow": "upper_arm"}
FURTHEST = {"wrist": 0.35, "hand": 0.35, "elbow": 0.35, "head": 0.14, "pelvis": 0.07}
"""Metres that targets may be from where the motion has their points."""
LEVER, SLOWEST, FASTEST = 0.3, 0.1, 0.5
"""Metres; hertz at which targets sway."""

HARD = (
    *((312, 1), (323, 2), (1202, 2), (103, 3), (158, 3), (387, 3), (538, 3)),
    *((82, 3), (127, 3), (152, 3), (33, 4), (43, 4), (219, 4), (342, 4), (522, 4), (593, 4), (1027, 4), (1303, 4)),
)
"""Seeds and counts of sets in which levels nearly jolt, arms that are held are all but straight, or are at limits."""


class Wishes:
    """Wishes drawn at random: the motion's own points shifted, and swayed by three slow sines."""

    def __init__(self, before: AdaptedMotion, seed: int, count: int) -> None:
        self.before, self.random = before, np.random.default_rng([seed, count])
        self.tracks: dict[FollowTracked, Track] = {}
        self.brings = 0.0
        """Radians a second squared."""
        kinds = self.random.choice(KINDS, size=count, replace=False)
        self.constraints = tuple(self.made(kind, number) for number, kind in enumerate(kinds))

    def made(self, kind: str, number: int) -> Constraint:
        priority, before = int(self.random.integers(3)), self.before
        if kind == "balance":
            chain = Chain(limb=0.0, clavicle=0.0, trunk=1.0, root=1.0)
            return BalanceConstraint("motion", kind, BodyPoint(BodyPart.PELVIS), chain, priority, ALWAYS)
        if kind == "look":
            ahead = body_point_positions(EYES, before) + before.rotations[:, 0] @ np.array([2.0, 0.0, 0.0])
            target = self.sway(number, ahead, 0.6, 2.0)
            return LookAtConstraint("motion", kind, EYES, Chain(0, 0, 1, 1), priority, ALWAYS, target=target)
        point, chain = self.point_and_chain(kind)
        shift = self.random.normal(size=3)
        shift *= FURTHEST[kind] * self.random.uniform(0.2, 1.0) / np.linalg.norm(shift)
        target = self.sway(number, body_point_positions(point, before) + shift, 0.4 * FURTHEST[kind], LEVER)
        return PositionConstraint("motion", f"{kind} {number}", point, chain, priority, ALWAYS, target=target)

    def point_and_chain(self, kind: str) -> tuple[BodyPoint, Chain]:
        side = ("left", "right")[self.random.integers(2)]
        if kind == "pelvis":
            return BodyPoint(BodyPart.PELVIS), Chain(0, 0, 0, 0, 1)
        if kind == "head":
            return BodyPoint(BodyPart.HEAD, at_end=True), Chain(0, 0, 1, 1, float(self.random.integers(2)))
        return BodyPoint(BodyPart(f"{side}_{PARTS[kind]}"), at_end=True), (ARM, TRUNK, WHOLE)[self.random.integers(3)]

    def sway(self, number: int, places: np.ndarray, widest: float, lever: float) -> FollowTracked:
        """Something to follow that sways about ``places`` (F, 3), seen over a lever in metres."""
        times = np.arange(len(places))[:, None] / self.before.frame_rate
        rates = 2.0 * np.pi * self.random.uniform(SLOWEST, FASTEST, size=(3, 1, 1))
        phases = rates * times + 2.0 * np.pi * self.random.uniform(size=(3, 1, 3))
        aside = widest * self.random.normal(size=(3, 1, 3)) / 3.0
        speed = np.linalg.norm((aside * rates * np.cos(phases)).sum(axis=0), axis=1)
        push = np.linalg.norm((aside * rates**2 * np.sin(phases)).sum(axis=0), axis=1)
        self.brings += float(((push + speed**2 / lever) / lever).max())
        follow = FollowTracked(f"{number}")
        self.tracks[follow] = Track(places + (aside * np.sin(phases)).sum(axis=0), np.eye(3)[None])
        return follow


def _peak(seed: int, count: int) -> float:
    """The peak beside what source and wishes bring together."""
    standing, before = STANDING[seed % len(BODIES)], BEFORE[seed % len(BODIES)]
    wishes, upper = Wishes(before, seed, count), before.morphology.layout.spine_count + 10
    solved = solve_constraints(standing, wishes.constraints, tracks=wishes.tracks, eased=True)
    source, peak = (
        angular_acceleration(local_rotations(each)[:, :upper], each.frame_rate).max() for each in (before, solved)
    )
    return float(peak / (max(source, QUIET_PEAK) + wishes.brings))


@pytest.mark.parametrize("count", [1, 2, 3, 4])
def test_wishes_that_move_smoothly_move_few_joints_with_a_jerk(count: int) -> None:
    """Of 680 sets, 170 of each count, 16 break the law of three times, all of several wishes; the worst has 7.9."""
    hard = [seed for seed, number in HARD if number == count]
    peaks = [_peak(seed, count) for seed in (*range(40), *hard)]
    assert np.quantile(peaks, 0.95) < 3.0
