"""A reachable target is met within 0.2 mm, on every character."""

import numpy as np
import pytest

from studio.core.body.canonical import BodyPart
from studio.core.body.morphology import Morphology
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.grounds.ground import Ground
from studio.core.quality.metrics import contact_quality
from studio.core.solver.request import AdaptRequest
from studio.io.project.character_file import bundled_characters
from tests.core.grounding import adapt_again
from tests.core.motions import target, walk
from tests.core.reachable import reachable_target

BODIES = {name: character.morphology for name, character in bundled_characters().items()}
WALK, CONTACTS = walk()
FRAME = 30
MET = 2e-4

LIMB, ARM, BACK, ALL = Chain(clavicle=0.0), Chain(), Chain(trunk=1.0), Chain(trunk=1.0, root=1.0)
CLAVICLE, HEAD = Chain(0.0, 0.0, 1.0, 0.0, 0.0), Chain(1.0, 1.0, 1.0, 1.0, 1.0)
CASES = [
    *(
        (BodyPart(f"{side}_{part}"), chain, ends)
        for side in ("left", "right")
        for part, chain, ends in (
            ("hand", LIMB, (False, True)), ("hand", ARM, (False, True)), ("hand", BACK, (False, True)),
            ("hand", ALL, (False, True)), ("forearm", LIMB, (False, True)), ("forearm", ARM, (True,)),
            ("forearm", BACK, (True,)), ("forearm", ALL, (True,)), ("upper_arm", LIMB, (True,)),
            ("upper_arm", ARM, (True,)), ("upper_arm", ALL, (True,)),
            ("clavicle", CLAVICLE, (True,)), ("clavicle", Chain(0.0, 0.0, 1.0, 1.0, 1.0), (True,)),
            ("thigh", LIMB, (True,)), ("shank", LIMB, (False, True)), ("foot", LIMB, (False, True)),
            ("toe", LIMB, (False, True)),
        )
    ),
    (BodyPart.PELVIS, Chain(0.0, 0.0, 0.0, 0.0, 1.0), (False, True)),
    (BodyPart.ABDOMEN, Chain(0.0, 0.0, 0.0, 1.0, 1.0), (False, True)),
    (BodyPart.THORAX, Chain(0.0, 0.0, 0.0, 1.0, 1.0), (False, True)),
    (BodyPart.NECK, HEAD, (False, True)),
    (BodyPart.HEAD, HEAD, (False, True)),
]  # fmt: skip
"""Part, what may move for it, whether its point counts from the near end or the far one."""


def _name(value: object) -> str:
    if isinstance(value, Chain):
        weights = (value.limb, value.end_segment, value.clavicle, value.trunk, value.root)
        return "".join("LECTR"[k] if weight else "-" for k, weight in enumerate(weights))
    return str(value)


@pytest.mark.parametrize(("part", "chain", "ends"), CASES, ids=_name)
def test_it_is_met(part: BodyPart, chain: Chain, ends: tuple[bool, ...]) -> None:
    random = np.random.default_rng(1)
    for body in BODIES.values():
        free = not part.endswith(("thigh", "shank", "foot", "toe"))
        contacts = tuple(one for one in CONTACTS if free or one.point.side != (0 if part.startswith("left") else 1))
        before = adapt_again(AdaptRequest(WALK, body, contacts), FRAME, FRAME)
        for at_end in ends:
            for offset in ((0.0, 0.0, 0.0), (0.02, 0.03, -0.04)):
                for _ in range(4):
                    place = reachable_target(before, 0, BodyPoint(part, offset, at_end), chain, random)
                    asked = target(part, place, chain, offset=offset, at_end=at_end)
                    after = adapt_again(AdaptRequest(WALK, body, contacts, (asked,), limited=free), FRAME, FRAME)
                    assert after.residuals[0, 0] < MET
                    assert contact_quality(after, contacts, Ground()).penetration < 2e-3


@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
def test_both_hands_meet_their_targets_at_once(body: Morphology) -> None:
    random = np.random.default_rng(2)
    before = adapt_again(AdaptRequest(WALK, body, CONTACTS), FRAME, FRAME)
    for chain in (ARM, ALL):
        for _ in range(5):
            asked = tuple(
                target(part, reachable_target(before, 0, BodyPoint(part, at_end=True), chain, random), chain)
                for part in (BodyPart.LEFT_FOREARM, BodyPart.RIGHT_FOREARM)
            )
            after = adapt_again(AdaptRequest(WALK, body, CONTACTS, asked), FRAME, FRAME)
            assert after.residuals.max() < MET


@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
def test_a_hand_is_met_over_the_whole_clip(body: Morphology) -> None:
    """The body walks past its target: it is met in every frame in which the arm is long enough."""
    layout = body.layout
    before = adapt_again(AdaptRequest(WALK, body, CONTACTS))
    place = before.positions[60, layout.collar_point(1) + 1] + 0.75 * body.arm[1].sum() * np.array([0.6, -0.3, -0.74])
    near = np.linalg.norm(before.positions[:, layout.collar_point(1) + 1] - place, axis=1) < 0.95 * body.arm[1].sum()
    after = adapt_again(AdaptRequest(WALK, body, CONTACTS, (target("right_forearm", place, ARM),)))
    assert near.sum() > 20
    assert after.residuals[0, near].max() < MET
