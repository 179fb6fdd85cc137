"""Keyed and followed targets on real motions and the five characters: met where they can be, smooth everywhere."""

import numpy as np
import pytest

from studio.core.body.canonical import BodyPart
from studio.core.constraints.balance import BalanceConstraint, Support
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.constraints.follow import FollowBody, FollowTracked
from studio.core.constraints.look_at import EYES_POINT, LookAtConstraint
from studio.core.constraints.position import PositionConstraint
from studio.core.curves.keyed import KeyedPlace
from studio.core.grounds.ground import Ground
from studio.core.quality.metrics import acceleration_ratio, centre_of_mass, contact_quality
from studio.core.quality.report import report_of
from studio.core.solver.adapt import adapt, body_point_positions, solve_constraints
from studio.core.solver.grounding.grounded_motion import ground_motion, grounded_motion_of
from studio.core.solver.performers.followed_tracks import captured_joint_track
from studio.core.solver.request import AdaptRequest
from studio.core.solver.source import source_motion
from tests.captures import outside
from tests.core.motions import ALWAYS
from tests.real.taken import contacts_of, named, taken
from tests.real.test_adaptation import BODIES

LEFT, RIGHT = (BodyPoint(BodyPart(f"{side}_forearm"), at_end=True) for side in ("left", "right"))
ARM, WHOLE = Chain(trunk=0.4, root=0.2), Chain(0, 0, 0, 1, 1)
KICKS = ["kick", *outside("accad_male2_G2_FrontKick")]
MOTIONS = [*KICKS, "walk", *outside("accad_female1_B03_Walk1")]


@pytest.mark.parametrize("name", BODIES)
@pytest.mark.parametrize("stem", MOTIONS)
def test_a_wrist_is_led_along_keys_without_a_jerk(stem: str, name: str) -> None:
    capture, motion, actor = taken(named(stem))
    request = AdaptRequest(motion, BODIES[name], contacts_of(capture))
    path, rate = body_point_positions(RIGHT, adapt(request)), motion.frame_rate
    frames = range(capture.first_frame, motion.frame_count, round(rate / 4))
    keys = KeyedPlace(tuple(k / rate for k in frames), tuple(tuple(path[k] + [0.0, 0.0, 0.04]) for k in frames))
    led = PositionConstraint("m", "Led", RIGHT, ARM, 0, ALWAYS, target=keys)
    adapted = adapt(AdaptRequest(motion, BODIES[name], request.contacts, (led,)), capture.first_frame)
    reached = body_point_positions(RIGHT, adapted)[[k - capture.first_frame for k in frames]]
    assert np.linalg.norm(reached - keys.values, axis=1) == pytest.approx(0.0, abs=3e-4)
    assert contact_quality(adapted, request.contacts, Ground()).slide < 1e-3
    assert acceleration_ratio(adapted, source_motion(motion, actor)) < 3.0


@pytest.mark.parametrize("name", BODIES)
@pytest.mark.parametrize("stem", KICKS)
def test_the_report_of_a_kick_has_every_number_and_a_reason_for_every_miss(stem: str, name: str) -> None:
    capture, motion, _ = taken(named(stem))
    hand = FollowTracked("RightHand")
    constraints = (
        PositionConstraint("m", "As captured", RIGHT, ARM, 0, ALWAYS, target=hand),
        LookAtConstraint("m", "Watch it", EYES_POINT, Chain(1, 1, 0, 0.3), 1, ALWAYS, target=FollowBody(RIGHT)),
        PositionConstraint("m", "Cover", LEFT, ARM, 2, ALWAYS, target=FollowBody(RIGHT)),
    )
    tracks = {hand: captured_joint_track(hand, capture)}
    request = AdaptRequest(motion, BODIES[name], contacts_of(capture), constraints, tracks=tracks)
    adapted = adapt(request)
    report = report_of(grounded_motion_of(request), request, adapted)
    assert np.isfinite(adapted.positions).all()
    assert np.isfinite(report.residuals).all()
    missed = report.residuals > [[2e-4], [np.radians(0.1)], [2e-4]]
    assert (report.winners[missed] != -1).all()
    assert (report.winners[~missed] == -1).all()
    assert np.isfinite(report.knee_speeds).all()


@pytest.mark.parametrize("stem", MOTIONS)
def test_over_the_support_the_mass_moves_as_smoothly_as_in_the_motion(stem: str) -> None:
    capture, motion, _ = taken(named(stem))
    balance = BalanceConstraint("m", "Balance", BodyPoint(BodyPart.PELVIS), WHOLE, 0, ALWAYS, place=Support())
    for body in BODIES.values():
        standing = ground_motion(motion, body, contacts_of(capture), Ground())
        paths = [centre_of_mass(solve_constraints(standing, asked, capture.first_frame)) for asked in ((), (balance,))]
        jerks = [np.linalg.norm(np.diff(path[:, :2], n=2, axis=0), axis=1).max() for path in paths]
        assert jerks[1] < 2.0 * jerks[0]
