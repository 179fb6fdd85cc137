"""Contacts of feet, and the floor that they show."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from studio.core.captures.contacts import (
    BODY_POINTS,
    FOOT_POINTS,
    GREATEST_WANDER_METRES,
    ContactInterval,
    ContactPoint,
    Span,
    contact_mask,
    detect_body_contacts,
    detect_contacts,
    joined_over_still_gaps,
    longest_still_span,
    lying_shank_mask,
    parted_at_slides,
    plank_leg_mask,
    prone_mask,
    spans_outside_mask,
    with_step_gaps_closed,
)
from studio.core.captures.floor_slope import find_floor_slope
from studio.core.captures.plate_steps import contacts_fitted_to_plates
from studio.core.captures.rising_heels import rising_heels
from studio.core.markers.force_plates import PlateLoad
from studio.core.normalized.realize import realize_motion
from studio.core.solver.grounding.captured_floor import captured_floor
from tests.builders import make_morphology
from tests.core.motions import walk

# Detecting when feet stand, on tracks whose contacts are known.


RATE = 60.0


def _track(steps: list[tuple[int, int]], frames: int = 120, low: float = 0.08) -> np.ndarray:
    """(F, 3): standing still during ``steps``, else high in the air and fast."""
    track = np.tile([0.0, 0.0, low], (frames, 1))
    flying = ~contact_mask(steps, frames)
    track[flying, 2] += 0.3
    track[:, 0] = np.cumsum(np.where(flying, 0.05, 0.0))
    return track


def _detect(left: np.ndarray, right: np.ndarray, **options: int) -> dict[ContactPoint, list[tuple[int, int]]]:
    """Contacts of feet that neither roll nor turn."""
    tracks = np.stack([left, right], axis=1)
    return detect_contacts(tracks[:, :, None] - [[0.0, 0.0, 0.0], [0.0, 0.0, 0.06], [0.0, 0.0, 0.06]], RATE, **options)


def test_a_foot_that_stands_is_found_where_it_stands() -> None:
    found = _detect(_track([(20, 50), (80, 110)]), _track([(45, 85)]))
    for kind in ("heel", "toe"):
        left, right = found[ContactPoint(f"left_{kind}")], found[ContactPoint(f"right_{kind}")]
        assert np.allclose(left, [(20, 50), (80, 110)], atol=3)
        assert np.allclose(right, [(45, 85)], atol=3)


@given(st.floats(-2, 2), st.floats(-2, 2), st.floats(-0.5, 0.5))
def test_where_the_floor_lies_and_where_the_walk_goes_does_not_matter(x: float, y: float, z: float) -> None:
    left, right = _track([(20, 50)]), _track([(45, 85)])
    assert _detect(left + np.array([x, y, z]), right + np.array([x, y, z])) == _detect(left, right)


def test_frames_before_the_first_are_not_looked_at() -> None:
    found = _detect(_track([(5, 30), (60, 100)]), _track([(5, 30), (60, 100)]), first_frame=40)
    assert all(first >= 40 for spans in found.values() for first, _ in spans)
    assert np.allclose(found[ContactPoint.LEFT_HEEL], [(60, 100)], atol=3)


def test_a_foot_held_above_the_other_never_stands() -> None:
    found = _detect(_track([(0, 119)]), _track([(0, 119)], low=0.4))
    assert found[ContactPoint.LEFT_HEEL] == [(0, 119)]
    assert found[ContactPoint.RIGHT_HEEL] == []


def test_a_low_foot_that_glides_does_not_stand() -> None:
    gliding = np.stack([0.02 * np.arange(120.0), np.zeros(120), np.full(120, 0.08)], axis=1)
    assert _detect(gliding, _track([(0, 119)]))[ContactPoint.LEFT_TOE] == []


@pytest.mark.parametrize(("far", "steps"), [(0.02, 1), (0.16, 2)])
def test_a_foot_that_skids_stands_where_it_was_and_where_it_comes_to(far: float, steps: int) -> None:
    way = far * np.clip((np.arange(120.0) - 60.0) / 2.0, 0.0, 1.0)
    skidding = np.stack([way, np.zeros(120), np.full(120, 0.08)], axis=1)
    assert len(_detect(skidding, _track([(0, 119)]))[ContactPoint.LEFT_TOE]) == steps


def test_a_foot_that_slides_slowly_stands_before_and_after_not_between() -> None:
    way = np.interp(np.arange(120.0), [0, 50, 70, 119], [0.0, 0.0, 0.18, 0.18])
    sliding = np.stack([way, np.zeros(120), np.full(120, 0.08)], axis=1)
    found = _detect(sliding, _track([(0, 119)]))
    for kind in ("heel", "toe"):
        (_, last), (first, _) = found[ContactPoint(f"left_{kind}")]
        assert abs(last - 50) <= 3
        assert abs(first - 70) <= 3


@pytest.mark.parametrize("rise", [0.05, 0.07])
def test_heels_over_toes_that_stand_are_raised_however_long_a_body_sneaks(rise: float) -> None:
    heels = np.full(480, rise)
    heels[:60] = 0.0
    soles = np.zeros((480, 2, 3, 3))
    soles[..., 0, 2] = heels[:, None]  # (F, side, heel, ball and tip, xyz)
    soles[..., 1:, 0] = [0.18, 0.25]
    found = detect_contacts(soles, RATE)
    for side in ("left", "right"):
        assert found[ContactPoint(f"{side}_toe")] == [(0, 479)]
        assert np.allclose(found[ContactPoint(f"{side}_heel")], [(0, 59)], atol=3)


def test_a_foot_that_turns_about_its_ankle_goes_nowhere() -> None:
    angles = np.clip((np.arange(120.0) - 60.0) / 2.0, 0.0, 1.0)
    ahead = np.stack([np.cos(angles), np.sin(angles), np.zeros(120)], axis=1)
    ends = np.stack([length * ahead + [0.0, 0.0, 0.02] for length in (-0.08, 0.12, 0.2)], axis=1)
    still = np.tile(ends[:1], (120, 1, 1))
    found = detect_contacts(np.stack([ends, still], axis=1), RATE)
    assert found[ContactPoint.LEFT_HEEL] == found[ContactPoint.LEFT_TOE] == [(0, 119)]


@pytest.mark.parametrize("rising", [False, True])
def test_a_foot_that_is_slowly_set_down_or_drawn_up_does_not_stand_till_it_is_down(rising: bool) -> None:
    heights = np.concatenate([np.full(30, 0.3), np.full(20, 0.115), np.linspace(0.115, 0.08, 10), np.full(60, 0.08)])
    hovering = np.zeros((120, 3))
    hovering[:, 2] = heights[::-1] if rising else heights
    found = _detect(hovering, _track([(0, 119)]))
    for kind in ("heel", "toe"):
        ((first, last),) = found[ContactPoint(f"left_{kind}")]
        assert last <= 67 if rising else first >= 52
        assert last - first >= 58


def test_a_foot_that_sinks_into_soft_ground_stands_from_where_it_landed() -> None:
    """Skin under markers, and soft floors, give way by centimetres under a load that grows."""
    low = np.interp(np.arange(120.0), [20, 38, 80, 119], [0.045, 0.045, 0.005, 0.0])
    landing = np.stack([np.interp(np.arange(120.0), [0, 40], [-1.6, 0.0]), np.zeros(120), low], axis=1)
    assert np.allclose(_detect(landing, _track([(0, 119)], low=0.0))[ContactPoint.LEFT_HEEL], [(40, 119)], atol=2)


def _turning(pivot: int, frames: int = 120) -> np.ndarray:
    """Soles (F, 2, 3, 3): the left foot turns by 60 degrees on its heel (0) or its ball (1) from frame 50 to 70."""
    angles = np.radians(60.0) * np.clip((np.arange(frames) - 50.0) / 20.0, 0.0, 1.0)
    ahead = np.stack([np.cos(angles), np.sin(angles), np.zeros(frames)], axis=1)
    places = np.array([0.0, 0.2, 0.26])
    left = np.stack([(place - places[pivot]) * ahead for place in places], axis=1)
    return np.stack([left, np.tile(left[:1], (frames, 1, 1))], axis=1)


@pytest.mark.parametrize(("pivot", "stands", "turns"), [(0, "left_heel", "left_toe"), (1, "left_toe", "left_heel")])
def test_of_a_foot_that_turns_on_one_end_the_other_does_not_stand(pivot: int, stands: str, turns: str) -> None:
    found = detect_contacts(_turning(pivot), RATE)
    assert found[ContactPoint(stands)] == [(0, 119)]
    (_, last), (first, _) = found[ContactPoint(turns)]
    assert abs(last - 50) <= 3
    assert abs(first - 70) <= 3


def test_toes_at_rest_under_a_heel_that_stands_do_so_though_they_sink_when_they_roll_off() -> None:
    soles = _turning(0)[:, [1, 1]]  # a foot that stands still
    going = np.clip((np.arange(120.0) - 60.0) / 20.0, 0.0, 1.0)
    soles[:, :, 1:, 2] -= (0.03 * going)[:, None, None]
    soles[:, :, 0, 2] += (0.2 * going**2)[:, None]
    found = detect_contacts(soles, RATE)
    assert found[ContactPoint.LEFT_TOE] == [(0, 119)]
    assert 60 <= found[ContactPoint.LEFT_HEEL][0][1] <= 75


def test_toes_that_hang_over_a_heel_that_has_landed_do_not_stand_till_they_come_down() -> None:
    soles = _turning(0)[:, [1, 1]]
    frames = np.arange(120.0)
    soles[:, :, 1:, 2] += np.interp(frames, [40, 70, 78], [0.035, 0.035, 0.0])[:, None, None]  # the heel lands first
    soles[:, :, :, 0] -= 1.6 * np.clip(40.0 - frames, 0.0, None)[:, None, None] / 40.0
    found = detect_contacts(soles, RATE)
    assert found[ContactPoint.LEFT_HEEL][0][0] <= 42
    assert found[ContactPoint.LEFT_TOE][0][0] >= 70


def test_a_foot_that_rolls_from_heel_to_toe_is_never_in_the_air() -> None:
    rolling, middle = [(0, 35)], np.zeros((80, 3))
    assert with_step_gaps_closed(rolling, [(39, 60)], middle, 3) == (rolling, [(36, 60)])
    assert with_step_gaps_closed([(39, 60)], rolling, middle, 3) == ([(36, 60)], rolling)
    assert with_step_gaps_closed(rolling, [(40, 60)], middle, 3) == (rolling, [(40, 60)])
    middle[37:, 0] = 2.0 * GREATEST_WANDER_METRES
    assert with_step_gaps_closed(rolling, [(39, 60)], middle, 3) == (rolling, [(39, 60)])


def test_a_foot_that_slides_on_from_place_to_place_stands_at_each_of_them() -> None:
    """Five slides of 6 cm in a quarter of a second, more slowly than feet roll; a leg that lies may trail."""
    begins = np.array([30, 70, 110, 150, 190])
    parts = np.clip((np.arange(240)[:, None] - begins) / 15.0, 0.0, 1.0)
    foot = np.zeros((240, 3))
    foot[:, 0] = 0.06 * np.sum(parts * parts * (3.0 - 2.0 * parts), axis=1)
    found = parted_at_slides([(0, 239)], foot, foot, np.zeros(240, bool), RATE)
    assert len(found) == 6
    assert np.allclose([last for _, last in found[:-1]], begins, atol=4)
    assert np.allclose([first for first, _ in found[1:]], begins + 15, atol=4)
    assert parted_at_slides([(0, 239)], foot, foot, np.ones(240, bool), RATE) == [(0, 239)]
    assert parted_at_slides([(0, 239)], np.zeros((240, 3)), foot, np.zeros(240, bool), RATE) == [(0, 239)]


def test_toes_stand_through_a_gap_in_which_their_foot_does_not_move() -> None:
    middle = np.zeros((80, 3))
    middle[30:50, 2] = 0.01  # skin that moves over bones
    assert joined_over_still_gaps([(0, 32), (45, 60)], middle) == [(0, 60)]
    middle[36:40, 2] = 0.03  # a tap in place
    assert joined_over_still_gaps([(0, 32), (45, 60)], middle) == [(0, 32), (45, 60)]


def test_steps_are_kept_in_the_noise_of_joints_that_shake_by_half_a_degree() -> None:
    """Metres of noise: a foot 0.9 m under joints that shake goes 11 mm sideways, and less up and down."""
    rate, kept = 30.0, []
    for seed in range(40):
        noise = np.random.default_rng(seed).normal(0.0, (0.011, 0.011, 0.002), (120, 2, 1, 3))
        found = detect_contacts(_stepping((45, 75), 120, rate) + noise, rate)
        kept += [contact_mask(found[point], 120)[45:76].mean() for point in FOOT_POINTS]
    assert np.mean(kept) >= 0.95


@pytest.mark.parametrize("way", [1, -1], ids=["leaves", "lands"])
def test_a_hand_stands_from_when_it_is_down_until_it_begins_to_leave(way: int) -> None:
    """One that is drawn along the ground at an end of its contact does not rise or sink, and stands there too."""
    travel = np.clip(np.arange(120.0) - 60.0, 0.0, 7.0) ** 2 * 0.0012
    for rises, last in ((True, 62), (False, 66)):
        tracks = {point: np.tile([0.0, 0.0, 0.5], (120, 1)) for point in BODY_POINTS}
        track = np.column_stack([travel, 0.0 * travel, np.where(np.arange(120) > 66, 0.5, 0.05 + 0.3 * travel * rises)])
        tracks[ContactPoint.LEFT_HAND][:] = track[::way]
        ((first, past),) = detect_body_contacts(tracks, 0.8, RATE)[ContactPoint.LEFT_HAND]
        assert abs((past if way > 0 else 119 - first) - last) <= 1


def test_a_hand_that_is_never_still_stands_if_it_comes_down_and_rises_again() -> None:
    """One of a cartwheel does; one that passes low over the ground as it rises does not."""
    frames = np.arange(40.0)
    for bottom, stands in ((20, True), (10, False)):
        height = 0.05 + 0.0002 * (frames - bottom) ** 2
        track = np.column_stack([0.008 * frames, 0.0 * frames, np.where(np.abs(frames - 20) < 5, height, 0.5)])
        assert bool(_touching(ContactPoint.LEFT_HAND, track)) == stands


def test_flicker_is_closed_and_blinks_are_dropped() -> None:
    left = _track([(20, 80)])
    left[50, 2] += 0.045
    found = _detect(left, _track([(60, 61)]))
    assert len(found[ContactPoint.LEFT_HEEL]) == 1
    assert found[ContactPoint.RIGHT_HEEL] == []


def _stepping(step: tuple[int, int], count: int, rate: float) -> np.ndarray:
    """Soles (F, 2, 3, 3) of feet that come at 3 m/s, rest during the step, and go at 3 m/s."""
    frames = np.arange(count)
    away = np.maximum(step[0] - frames, 0) + np.maximum(frames - step[1], 0)
    foot = np.stack([3.0 / rate * away, 0.0 * away, 0.08 + 0.5 / rate * away], axis=1)
    return np.tile(foot[:, None, None], (1, 2, 3, 1))


@pytest.mark.parametrize("rate", [24.0, 30.0, 60.0, 120.0])
def test_a_step_is_found_to_the_frame_however_fast_the_foot_comes_and_goes(rate: float) -> None:
    step = (round(0.5 * rate), round(0.75 * rate))
    found = detect_contacts(_stepping(step, round(1.5 * rate), rate), rate)
    assert all(np.allclose(found[point], [step], atol=0.02 * rate) for point in FOOT_POINTS)


def test_a_foot_touches_while_it_rolls_on_to_its_heel_and_off_the_tip_of_its_toes() -> None:
    """The heel comes to rest within a tenth of a second; the tip begins to move as it leaves."""
    foot = np.zeros((120, 2, 3, 3))
    coming, going = np.maximum(30 - np.arange(120), 0), np.maximum(np.arange(120) - 90, 0)
    foot[:, :, 0, 0] = (-0.0007 * coming**2 - 0.01 * going)[:, None]
    foot[:, :, 1, 0] = (-0.02 * coming + 0.02 * going)[:, None]
    foot[:, :, 2, 0] = (-0.02 * coming + 0.0007 * going**2)[:, None]
    found = detect_contacts(foot, RATE)
    assert 23 <= found[ContactPoint.LEFT_HEEL][0][0] <= 26
    assert 95 <= found[ContactPoint.LEFT_TOE][0][1] <= 98


@pytest.mark.parametrize(("step", "kept"), [((-9, 2), (0, 2)), ((57, 70), (57, 59))])
def test_a_step_that_the_clip_cuts_off_is_kept_however_short(step: tuple[int, int], kept: tuple[int, int]) -> None:
    found = detect_contacts(_stepping(step, 60, RATE), RATE)
    assert np.allclose(found[ContactPoint.LEFT_TOE], [kept], atol=1)


def test_one_frame_has_no_contacts() -> None:
    assert not any(_detect(np.zeros((1, 3)), np.zeros((1, 3))).values())


@given(st.lists(st.tuples(st.integers(0, 99), st.integers(0, 99)).map(sorted), max_size=5))
def test_a_mask_is_true_within_its_spans_and_nowhere_else(spans: list[list[int]]) -> None:
    inside = {frame for first, last in spans for frame in range(first, last + 1)}
    assert set(np.flatnonzero(contact_mask([tuple(span) for span in spans], 100))) == inside


def test_contact_points_know_their_side_and_kind() -> None:
    assert [point.side for point in FOOT_POINTS] == [0, 0, 1, 1]
    assert [point.is_heel for point in FOOT_POINTS] == [True, False, True, False]
    assert [point.member for point in BODY_POINTS] == ["hand", "hand", "knee", "knee", "seat"]
    assert [point.limb for point in (*FOOT_POINTS, *BODY_POINTS)] == [2, 2, 3, 3, 0, 1, 2, 3, -1]
    assert ContactInterval("walk", "right_toe", 0, 0).point is ContactPoint.RIGHT_TOE  # type: ignore[arg-type]


def _above_floor(height: float, drift: float = 0.0, frames: int = 120) -> np.ndarray:
    """A track at rest at a height, but for a slow ``drift`` in metres a second."""
    return np.stack([drift * np.arange(frames) / RATE, np.zeros(frames), np.full(frames, height)], axis=1)


def _touching(point: ContactPoint, track: np.ndarray) -> list[tuple[int, int]]:
    still = _above_floor(1.0, frames=len(track))
    tracks = {each: track if each is point else still for each in BODY_POINTS}
    return detect_body_contacts(tracks, 0.85, RATE)[point]


@pytest.mark.parametrize(("point", "low"), [("left_hand", 0.06), ("right_knee", 0.06), ("seat", 0.1)])
def test_what_lies_low_and_still_touches_and_what_is_higher_does_not(point: str, low: float) -> None:
    assert _touching(ContactPoint(point), _above_floor(low)) == [(0, 119)]
    assert _touching(ContactPoint(point), _above_floor(0.4)) == []


def _trunk(facing: float) -> tuple[np.ndarray, np.ndarray]:
    """Hips and shoulders (1, 2, 3) of a trunk that is tilted forward by ``facing`` radians from upright."""
    hips = np.array([[[0.0, 0.1, 0.5], [0.0, -0.1, 0.5]]])
    return hips, hips + 0.5 * np.array([np.sin(facing), 0.0, np.cos(facing)])


@pytest.mark.parametrize(("degrees", "prone"), [(0, False), (30, False), (90, True), (110, True), (-90, False)])
def test_a_body_is_prone_when_its_front_points_down(degrees: float, prone: bool) -> None:
    assert prone_mask(*_trunk(np.radians(degrees))).item() is prone


@pytest.mark.parametrize(("hip", "tipped"), [((0.1, 0.9), False), ((-0.3, 0.3), False), ((0.6, 0.4), True)])
def test_the_leg_of_a_plank_is_tipped_over_and_that_of_a_crouch_is_not(hip: tuple[float, float], tipped: bool) -> None:
    ankle, toe = np.array([[0.0, 0.0, 0.08]]), np.array([[0.14, 0.0, 0.03]])
    assert plank_leg_mask(np.array([[hip[0], 0.0, hip[1]]]), ankle, toe).item() is tipped


@pytest.mark.parametrize(("degrees", "lies"), [(0.0, True), (10.0, True), (20.0, False), (90.0, False)])
def test_a_shank_lies_that_is_nearly_level(degrees: float, lies: bool) -> None:
    knee = 0.4 * np.array([[np.cos(np.radians(degrees)), 0.0, np.sin(np.radians(degrees))]])
    assert lying_shank_mask(knee, np.zeros((1, 3)))[0] == lies


def test_what_creeps_along_the_ground_touches_only_while_it_stays() -> None:
    first, last = _touching(ContactPoint.LEFT_KNEE, _above_floor(0.06, drift=0.2))[0]
    assert 0.2 * (last - first) / RATE <= 2 * GREATEST_WANDER_METRES + 0.01


def test_a_hand_that_goes_on_slowly_stands_where_it_was_and_where_it_comes_to() -> None:
    place = np.interp(np.arange(120), [0, 40, 60, 119], [0.0, 0.0, 0.2, 0.2])
    found = _touching(ContactPoint.LEFT_HAND, _above_floor(0.06) + place[:, None] * [1.0, 0.0, 0.0])
    assert len(found) == 2
    assert found[0][0] == 0
    assert found[1][1] == 119
    assert found[1][0] - found[0][1] > 0.1 * RATE


def test_knees_carry_nothing_while_the_seat_does() -> None:
    low = _above_floor(0.06)
    tracks = dict.fromkeys(BODY_POINTS, low)
    tracks[ContactPoint.SEAT] = np.where(np.arange(120)[:, None] < 60, low, _above_floor(1.0))
    found = detect_body_contacts(tracks, 0.85, RATE)
    assert found[ContactPoint.SEAT][0][1] <= 60
    assert found[ContactPoint.LEFT_KNEE][0][0] >= found[ContactPoint.SEAT][0][1] + 0.25 * RATE


@given(st.lists(st.booleans(), min_size=1, max_size=50), st.lists(st.booleans(), min_size=50, max_size=50))
def test_what_is_taken_out_of_a_contact_is_out(wanted: list[bool], gone: list[bool]) -> None:
    mask = np.array(gone[: len(wanted)])
    spans = [(frame, frame) for frame, yes in enumerate(wanted) if yes]
    rest = contact_mask(spans_outside_mask(spans, mask, 0), len(wanted))
    assert np.array_equal(rest, np.array(wanted) & ~mask)


def test_a_point_that_circles_round_its_middle_stays_nowhere() -> None:
    """Found by spoiling captures: no frame of it lies near the middle of all."""
    angle = np.linspace(0.0, 2.0 * np.pi, 60, endpoint=False)
    circle = np.stack([np.cos(angle), np.sin(angle), np.zeros(60)], axis=1)
    assert longest_still_span(circle, 0, 59) == (0, 0)


# Contacts of feet that tread on force plates.


PLATE_RATE = 100.0
PLATE = np.array([[0.3, 0.2], [-0.3, 0.2], [-0.3, -0.2], [0.3, -0.2]])
HEEL, TOE = ContactPoint.LEFT_HEEL, ContactPoint.LEFT_TOE
OTHER = {ContactPoint.RIGHT_HEEL: [(0, 99)], ContactPoint.RIGHT_TOE: [(0, 99)]}


def soles(left: float = 0.0, right: float = 2.0) -> np.ndarray:
    """(100, 2, 3, 3): feet that point along X, their balls at ``left`` and ``right`` from the middle of the plate."""
    places = np.zeros((100, 2, 3, 3))
    places[..., 0] = np.array([left, right])[:, None] + np.array([-0.15, 0.0, 0.08])
    return places


def fitted(heel: list[Span], toe: list[Span], load: Span, places: np.ndarray) -> tuple[list[Span], list[Span]]:
    found = contacts_fitted_to_plates({HEEL: heel, TOE: toe, **OTHER}, places, [PlateLoad(*load, PLATE)], PLATE_RATE)
    assert {point: found[point] for point in OTHER} == OTHER
    return found[HEEL], found[TOE]


@pytest.mark.parametrize("corners", [PLATE, PLATE[::-1]])
@pytest.mark.parametrize(
    ("load", "heel", "toe"), [((20, 70), [(20, 50)], [(35, 70)]), ((28, 62), [(28, 50)], [(35, 62)])]
)
def test_a_foot_stands_from_the_first_to_the_last_frame_of_its_load(
    corners: np.ndarray, load: Span, heel: list[Span], toe: list[Span]
) -> None:
    found = contacts_fitted_to_plates(
        {HEEL: [(25, 50)], TOE: [(35, 66)], **OTHER}, soles(), [PlateLoad(*load, corners)], PLATE_RATE
    )
    assert (found[HEEL], found[TOE]) == (heel, toe)


def test_a_foot_does_not_leave_a_plate_that_it_loads() -> None:
    assert fitted([(20, 40)], [(30, 48), (56, 70)], (20, 70), soles()) == ([(20, 40)], [(30, 70)])


@pytest.mark.parametrize("places", [soles(left=0.3), soles(right=0.1), soles(left=1.0)])
def test_a_foot_across_the_edge_both_feet_or_none_on_a_plate_stand_by_their_motion(places: np.ndarray) -> None:
    assert fitted([(25, 50)], [(35, 66)], (20, 70), places) == ([(25, 50)], [(35, 66)])


def test_a_foot_may_rest_on_a_plate_long_before_it_loads_it() -> None:
    assert fitted([(0, 99)], [(0, 99)], (40, 95), soles()) == ([(0, 95)], [(0, 95)])


# The slope of a captured floor is found where steps lead far enough to show it.


SLOPE_RATE = 30.0
HEEL_BALL_TIP = np.array([[-0.06, 0.0, 0.0], [0.14, 0.0, 0.02], [0.2, 0.0, 0.02]])
UPRIGHT = np.ones((150, 2), dtype=bool)


def _walk(stride: float, count: int = 150) -> np.ndarray:
    """Soles (F, 2, 3, 3) on a level floor that stand for half a second, then swing for half a second."""
    soles = np.zeros((count, 2, 3, 3))
    for side in range(2):
        swing = np.clip((np.arange(count) + 15 * side) % 30 - 15, 0, 15) / 15.0
        stepped = (np.arange(count) + 15 * side) // 30 + swing - np.sin(2 * np.pi * swing) / (2 * np.pi)
        ankle = np.stack([stride * stepped, np.full(count, 0.2 * side), 0.1 * np.sin(np.pi * swing) ** 2], axis=1)
        soles[:, side] = ankle[:, None] + HEEL_BALL_TIP
    return soles


def _tilted(soles: np.ndarray, gradient: tuple[float, float]) -> np.ndarray:
    tilted = soles.copy()
    tilted[..., 2] += soles[..., :2] @ np.array(gradient)
    return tilted


@given(st.floats(-0.035, 0.035), st.floats(-0.035, 0.035))
def test_a_walk_shows_how_its_floor_rises_along_it(along: float, across: float) -> None:
    found = find_floor_slope(_tilted(_walk(1.2), (along, across)), UPRIGHT, SLOPE_RATE)
    assert abs(found.gradient[0] - along) < 0.1 * abs(along) + 0.002
    assert abs(found.gradient[1]) < abs(across) + 0.002  # it leads nowhere across


@pytest.mark.parametrize("rise", [-0.035, 0.035])
def test_a_walk_on_a_tilted_floor_stands_where_it_does_on_a_level_one(rise: float) -> None:
    walk = _walk(1.2)
    tilted = _tilted(walk, (rise, 0.0))
    levelled = find_floor_slope(tilted, UPRIGHT, SLOPE_RATE).levelled(tilted)
    level, found = (detect_contacts(soles, SLOPE_RATE) for soles in (walk, levelled))
    for point in FOOT_POINTS:
        stands, kept = contact_mask(level[point], 150), contact_mask(found[point], 150)
        assert stands.sum() > 50
        assert (stands & kept).sum() >= 0.95 * stands.sum()


def test_steps_on_the_spot_show_no_slope() -> None:
    soles = _walk(0.0)
    soles[90:, 0, :, 2] += 0.03  # from here on the left foot stands on something
    assert np.linalg.norm(find_floor_slope(soles, UPRIGHT, SLOPE_RATE).gradient) < 0.005


def test_stairs_are_no_slope() -> None:
    assert not find_floor_slope(_tilted(_walk(0.6), (0.4, 0.0)), UPRIGHT, SLOPE_RATE).gradient.any()


def test_legs_that_do_not_stand_show_no_slope() -> None:
    assert not find_floor_slope(_tilted(_walk(1.2), (0.03, 0.0)), ~UPRIGHT, SLOPE_RATE).gradient.any()


# The floor that a motion's own footprints show, and heels that leave it.


BODY = make_morphology(leg_scale=1.1)
WALK, CONTACTS = walk(240)
POSITIONS = realize_motion(WALK, BODY)[0]


@given(st.floats(-0.02, 0.02), st.floats(-0.05, 0.05))
def test_a_floor_that_drifts_is_found_as_far_as_it_drifts(slope: float, height: float) -> None:
    """A body raised by a floor that climbs through time is lowered by it again."""
    seconds = WALK.times
    floor = height + slope * seconds
    raised = POSITIONS.copy()
    raised[:, :, 2] += floor[:, None]
    usual = captured_floor(CONTACTS, POSITIONS, BODY, WALK.frame_rate)
    found = captured_floor(CONTACTS, raised, BODY, WALK.frame_rate) - usual
    inner = slice(60, 180)
    assert np.abs(found - floor)[inner].max() < 0.4 * abs(slope) + 1e-9


def test_who_never_stands_shows_no_floor() -> None:
    assert not captured_floor((), POSITIONS, BODY, WALK.frame_rate).any()


def _at_heights(heights: np.ndarray) -> np.ndarray:
    return np.stack([np.zeros(len(heights)), np.zeros(len(heights)), heights], axis=1)


def _rising(ankle: np.ndarray, ball: np.ndarray | float = 0.02) -> np.ndarray:
    """Frames in which the heel of a foot that stands all the time rises, from heights (F,)."""
    frames, stands = len(ankle), np.ones(len(ankle), dtype=bool)
    return rising_heels(
        [(0, frames - 1)], stands, _at_heights(ankle), _at_heights(np.broadcast_to(ball, frames)), 0.85, RATE
    )


@given(st.floats(0.02, 0.08), st.integers(30, 60))
def test_a_heel_stands_until_it_rises(rise: float, begin: int) -> None:
    """A heel is in contact until it rises over a ball that stands."""
    frames = np.arange(90)
    heights = 0.08 + rise * np.clip((frames - begin) / (89 - begin), 0.0, 1.0)
    rising = _rising(heights)
    assert not rising[: begin + 1].any()
    assert rising[-1]
    assert np.all(np.diff(rising.astype(int)) >= 0)
    assert (heights[~rising] < 0.08 + 0.01).all()


def test_a_heel_that_trembles_stands() -> None:
    assert not _rising(0.08 + 0.006 * np.sin(np.arange(90) / 3)).any()


@given(st.floats(-0.02, 0.02), st.floats(0.02, 0.08))
def test_a_floor_that_drifts_lifts_no_heel(drift: float, rise: float) -> None:
    """The whole foot rises or sinks by ``drift`` metres in two seconds, until its heel rises over the ball."""
    frames = np.arange(120)
    floor = drift * frames / 119
    lift = 0.06 + rise * np.clip((frames - 80) / 39, 0.0, 1.0)
    assert not _rising(floor + 0.08, floor + 0.02).any()
    assert not _rising(floor + 0.02 + lift, floor + 0.02)[:81].any()


@pytest.mark.parametrize("seed", range(4))
def test_noise_of_a_heel_that_stands_is_no_rise(seed: int) -> None:
    """Half a degree of noise in every joint moves ankles by a centimetre."""
    noise = np.random.default_rng(seed).normal(scale=0.012, size=(2, 300, 3))
    ankle, ball = _at_heights(np.full(300, 0.08)) + noise[0], _at_heights(np.full(300, 0.02)) + noise[1]
    rising = rising_heels([(0, 299)], contact_mask([(0, 299)], 300), ankle, ball, 0.85, RATE)
    assert rising.mean() < 0.05
