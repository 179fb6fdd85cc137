"""Manual corrections: what they turn, what they leave, and how they blend."""

from dataclasses import replace

import numpy as np
import pytest

from studio.core.body.canonical import BodyPart
from studio.core.body.morphology import Morphology
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.constraints.position import PositionConstraint
from studio.core.curves.activation import ActivationCurve
from studio.core.curves.keyed import KeyedPlace
from studio.core.quality.report import BLOCKED_BY_CORRECTIONS, BLOCKED_BY_NOTHING, fully_active, report_of
from studio.core.rotations import from_matrix, from_rotation_vector, to_matrix, to_rotation_vector
from studio.core.solver.adapt import adapt, body_point_positions, grounded_motion
from studio.core.solver.correction_layer import FREED_FOOT_SPEED
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.core.stage.correction import Correction, KeyedPoses, PoseOffsets, new_correction_range
from tests.builders import make_morphology
from tests.core.motions import walk

WALK, CONTACTS = walk()
BODY = make_morphology()
ALWAYS = ActivationCurve(0.0, 0.0, 100.0, 100.0)
RANGE = ActivationCurve(0.8, 1.0, 1.2, 1.4)
ELBOW = ((BodyPart.LEFT_FOREARM, (0.5, 0.0, 0.0)),)


def correction(turns: tuple = ELBOW, hips: tuple = (0.0, 0.0, 0.0), time: float = 1.1, **changes: object) -> Correction:
    return Correction("Elbow", "p", RANGE, KeyedPoses((time,), (PoseOffsets(turns, hips),)), **changes)  # type: ignore[arg-type]


def request(*corrections: Correction, body: Morphology = BODY, **changes: object) -> AdaptRequest:
    return AdaptRequest(WALK, body, CONTACTS, corrections=corrections, **changes)  # type: ignore[arg-type]


def local(adapted: AdaptedMotion, part: BodyPart) -> np.ndarray:
    """Rotations (F, 3, 3) of a segment in its parent."""
    layout = adapted.morphology.layout
    segment = layout.segment_of_part(part)
    parent = layout.parent_segments()[segment]
    return adapted.rotations[:, parent].transpose(0, 2, 1) @ adapted.rotations[:, segment]


@pytest.mark.parametrize("body", [BODY, make_morphology(1.3, 0.8, 5)])
def test_an_elbow_turns_by_what_its_key_says_and_nothing_else_moves(body: Morphology) -> None:
    plain, posed = adapt(request(body=body)), adapt(request(correction(), body=body))
    times = WALK.times
    turn = to_rotation_vector(
        from_matrix(local(plain, BodyPart.LEFT_FOREARM).transpose(0, 2, 1) @ local(posed, BodyPart.LEFT_FOREARM))
    )
    np.testing.assert_allclose(turn, RANGE.at(times)[:, None] * [0.5, 0.0, 0.0], atol=1e-7)
    hand = {body.layout.wrist_point(0), body.layout.wrist_point(0) + 1}
    rest = [point for point in range(body.layout.point_count) if point not in hand]
    np.testing.assert_allclose(posed.positions[:, rest], plain.positions[:, rest], atol=1e-6)


def test_frames_outside_the_range_are_the_same_to_the_bit() -> None:
    plain, posed = adapt(request()), adapt(request(correction(), correction(hips=(0.0, 0.0, -0.1))))
    outside = (WALK.times <= RANGE.start) | (WALK.times >= RANGE.end)
    assert np.array_equal(posed.positions[outside], plain.positions[outside])
    assert np.array_equal(posed.rotations[outside], plain.rotations[outside])


@pytest.mark.parametrize("hips", [(0.0, 0.0, -0.15), (0.1, 0.05, 0.0), (0.0, 0.0, 0.08)])
def test_planted_feet_stay_under_moved_hips_and_turned_legs(hips: tuple) -> None:
    turns = ((BodyPart.LEFT_THIGH, (0.3, 0.1, 0.2)), (BodyPart.RIGHT_FOOT, (0.0, 0.2, 0.1)))
    plain, posed = adapt(request()), adapt(request(correction(turns, hips)))
    for side, name in enumerate(("left", "right")):
        stands = np.zeros(WALK.frame_count, dtype=bool)
        for contact in CONTACTS:
            if contact.point.value.startswith(name):
                stands[contact.first : contact.last + 1] = True
        off = posed.positions[:, BODY.layout.ankle_point(side)] - plain.positions[:, BODY.layout.ankle_point(side)]
        assert np.linalg.norm(off[stands], axis=1).max() < 1e-4
    assert np.linalg.norm(posed.positions[66, 0] - plain.positions[66, 0]) > 0.02 or hips[2] > 0.0


