"""A prop that is handed on while the stage plays live."""

import numpy as np

from studio.core.solver.adapt import body_point_positions
from studio.core.solver.performers.prop_tracks import Holder, stage_track
from studio.core.stage.placement import Placement
from studio.live.playing_stage import LiveStage
from tests.core.test_props import GIVEN, LEFT, RIGHT, handing, on_side
from tests.live.test_live_stage import STEP, prepare


def test_a_box_that_is_handed_on_goes_from_hands_to_hands_and_stays_with_them_whatever_they_play_next():
    project, given = handing(), GIVEN
    one, other = list(project.performers)[:2]
    prop = project.props["box"]
    stage = LiveStage(project, prepare, given - 0.75)
    places = []
    for step in range(150):
        if step == 90:
            stage.start(other, project.performers[other].clips[0])
        results = stage.step(STEP if step else 0.0)
        assert not stage.failures
        holders = {
            key: Holder(each, [0.0], Placement.of(project.performers[key]), timing=each.composite.timing)
            for key, each in results.items()
        }
        track = stage_track(prop, [stage.seconds], holders)
        places.append(track.positions[0])
        for key, holds in ((one, stage.seconds < given), (other, stage.seconds > given)):
            for side, palm in ((1.0, LEFT), (-1.0, RIGHT)):
                there = track.positions[0] + track.rotations[0] @ on_side(prop, side)
                hand = Placement.of(project.performers[key]).to_stage(body_point_positions(palm, results[key])[0])
                assert not holds or step > 85 or np.linalg.norm(hand - there) < 2e-3
    steps = np.linalg.norm(np.diff(np.array(places), axis=0), axis=1)
    assert np.linalg.norm(places[-1] - places[0]) > 0.5
    assert steps.max() < 0.09  # a walk, and the steepest of an ease of half a metre in 0.3 s
