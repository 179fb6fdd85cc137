"""A limb that its contact lets go is led to its place, from where it stands round its root, whatever is asked below."""

from dataclasses import replace

import numpy as np
import pytest

from studio.core.body.canonical import BodyPart
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.constraints.follow import FollowTracked
from studio.core.grounds.ground import Ground
from studio.core.solver.adapt import body_point_positions, solve_constraints
from studio.core.solver.asking.releasing import constraint_activations, contact_release, ramped_target
from studio.core.solver.asking.tracks import Track
from studio.core.solver.standing.stand import stand
from studio.io.project.character_file import bundled_characters
from tests.core.motions import target, walk

WALK, CONTACTS = walk(120)
STANDING = stand(WALK, bundled_characters()["tall_man"].morphology, CONTACTS, Ground())
BEFORE, ALL = solve_constraints(STANDING, ()), slice(0, WALK.frame_count)
ANKLE = BodyPoint(BodyPart.LEFT_SHANK, at_end=True)
PLACE = body_point_positions(ANKLE, BEFORE)[60] + [0.1, 0.2, 0.3]
WANTED = target("left_shank", PLACE, Chain(), 0)
SHARES = contact_release((WANTED,), STANDING)[0]
LETS_GO = (SHARES > 0.0) & (SHARES < 1.0)


def test_it_begins_where_the_limb_stands_and_ends_at_the_target() -> None:
    begun, done = (ramped_target(WANTED, PLACE[None], np.full(WALK.frame_count, s), STANDING, ALL) for s in (0.0, 1.0))
    assert begun == pytest.approx(body_point_positions(ANKLE, BEFORE), abs=1e-12)
    assert np.array_equal(np.broadcast_to(done, begun.shape), np.broadcast_to(PLACE, begun.shape))


def test_on_its_way_it_is_as_far_from_the_root_as_lies_between_and_never_below_its_contact() -> None:
    hip = BEFORE.positions[:, BEFORE.morphology.layout.hip_point(0)]
    far = [np.linalg.norm(place - hip, axis=1) for place in (body_point_positions(ANKLE, BEFORE), PLACE)]
    led = ramped_target(WANTED, PLACE[None], SHARES, STANDING, ALL)
    over = led[:, 2] - body_point_positions(ANKLE, BEFORE)[:, 2]
    assert over[LETS_GO].min() > -1e-12
    round_root = LETS_GO & (over > 1e-9)
    assert round_root.any()
    between = (1.0 - SHARES) * far[0] + SHARES * far[1]
    assert np.linalg.norm(led - hip, axis=1)[round_root] == pytest.approx(between[round_root], abs=1e-9)


def test_it_is_met_on_its_way_whatever_moves_the_body_below() -> None:
    head = target(
        "head",
        body_point_positions(BodyPoint(BodyPart.HEAD, at_end=True), BEFORE)[60] - [0.2, 0.0, 0.2],
        Chain(trunk=1.0, root=1.0),
        1,
    )
    alone, both = (
        body_point_positions(ANKLE, solve_constraints(STANDING, asked)) for asked in ((WANTED,), (WANTED, head))
    )
    assert np.abs(alone - both)[LETS_GO].max() < 2e-4


def test_a_target_that_nobody_knows_while_it_is_not_asked_stops_nothing() -> None:
    follow = FollowTracked("thing")
    places = np.broadcast_to(PLACE, (WALK.frame_count, 3)).copy()
    wanted = replace(WANTED, target=follow)
    places[constraint_activations((wanted,), STANDING)[0] == 0.0] = np.nan
    adapted = solve_constraints(STANDING, (wanted,), tracks={follow: Track(places, np.eye(3)[None])})
    assert np.isfinite(adapted.positions).all()