@pytest.mark.parametrize("angle", [0.4, 0.8, 1.2])
def test_a_foot_never_leaves_the_motion_for_a_correction_much_faster_than_a_step(angle: float) -> None:
    """A foot that had just been lifted reached a pose of the other step within four frames, at 8 m/s."""
    turned = replace(correction(((BodyPart.LEFT_THIGH, (0.0, angle, 0.0)),), time=1.1), activation=ALWAYS)
    plain, posed = adapt(request()), adapt(request(turned))
    ankle = BODY.layout.ankle_point(0)
    off = posed.positions[:, ankle] - plain.positions[:, ankle]
    assert np.linalg.norm(off, axis=1).max() > 0.05
    assert np.linalg.norm(np.diff(off, axis=0), axis=1).max() * WALK.frame_rate < 1.2 * FREED_FOOT_SPEED


def test_a_leg_in_the_air_goes_with_its_correction_without_a_jump() -> None:
    posed = adapt(request(correction(((BodyPart.LEFT_THIGH, (0.4, 0.0, 0.0)),), time=1.1)))
    plain = adapt(request())
    ankle = BODY.layout.ankle_point(0)
    off = posed.positions[:, ankle] - plain.positions[:, ankle]
    assert np.linalg.norm(off, axis=1).max() > 0.05
    assert np.linalg.norm(np.diff(off, 2, axis=0), axis=1).max() < 0.02
    for joint in range(1, 3):
        bones = np.linalg.norm(posed.positions[:, ankle - joint + 1] - posed.positions[:, ankle - joint], axis=1)
        np.testing.assert_allclose(bones, BODY.leg[0, 2 - joint], atol=1e-6)


def wrist_target() -> PositionConstraint:
    plain = adapt(request())
    wrist = BodyPoint(BodyPart.LEFT_FOREARM, at_end=True)
    target = tuple((body_point_positions(wrist, plain)[66] + [0.05, 0.0, 0.05]).tolist())
    return PositionConstraint("m", "Wrist", wrist, Chain(), 0, ActivationCurve(0.9, 1.05, 1.15, 1.3), target=target)


def test_below_the_constraints_these_hold_exactly_and_above_them_the_report_says_what_is_left() -> None:
    asked, turns = (wrist_target(),), ((BodyPart.LEFT_UPPER_ARM, (0.0, 0.4, 0.0)),)
    below = adapt(request(correction(turns), constraints=asked))
    above = adapt(request(correction(turns, above=True), constraints=asked))
    assert below.residuals[0, 66] < 1e-4
    wrist = np.linalg.norm(body_point_positions(asked[0].point, above)[66] - np.array(asked[0].target))
    assert above.residuals[0, 66] == pytest.approx(wrist, abs=1e-9)
    assert wrist > 0.02
    before = adapt(request(constraints=asked))
    turn = to_rotation_vector(
        from_matrix(local(before, BodyPart.LEFT_UPPER_ARM).transpose(0, 2, 1) @ local(above, BodyPart.LEFT_UPPER_ARM))
    )
    np.testing.assert_allclose(turn[66], [0.0, 0.4, 0.0], atol=1e-7)


def test_a_correction_above_a_constraint_is_named_where_it_keeps_the_constraint_from_being_met() -> None:
    """The report said smoothing, without which nothing would have been otherwise."""
    turns = ((BodyPart.LEFT_UPPER_ARM, (0.0, 0.4, 0.0)),)
    asked = replace(request(correction(turns, above=True), constraints=(wrist_target(),)), eased=True)
    adapted = adapt(asked)
    report = report_of(grounded_motion(asked), asked, adapted)
    missed = np.flatnonzero(fully_active(asked.constraints, asked.motion.times)[0] & (report.misses[0] > 2e-4))
    assert len(missed) > 3
    assert set(report.winners[0, missed].tolist()) == {BLOCKED_BY_CORRECTIONS}
    without = replace(asked, corrections=())
    assert report_of(grounded_motion(without), without, adapt(without)).winners.max() == BLOCKED_BY_NOTHING


