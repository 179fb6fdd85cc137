"""Fades of a correction that brings a whole pose at once."""

from dataclasses import replace

import numpy as np
import pytest

from studio import api
from studio.core.solver.performers.rows import timing_of
from studio.core.stage.correction import PoseOffsets, new_correction
from studio.core.stage.holding import REACH_SPEED
from studio.core.stage.local_pose import POSE_REGIONS, local_pose, offsets_towards
from studio.engine.correction_range import with_fitted_fades
from studio.engine.posed_performer import row_at

GROWTH = 1.2
"""Contacts and balance of the body may add something to the fitted tenth."""
SAVED_AT = 1.0


@pytest.mark.parametrize("speed", [1.0, 1.5])
@pytest.mark.parametrize("applied_at", [1.0, 1.6])
def test_no_limb_becomes_much_faster_where_a_saved_pose_is_applied(applied_at, speed):
    """Arms that hang in a walk were in a fighter's guard within a fifth of a second, at 7 m/s."""
    scene = api.new_scene()
    walk, fight = (
        scene.add_capture(api.example_captures_folder() / f"{name}.bvh") for name in ("walk_turn", "straight_punch")
    )
    body = scene.add_character("adult_woman")
    walker, fighter = (scene.add_performer(body, motion_id) for motion_id in (walk, fight))
    [clip] = scene.project.performers[walker].clips
    scene.play(walker, replace(clip, speed=speed))
    plain, saved = (scene.adapt(key)[key].performance.adapted for key in (walker, fighter))
    timing, time = timing_of(scene.project, scene.project.performers[walker]), applied_at / speed
    layout, parts = plain.morphology.layout, POSE_REGIONS["Whole body"]
    pose = local_pose(layout, saved.rotations[round(SAVED_AT * saved.frame_rate)], 0.0)
    turns = offsets_towards(layout, plain.rotations[row_at(plain, timing, time)], pose, parts, 1.0, {})
    offsets = PoseOffsets(tuple(turns.items()))
    limbs = [point(side) for point in (layout.wrist_point, layout.ankle_point) for side in range(2)]
    ends = [0, layout.head_joint, *limbs]

    def peaks(adapted):
        return np.linalg.norm(np.diff(adapted.positions[:, ends], axis=0), axis=2).max(axis=0) * adapted.frame_rate

    def posed_peaks(correction):
        key = scene.document.add("corrections", correction, "Apply pose")
        found = peaks(scene.adapt(walker)[walker].performance.adapted)
        scene.document.remove("corrections", key, "Delete correction")
        return found

    allowed = GROWTH * np.maximum(peaks(plain), REACH_SPEED)
    made = new_correction("Guard", walker, time, offsets)
    assert (posed_peaks(made) > allowed).any()
    fitted = with_fitted_fades(made, None, timing, plain, time)
    assert (posed_peaks(fitted) <= allowed).all()
    key = scene.document.add("corrections", made, "Apply pose")
    posed = scene.adapt(walker)[walker].performance.adapted
    scene.document.remove("corrections", key, "Delete correction")
    again = with_fitted_fades(fitted, made, timing, posed, time)
    assert again.activation.times == pytest.approx(fitted.activation.times, abs=0.11)
