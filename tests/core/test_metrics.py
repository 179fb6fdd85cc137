"""The measures of quality, on motions whose faults are known."""

import gc
import weakref
from dataclasses import replace

import numpy as np
import pytest

from studio.core.body.rest_pose import rest_pose
from studio.core.captures.contacts import FOOT_POINTS, ContactInterval, ContactPoint
from studio.core.grounds.ground import Ground
from studio.core.grounds.slope import Slope
from studio.core.grounds.steps import Steps
from studio.core.mesh.volume import BodyVolume, usual_volume
from studio.core.normalized.realize import realize_motion
from studio.core.quality import metrics
from studio.core.quality.contact_tracks import contact_tracks
from studio.core.quality.metrics import (
    acceleration_ratio,
    angular_acceleration,
    body_heights,
    contact_quality,
    skate_distances,
    turning_peaks,
)
from studio.core.quality.motion_quality import motion_quality
from studio.core.rotations import to_matrix
from studio.core.solver.adapt import adapt
from studio.core.solver.asking.clearance import arm_distances
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from tests.builders import make_morphology
from tests.core.motions import RATE, about, walk

BODY = make_morphology()


def _standing(frames: int = 20, first_frame: int = 0) -> AdaptedMotion:
    """A body with level feet, their soles on the ground z = 0, that does not move."""
    layout = BODY.layout
    positions = np.zeros((frames, layout.point_count, 3))
    for side in range(2):
        positions[:, layout.ankle_point(side)] = [0.0, 0.1, BODY.ankle_height[side]]
        positions[:, layout.toe_point(side)] = positions[:, layout.ankle_point(side)] + BODY.foot[side]
    rotations = np.tile(np.eye(3), (frames, layout.segment_count, 1, 1))
    return AdaptedMotion(BODY, RATE, first_frame, positions, rotations, np.zeros((0, frames)))


def _moved(motion: AdaptedMotion, shift: object, frames: slice) -> AdaptedMotion:
    positions = motion.positions.copy()
    positions[frames] += shift
    return replace(motion, positions=positions)


def _contacts(first: int, last: int) -> tuple[ContactInterval, ...]:
    return tuple(ContactInterval("walk", point, first, last) for point in FOOT_POINTS)


def test_a_foot_that_stands_has_no_fault() -> None:
    quality = contact_quality(_standing(), _contacts(0, 19), Ground())
    assert (quality.slide, quality.rise, quality.penetration) == pytest.approx((0.0, 0.0, 0.0), abs=1e-15)


@pytest.mark.parametrize(
    ("shift", "expected"),
    [((0.03, 0.04, 0.0), (0.05, 0.0, 0.0)), ((0, 0, 0.02), (0.0, 0.02, 0.0)), ((0, 0, -0.01), (0.0, 0.0, 0.01))],
)
def test_each_fault_is_told_in_metres(shift: tuple, expected: tuple) -> None:
    quality = contact_quality(_moved(_standing(), shift, slice(10, 12)), _contacts(0, 19), Ground())
    assert (quality.slide, quality.rise, quality.penetration) == pytest.approx(expected, abs=1e-12)


def test_what_happens_outside_contacts_is_no_fault() -> None:
    wild = _moved(_standing(), (1.0, 1.0, 1.0), slice(10, None))
    assert contact_quality(wild, _contacts(0, 9), Ground()).slide == 0.0
    assert contact_quality(wild, (), Ground()).rise == 0.0


def test_a_lifted_ground_makes_feet_sink() -> None:
    quality = contact_quality(_standing(), _contacts(0, 19), Ground(0.05))
    assert (quality.rise, quality.penetration) == pytest.approx((0.0, 0.05))


def test_a_tilted_foot_lifts_its_heel_by_the_heels_lever() -> None:
    motion = _standing()
    motion.rotations[:, BODY.layout.spine_count + 12] = to_matrix(about((0, 1, 0), np.array(0.2)))
    heel = (ContactInterval("walk", ContactPoint.LEFT_HEEL, 0, 19),)
    lever, height = BODY.heel_length[0], BODY.ankle_height[0]
    lifted = height + lever * np.sin(0.2) - height * np.cos(0.2)
    assert contact_quality(motion, heel, Ground()).rise == pytest.approx(lifted)