def test_a_window_is_corrected_as_the_whole_clip_is() -> None:
    asked = request(correction(hips=(0.0, 0.0, -0.1)), correction(above=True), constraints=(wrist_target(),))
    whole, part = adapt(asked), adapt(asked, 60, 70)
    np.testing.assert_allclose(part.positions, whole.positions[60:71], atol=1e-9)


def test_rotations_between_two_keys_neither_flip_nor_leave_the_shorter_path() -> None:
    keys = KeyedPoses((1.0, 1.2), (PoseOffsets(ELBOW), PoseOffsets(((BodyPart.LEFT_FOREARM, (0.0, 1.4, 0.0)),))))
    turns = keys.turns_at(BodyPart.LEFT_FOREARM, np.linspace(0.9, 1.3, 81))
    steps = to_rotation_vector(from_matrix(turns[:-1].transpose(0, 2, 1) @ turns[1:]))
    assert np.linalg.norm(steps, axis=1).max() < 0.12
    np.testing.assert_allclose(turns[0], to_matrix(from_rotation_vector(np.array([0.5, 0.0, 0.0]))), atol=1e-12)
    assert keys.value_at(1.0) == keys.values[0]
    assert keys.value_at(1.1).turn(BodyPart.LEFT_FOREARM) == pytest.approx((0.25, 0.7, 0.0), abs=0.1)


def test_a_correction_mirrored_twice_is_itself_and_mirrors_the_pose() -> None:
    turns = (
        (BodyPart.THORAX, (0.1, 0.2, 0.3)), (BodyPart.LEFT_UPPER_ARM, (0.3, -0.2, 0.1)),
        (BodyPart.LEFT_THIGH, (0.1, 0.2, -0.1)), (BodyPart.LEFT_HAND, (0.2, 0.1, 0.3)),
        (BodyPart.LEFT_CLAVICLE, (0.1, 0.0, 0.2)), (BodyPart.HEAD, (0.1, 0.2, 0.3)),
    )  # fmt: skip
    own = replace(correction(turns, (0.0, 0.02, -0.05)), name="Left arm")
    assert own.mirrored().name == "Right arm"
    assert own.mirrored().mirrored() == own
    from studio.core.normalized.mirror import mirrored_contacts, mirrored_motion

    posed = adapt(request(own))
    other = adapt(AdaptRequest(mirrored_motion(WALK), BODY, mirrored_contacts(CONTACTS), corrections=(own.mirrored(),)))
    swap = [BODY.layout.point_names().index(_other(name)) for name in BODY.layout.point_names()]
    np.testing.assert_allclose(other.positions, posed.positions[:, swap] * [1.0, -1.0, 1.0], atol=2e-3)


def _other(name: str) -> str:
    swaps = {"left": "right", "right": "left"}
    side, _, rest = name.partition(" ")
    return f"{swaps[side]} {rest}" if side in swaps else name


def test_a_key_beyond_the_range_takes_the_range_along() -> None:
    grown = correction().with_key(2.0, PoseOffsets(ELBOW))
    np.testing.assert_allclose(grown.activation.times, (0.8, 1.0, 2.0, 2.2))
    assert grown.keys.times == (1.1, 2.0)
    assert new_correction_range(1.0).times == pytest.approx((0.75, 0.95, 1.05, 1.25))


def test_a_correction_above_is_reported_on_a_body_without_constraints() -> None:
    asked = request(correction(hips=(0.0, 0.0, 0.3), above=True))
    report = report_of(grounded_motion(asked), asked, adapt(asked))
    assert report.misses.shape == report.winners.shape == (0, WALK.frame_count)


@pytest.mark.parametrize("height", [0.8, 1.0, 1.3])
def test_hips_keyed_above_the_constraints_ride_on_a_platform_that_is_keyed_alike(height: float) -> None:
    body, metres, times = make_morphology(height), 0.5, (0.5, 1.5)
    platform = KeyedPlace(times, ((0.0, 0.0, 0.0), (0.0, 0.0, metres)))
    keys = KeyedPoses(times, (PoseOffsets(), PoseOffsets((), (0.0, 0.0, metres / body.leg_length))))
    ride = Correction("Ride", "p", ActivationCurve(-1.0, -1.0, 99.0, 99.0), keys, above=True)
    plain, ridden = (adapt(request(*each, body=body)) for each in ((), (ride,)))
    assert ridden.positions == pytest.approx(plain.positions + platform.at(WALK.times)[:, None], abs=1e-9)
    assert np.array_equal(ridden.rotations, plain.rotations)
