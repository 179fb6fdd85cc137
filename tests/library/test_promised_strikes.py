"""A strike that is promised to meet its target does so once it is inserted."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from studio.core.captures.capture import Capture
from studio.core.captures.contacts import ContactInterval
from studio.core.constraints.base import Chain
from studio.core.constraints.position import PositionConstraint
from studio.core.curves.activation import ActivationCurve
from studio.core.grounds.slope import Slope
from studio.core.mesh.character import Character
from studio.core.normalized.encode import encode_motion
from studio.core.normalized.normalize import detected_contacts
from studio.core.solver.adapt import body_point_positions
from studio.core.solver.performers.rows import timing_of
from studio.core.stage.clip import Clip
from studio.core.stage.placement import Placement
from studio.core.stage.project import GROUND_ID, Motion, Performer, Project
from studio.io.importing import load_capture
from studio.io.project.character_file import bundled_characters
from studio.jobs.performances import adapted_performers
from studio.library.clip_labels import hit_point
from studio.library.indexing import bundled_library
from studio.library.inserted_strike import TRIED_STRIKE_ID, StrikeScene, inserted_strike
from studio.library.library import Library
from studio.library.searching import Result, StrikeQuery, search_strikes
from studio.library.striking import VISIBLE_RESIDUAL_METRES, TriedStrike, tried_strikes

EXAMPLES = Path(__file__).resolve().parents[2] / "examples" / "captures"
PEOPLE = bundled_characters()
RATE = 60.0
LOW, HIGH = [-0.5, -0.6, -0.5], [0.9, 0.6, 0.8]
"""Corners of the box round the root, in metres, in which targets lie."""
ROWS: Mapping[str, tuple[Clip, ...]] = {
    "turn": (Clip("walk_turn", 0, 283, id="one"),),
    "kick": (Clip("front_kick", 0, 176, id="one"),),
    "guard": (Clip("straight_punch", 0, 60, id="one"),),
    "walk and kick": (Clip("walk_turn", 60, 240, id="one"), Clip("front_kick", 0, 176, 2.7, id="two")),
    "long": (Clip("walk_turn", 0, 500, id="one"), Clip("front_kick", 0, 330, 8.0, id="two"),
             Clip("walk_turn", 60, 200, 13.2, id="three", mirrored=True)),
    "loop": (Clip("front_kick", 0, 200, id="one", repeats=3, turn=0.4, offset=(0.3, 0.2)),),
}  # fmt: skip


@cache
def strikes() -> Library:
    """The bundled strikes."""
    return bundled_library()


@cache
def capture_in(path: str) -> tuple[Capture, tuple[ContactInterval, ...]]:
    """Capture of a file, and its contacts of a motion of that path."""
    capture = load_capture(Path(path))
    return capture, detected_contacts(capture, path)


def with_motion(project: Project, motion_id: str, path: str) -> Project:
    capture, found = capture_in(path)
    contacts = {f"{motion_id} {index}": replace(each, motion_id=motion_id) for index, each in enumerate(found)}
    return replace(
        project,
        captures={**project.captures, motion_id: capture},
        motions={**project.motions, motion_id: Motion(motion_id, motion_id)},
        contacts={**project.contacts, **contacts},
    )


def staged_row(character: Character, row: str) -> Project:
    project = Project(characters={"body": character})
    for name in dict.fromkeys(clip.motion_id for clip in ROWS[row]):
        project = with_motion(project, name, str(EXAMPLES / f"{name}.bvh"))
    performer = Performer("Body", "body", ROWS[row], (0.4, -0.7), 0.6)
    return replace(project, performers={"body": performer})


def tried_in(
    project: Project, seeds: range, low: list[float], high: list[float]
) -> Iterator[tuple[StrikeScene, TriedStrike]]:
    """Scene and result of each strike that is tried at random targets round the body at the end of its row."""
    performer, adapted = project.performers["body"], adapted_performers(project)["body"]
    clip, timing = performer.clips[-1], timing_of(project, performer)
    time = clip.start + clip.length(RATE)
    row = slice(round((time - timing.begin) * timing.frame_rate), None)
    pose = encode_motion(adapted.positions[row][:1], adapted.rotations[row][:1], adapted.morphology, RATE)
    root, library = adapted.positions[row][0, 0], strikes()
    for seed in seeds:
        place = root + np.random.default_rng(seed).uniform(low, high)
        target = Placement.of(performer).to_stage(place)
        scene = StrikeScene(project, "body", time, target)
        found = search_strikes(library, StrikeQuery(pose, adapted.morphology, place))
        for each in tried_strikes(found, scene.solved_residual):
            yield scene, each


def missed_once_inserted(scene: StrikeScene, found: Result) -> float:
    """Distance in metres between what hits and its target on the stage, in the project that the window makes."""
    project = with_motion(scene.project, "strike", found.clip.take.path)
    scene = replace(scene, project=project)
    made = inserted_strike(scene, found, "strike", "struck", TRIED_STRIKE_ID)
    adapted, performer = adapted_performers(made)["body"], made.performers["body"]
    timing = timing_of(made, performer)
    hit = round((scene.time + found.seconds_to_hit - timing.begin) * timing.frame_rate)
    reached = Placement.of(performer).to_stage(
        body_point_positions(made.constraints[TRIED_STRIKE_ID].point, adapted)[hit]
    )
    return float(np.linalg.norm(reached - scene.target))


def assert_promises_are_kept(project: Project, seeds: range) -> None:
    promised = 0
    for scene, each in tried_in(project, seeds, LOW, HIGH):
        if each.hits:
            assert missed_once_inserted(scene, each.found) < 2.0 * VISIBLE_RESIDUAL_METRES, each.found.clip.name
            promised += 1
    assert promised >= 2 * len(seeds)


@pytest.mark.parametrize("row", ROWS)
@pytest.mark.parametrize(("seed", "body"), [(0, "child"), (1, "giant")])
def test_a_promise_is_kept_in_every_row(seed, body, row):
    """Blows were tried from a pose at rest, a frame late, and without earlier changes of clips: up to 95 cm short."""
    assert_promises_are_kept(staged_row(PEOPLE[body], row), range(seed, seed + 1))


def test_a_promise_is_kept_on_a_slope():
    """Trials knew no ground but the level one at zero."""
    project = staged_row(PEOPLE["adult_woman"], "guard")
    assert_promises_are_kept(replace(project, grounds={GROUND_ID: Slope(0.1, math.radians(15.0), 0.5)}), range(2))


def test_a_strike_that_another_constraint_keeps_short_is_not_promised():
    """Trials knew no other constraint of the scene."""
    project = staged_row(PEOPLE["child"], "guard")
    scene, best = next(pair for pair in tried_in(project, range(1), LOW, HIGH) if pair[1].hits)
    label, path = best.found.clip.label, best.found.clip.take.path
    project, span = with_motion(project, "strike", path), ActivationCurve(0.0, 0.0, 20.0, 20.0)
    point = hit_point(label.limb, label.segment, PEOPLE["child"].morphology)
    held = PositionConstraint("strike", "Held back", point, Chain(limb=1.0), 0, span, target=(0.0, 0.0, 0.3))
    free = replace(scene, project=project, motions_by_path={path: "strike"})
    kept = replace(free, project=replace(project, constraints={"held": held}))
    assert free.solved_residual(best.found) < VISIBLE_RESIDUAL_METRES < 0.1 < kept.solved_residual(best.found)


def test_a_trial_changes_nothing_but_what_is_inserted():
    project = staged_row(PEOPLE["child"], "guard")
    scene, best = next(tried_in(project, range(1), LOW, HIGH))
    made = inserted_strike(scene, best.found, "straight_punch", "struck", "aimed")
    assert made.performers["body"].clips[:-1] == project.performers["body"].clips
    assert {*made.constraints} - {*project.constraints} == {"aimed"}
    assert (made.captures, made.contacts, made.props) == (project.captures, project.contacts, project.props)