@pytest.mark.parametrize("ground", [Ground(0.01), Slope(angle=0.3), Steps(rise=0.05, tread=0.1)])
def test_every_contact_is_measured_by_itself(ground: Ground) -> None:
    motion = adapt(AdaptRequest(walk()[0], BODY))
    spans = {ContactPoint.LEFT_TOE: [(3, 9), (10, 14), (20, 29)], ContactPoint.RIGHT_HEEL: [(0, 5), (16, 30)]}
    spans |= {ContactPoint.LEFT_KNEE: [(2, 4), (8, 12)]}
    contacts = [ContactInterval("walk", point, *span) for point, both in spans.items() for span in both]
    together = np.array(contact_tracks(motion, contacts, ground))
    alone = np.array([contact_tracks(motion, [each], ground) for each in contacts])
    assert (np.isfinite(alone).sum(axis=0) == np.isfinite(together)).all()
    assert np.nansum(alone, axis=0) == pytest.approx(np.nan_to_num(together), abs=1e-12)


def test_a_windows_frames_are_counted_in_the_whole_motion() -> None:
    window = _moved(_standing(first_frame=100), (0.1, 0.0, 0.0), slice(5, None))
    assert contact_quality(window, _contacts(90, 104), Ground()).slide == 0.0
    assert contact_quality(window, _contacts(90, 105), Ground()).slide == pytest.approx(0.1)
    assert contact_quality(window, _contacts(0, 99), Ground()).slide == 0.0
    assert contact_quality(window, _contacts(120, 130), Ground()).slide == 0.0


def test_a_steady_turn_has_no_angular_acceleration_and_a_growing_one_has() -> None:
    times = np.arange(30) / RATE
    steady = to_matrix(about((0, 0, 1), 3.0 * times))
    growing = to_matrix(about((0, 0, 1), 4.0 * times**2))
    assert angular_acceleration(steady, RATE) == pytest.approx(np.zeros(28), abs=1e-8)
    assert angular_acceleration(growing, RATE) == pytest.approx(np.full(28, 8.0))


def _walking() -> AdaptedMotion:
    motion, _ = walk()
    return AdaptedMotion(BODY, motion.frame_rate, 0, *realize_motion(motion, BODY), np.zeros((0, motion.frame_count)))


def test_a_motion_is_as_smooth_as_itself() -> None:
    assert acceleration_ratio(_walking(), _walking()) == 1.0


def test_a_popping_knee_shows() -> None:
    popped = _walking()
    shank = BODY.layout.spine_count + 11
    popped.rotations[70, shank] = popped.rotations[70, shank] @ to_matrix(about((1, 0, 0), np.array(0.3)))
    assert acceleration_ratio(popped, _walking()) > 5.0


def test_a_window_is_beside_the_same_frames_of_its_source() -> None:
    whole = _walking()
    window = replace(whole, first_frame=40, positions=whole.positions[40:80], rotations=whole.rotations[40:80])
    assert acceleration_ratio(window, whole) == 1.0
    short = replace(window, rotations=window.rotations[:2], positions=window.positions[:2])
    assert acceleration_ratio(short, whole) == 1.0


def test_a_still_source_counts_as_quiet_and_not_as_nothing() -> None:
    assert acceleration_ratio(_standing(), _standing()) == 0.0


def test_nothing_of_a_source_is_kept_once_it_was_compared() -> None:
    """The last four sources of reports stayed in memory, 0.3 GB each for a quarter of an hour."""
    source = _walking()
    ghost = weakref.ref(source)
    assert acceleration_ratio(_walking(), source) == 1.0
    del source
    gc.collect()
    assert ghost() is None


def test_peaks_of_a_long_motion_are_found_in_runs_of_frames() -> None:
    motion = _walking()
    whole = turning_peaks(motion)
    for length in (3, 7):
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(metrics, "PEAK_RUN", length)
            assert np.array_equal(turning_peaks(motion), whole)


