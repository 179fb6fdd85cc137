"""Bodies side by side: across the direction in which their motion travels."""

import math
from dataclasses import replace

import numpy as np
import pytest

from studio.core.body.pose import PoseSequence
from studio.core.stage.project import Performer
from studio.core.stage.staging import SPACING, end_of_row, is_unarranged, lined_up, travel_heading
from tests.builders import make_capture

ROW = {f"body {k}": Performer(f"Body {k}", "character", position=(0.0, SPACING * (1 - k))) for k in range(3)}


def walking(heading, metres=4.0, there_and_back=False):
    """A capture of which the root goes straight in a heading."""
    capture = make_capture(frames=60)
    way = np.linspace(0.0, 1.0, 60)
    way = np.minimum(way, 1.0 - way) * 2.0 if there_and_back else way
    moves = np.array(capture.poses.local_translations)
    moves[:, 0, :2] = metres * way[:, None] * [math.cos(heading), math.sin(heading)]
    return replace(capture, poses=PoseSequence(capture.poses.local_rotations, moves))


@pytest.mark.parametrize("heading", [0.0, 1.0, math.pi / 2, -2.5])
@pytest.mark.parametrize("there_and_back", [False, True])
def test_a_walk_travels_where_its_root_goes(heading, there_and_back):
    assert travel_heading(walking(heading, there_and_back=there_and_back), 0, 59) == pytest.approx(heading, abs=0.05)


def test_who_stays_about_travels_nowhere():
    assert travel_heading(walking(1.0, metres=0.3), 0, 59) is None


@pytest.mark.parametrize("heading", [0.0, 0.7, math.pi / 2, -2.0])
def test_nobody_in_a_row_walks_into_another(heading):
    performers = lined_up(ROW, heading)
    places = np.array([each.position for each in performers.values()])
    way = np.array([math.cos(heading), math.sin(heading)])
    assert places @ way == pytest.approx(0.0, abs=1e-9)
    gaps = np.linalg.norm(places[:, None] - places, axis=-1)[np.triu_indices(3, 1)]
    assert gaps.min() == pytest.approx(SPACING)
    assert places.mean(axis=0) == pytest.approx([0.0, 0.0], abs=1e-9)


def test_a_row_is_known_from_what_a_user_has_arranged():
    assert is_unarranged(ROW)
    assert is_unarranged(lined_up(ROW, 1.3))
    moved = ROW | {"body 1": replace(ROW["body 1"], position=(0.5, 0.0))}
    turned = ROW | {"body 1": replace(ROW["body 1"], heading=0.5)}
    assert not is_unarranged(moved)
    assert not is_unarranged(turned)


@pytest.mark.parametrize("missing", [["body 1"], ["body 0"], ["body 2"]])
def test_a_row_of_which_some_are_missing_is_still_one(missing):
    row = {key: each for key, each in lined_up(ROW, 0.4).items() if key not in missing}
    assert is_unarranged(row)


def swept_by(reach, way=0.0, travel=0.0):
    """Points of a body whose limbs reach so many metres to both sides, and which goes ``way`` metres across."""
    across, times = np.array([-math.sin(travel), math.cos(travel)]), np.linspace(0.0, 1.0, 30)
    sides = np.array([-reach, 0.0, reach]) * np.sin(math.pi * times)[:, None] + way * times[:, None]
    return sides[..., None] * across


@pytest.mark.parametrize("travel", [0.0, 1.1, -2.0])
@pytest.mark.parametrize(("reach", "ways"), [(0.4, (0.0, 3.0, -2.0)), (1.1, (0.0, 0.0, 0.0)), (0.8, (2.0, 2.0, 2.0))])
def test_those_who_spread_their_limbs_or_whose_paths_cross_stand_farther_apart(travel, reach, ways):
    """Only the roots were looked at: in a split neighbours cut into each other."""
    sweeps = {key: swept_by(reach, way, travel) for key, way in zip(ROW, ways, strict=True)}
    row = lined_up(ROW, travel, sweeps)
    across = np.array([-math.sin(travel), math.cos(travel)])
    tracks = [(np.array(each.position) + sweeps[key]) @ across for key, each in row.items()]
    tracks.sort(key=lambda track: -track[0].mean())
    for left, right in ((0, 1), (0, 2), (1, 2)):
        assert (tracks[left].min(axis=1) - tracks[right].max(axis=1)).min() > 0.29
    assert is_unarranged(row)


def test_those_who_keep_their_limbs_near_or_go_the_same_way_stand_as_near_as_usual():
    for way in (0.0, 5.0):
        row = lined_up(ROW, 0.3, {key: swept_by(0.4, way, 0.3) for key in ROW})
        assert math.dist(row["body 0"].position, row["body 1"].position) == pytest.approx(SPACING)


@pytest.mark.parametrize("heading", [0.0, 1.3, math.pi / 2])
def test_one_more_performer_stands_beyond_the_end_of_the_row_and_far_enough_from_its_neighbour(heading):
    row = lined_up(ROW, heading)
    position = end_of_row(row, {"body 0": 9.0, "body 1": 9.0, "body 2": 1.5 * SPACING})
    assert math.dist(position, row["body 2"].position) == pytest.approx(1.5 * SPACING)
    assert is_unarranged(row | {"new": replace(ROW["body 0"], position=position)})


def test_one_more_performer_on_an_arranged_stage_stands_on_the_right_of_all():
    moved = ROW | {"body 1": replace(ROW["body 1"], position=(0.5, -3.0))}
    assert end_of_row(moved, dict.fromkeys(moved, 1.0)) == pytest.approx((0.5, -3.0 - SPACING))
    assert end_of_row({}, {}) == (0.0, 0.0)
