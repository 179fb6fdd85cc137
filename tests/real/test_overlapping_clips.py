"""Clips of people that overlap: no foot jumps, whenever the next clip begins."""

from dataclasses import replace

import numpy as np
import pytest

from studio import api
from tests.captures import capture_file, outside

WALK, RUN, CRAWL, LIFT = (
    f"bvh/varied/accad_{name}.bvh"
    for name in ("female1_B03_Walk1", "female1_C03_Run", "female1_A11_CrawlForward", "male2_A6_BoxLift")
)
GROWTH = 2.0


def peak_speeds(scene: api.Scene, performer_id: str) -> np.ndarray:
    """Highest speeds of both ankles, metres a second."""
    adapted = scene.adapt(performer_id)[performer_id].performance.adapted
    ankles = [adapted.morphology.layout.ankle_point(side) for side in range(2)]
    return np.linalg.norm(np.diff(adapted.positions[:, ankles], axis=0), axis=2).max(axis=0) * adapted.frame_rate


@pytest.mark.parametrize(
    ("first", "second", "begins"),
    outside((RUN, LIFT, 0.6), (RUN, LIFT, 0.8), (RUN, LIFT, 1.0), (WALK, CRAWL, 6.0), (WALK, CRAWL, 5.0)),
)
def test_feet_are_hardly_faster_than_in_either_clip_where_the_next_one_begins_before_the_end(first, second, begins):
    """A run into a lift moved an ankle at 49 m/s, a walk into a crawl at 13 m/s."""
    scene = api.new_scene()
    body = scene.add_character("adult_woman")
    motions = [scene.add_capture(capture_file(name)) for name in (first, second)]
    performers = [scene.add_performer(body, motion_id) for motion_id in motions]
    alone = np.max([peak_speeds(scene, each) for each in performers])
    [ends], [begun] = (scene.project.performers[each].clips for each in performers)
    scene.play(performers[0], ends, replace(begun, start=begins))
    assert peak_speeds(scene, performers[0]).max() < GROWTH * alone