def test_the_ground_is_level_and_its_height_a_number() -> None:
    assert Ground(0.3).height_at(np.zeros((4, 5, 3))).tolist() == np.full((4, 5), 0.3).tolist()
    with pytest.raises(ValueError, match="finite number of metres"):
        Ground(np.nan)


def test_a_body_of_other_proportions_that_does_the_same_does_not_jump() -> None:
    """Hands of arms three times as long beside the legs go three times as far in the same posture."""
    motion, contacts = walk()
    chibi = replace(
        BODY, arm=3.0 * BODY.arm, hand=3.0 * BODY.hand, spine=3.0 * BODY.spine, collar_base=3.0 * BODY.collar_base
    )
    shown = []
    for body in (BODY, chibi):
        positions, rotations = realize_motion(motion, body)
        shown.append(AdaptedMotion(body, RATE, 0, positions, rotations, np.zeros((0, len(positions)))))
    assert motion_quality(shown[1], shown[0], contacts, Ground()).jump < 1.2


def test_what_is_inside_its_body_at_rest_may_be_so_in_motion() -> None:
    thin, thick = (
        BodyVolume(v.segments, v.places, v.radii, g * v.girths) for v in [usual_volume(BODY)] for g in (1, 15)
    )
    positions, rotations = (np.tile(each, (10, *[1] * each.ndim)) for each in rest_pose(BODY))
    still = [AdaptedMotion(BODY, RATE, 0, positions, rotations, np.zeros((0, 10)), volume=v) for v in (thin, thick)]
    assert arm_distances(still[1]).min() < -0.1
    assert motion_quality(still[1], still[0], (), Ground()).inside == 0.0


def test_a_foot_in_the_floor_is_seen_without_a_contact() -> None:
    """A released foot 116 mm under the floor was reported as 0."""
    sunk = _moved(_standing(), (0.0, 0.0, -0.116), slice(10, 12))
    assert contact_quality(sunk, (), Ground()).penetration == 0.0
    assert body_heights(sunk, Ground()).min() == pytest.approx(-0.116)
    assert body_heights(_standing(), Ground()).min() == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("depth", [0.0, 0.03, 0.116])
@pytest.mark.parametrize("ground", [Ground(0.2), Slope(0.1, 0.3), Steps(0.0, 0.15, 0.3)])
def test_depth_is_that_of_the_lowest_point_under_level_sloped_and_stepped_ground(ground: Ground, depth: float) -> None:
    motion, contacts = walk()
    adapted = adapt(AdaptRequest(motion, BODY, contacts, ground=ground))
    slope = np.cos(0.3) if isinstance(ground, Slope) else 1.0
    before = body_heights(adapted, ground)
    sunk = body_heights(_moved(adapted, (0.0, 0.0, -depth), slice(20, 40)), ground)
    assert before.min() > -0.02
    np.testing.assert_allclose(sunk[20:40], before[20:40] - depth * slope, atol=1e-9)
    np.testing.assert_array_equal(sunk[:20], before[:20])


def test_a_foot_that_glides_along_the_ground_skates_whatever_its_contacts_say() -> None:
    still = _standing(61)
    glide = np.linspace(0.0, 1.0, 61)[:, None, None]
    for speed, expected in ((0.3, 0.3), (5.0, 0.0)):
        moved = replace(still, positions=still.positions + speed * 60.0 / RATE * glide * [1.0, 0.0, 0.0])
        assert skate_distances(moved, Ground()).max() == pytest.approx(expected * 60.0 / RATE, abs=1e-9)
    assert contact_quality(still, (), Ground()).slide == 0.0
    assert skate_distances(still, Ground()).max() == 0.0
    lifted = _moved(still, (0.0, 0.0, 0.02), slice(0, 61))
    drifting = replace(lifted, positions=lifted.positions + 0.3 * glide * [1.0, 0.0, 0.0])
    assert skate_distances(drifting, Ground()).max() == 0.0
