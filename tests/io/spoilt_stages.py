"""A stage with something of every kind, and values of its file that are something else, one file a seed."""

import json
import math
import zipfile
from dataclasses import replace
from pathlib import Path
from random import Random
from typing import Any

import numpy as np

from studio.core.body.canonical import BodyPart
from studio.core.constraints.base import BodyPoint
from studio.core.constraints.follow import FollowPerformer
from studio.core.constraints.position import PositionConstraint
from studio.core.curves.keyed import KeyedNumber, KeyedPlace
from studio.core.errors import StudioError
from studio.core.grounds.slope import Slope
from studio.core.solver.adapt import adapt
from studio.core.solver.performers.staged_performances import adapt_performers
from studio.core.stage.behaviour import Behaviour, Role
from studio.core.stage.clip import Clip
from studio.core.stage.correction import PoseOffsets
from studio.core.stage.footage import Footage
from studio.core.stage.layer import Layer
from studio.core.stage.project import GROUND_ID, Project
from studio.core.stage.prop import InHand, Prop
from studio.core.stage.ready_made import guard_behaviour, with_distance_kept, with_lean_away, with_parry, with_strike
from studio.core.stage.saved_camera import CameraPlacement, SavedCamera
from studio.core.stage.sound_track import SoundTrack
from studio.document.correction_edits import new_correction
from studio.io.project.project_file import read_project, write_project
from studio.jobs.performances import prepared_capture, stage_duration
from studio.live.playing_stage import LiveStage
from tests.builders import make_project
from tests.io.test_constraint_kinds_stored import COMMON, CONSTRAINTS

ID = "0" * 32
HAND = BodyPoint(BodyPart.RIGHT_HAND)
ODD: tuple[Any, ...] = (
    None, True, -1, 0, 1, 7, 0.5, -0.0, 1e-9, 1e9, 10**400, 1e308, "", "x", "performer 1", [], {}, [[]], [1.0, 2.0],
    {"member": "x"}, [None] * 3, "\ud800", {"a": {}},
)  # fmt: skip
STEPS = 6
LONGEST = 20.0
"""Seconds of the longest row that is performed whole."""


def stage_project() -> Project:
    """Two performers with layers, behaviours and every kind of constraint, props, corrections, cameras and media."""
    project = make_project(frames=20)
    clip = replace(project.performers["performer 0"].clips[0], speed=KeyedNumber((0.05, 0.2), (1.0, 2.0)))
    row = (clip, Clip("motion", 3, 16, 1.0, "second", joined=True, repeats=2, mirrored=True))
    layer = Layer(Clip("motion", 0, 9, 0.1, "layer"), additive=True)
    guard = with_strike(
        with_distance_kept(guard_behaviour(Clip("motion", 0, 9, id="guard"))), Clip("motion", 4, 12, id="hit"), "K"
    )
    fighter = with_lean_away(with_parry(guard, Clip("motion", 2, 15, id="block")))
    cast = Role("performer 0", "performer 1"), Role("performer 1", "performer 0")
    one = project.performers["performer 0"]
    reach = FollowPerformer("performer 1", HAND)
    correction = new_correction("Elbow", "performer 0", 0.2)
    turned = PoseOffsets(((BodyPart.LEFT_FOREARM, (0.3, 0.0, 0.0)),))
    added: dict[str, dict[str, Any]] = {
        "performers": {"performer 0": replace(one, clips=row, layers=(layer,))},
        "behaviours": {"fighter": replace(fighter, cast=cast), "idle": Behaviour("Idle", guard_behaviour(None).states)},
        "constraints": {
            **{f"kind {number}": each for number, each in enumerate(CONSTRAINTS)},
            "touch": PositionConstraint("motion", "Touch", HAND, *COMMON, target=reach),
        },
        "props": {
            "box": Prop("Box", position=KeyedPlace((0.0, 0.2), ((0.5, 0.0, 0.2), (0.6, 0.1, 0.3)))),
            "stick": Prop("Stick", held=InHand(performer_id="performer 0", point=HAND, begin=0.05, end=0.2)),
        },
        "corrections": {"elbow": correction.with_key(0.1, turned)},
        "cameras": {"front": SavedCamera("Front", CameraPlacement((0.0, 0.0, 1.0), 3.0, 0.3), 1)},
        "sounds": {"steps": SoundTrack("Steps", "steps.wav", (0, 255), (0.01,), 0.5)},
        "footage": {"walk": Footage("Walk", "walk.mp4", 40, 24.0, 12.0)},
        "grounds": {GROUND_ID: Slope(0.0, math.radians(5.0))},
    }
    for collection, entities in added.items():
        for key, entity in entities.items():
            project = project.with_entity(collection, key, entity)
    return project


def replace_a_value(random: Random, record: Any) -> None:
    """Replace one value of a JSON record, somewhere, by something else."""
    place = record
    while True:
        key = random.choice(list(place) if isinstance(place, dict) else range(len(place)))
        if not isinstance(place[key], dict | list) or not place[key] or random.random() < 0.1:
            place[key] = random.choice(ODD)
            return
        place = place[key]


def play(seed: int, folder: Path) -> bool:
    """Open a spoilt stage, save it, perform it and let it play live; returns whether it could be opened.

    Raises AssertionError where positions are not finite; only StudioError is a refusal.
    """
    whole, path = folder / "whole.studio", folder / "spoilt.studio"
    if not whole.exists():
        write_project(whole, stage_project(), ID)
    with zipfile.ZipFile(whole) as archive:
        members = {name: archive.read(name) for name in archive.namelist() if name != "manifest.json"}
    random, record = Random(seed), json.loads(members["project.json"])
    for _ in range(random.choice([1, 1, 2, 5])):
        chosen = random.choice([*record, "behaviours", "performers", "props"])
        replace_a_value(random, record[chosen] if isinstance(record[chosen], list) and record[chosen] else record)
    members["project.json"] = json.dumps(record).encode()
    with zipfile.ZipFile(path, "w") as archive:
        for name, content in members.items():
            archive.writestr(name, content)
    try:
        project = read_project(path).project
    except StudioError:
        return False
    write_project(folder / "again.studio", project, ID)
    assert_plays(project)
    return True


def assert_plays(project: Project) -> None:
    """Assert that every performer is performed and plays live at finite positions, or is refused in a sentence."""
    short = [key for key in project.performers if stage_duration(project, key) <= LONGEST]
    for performance in adapt_performers(project, short, prepared_capture, adapt).performances.values():
        assert np.isfinite(performance.adapted.positions).all(), "positions that are not finite"
    stage = LiveStage(project, prepared_capture)
    for number in range(STEPS):
        if number == STEPS // 2:
            stage.press("K")
        for shown in stage.step(1.0 / 60.0).values():
            assert np.isfinite(shown.positions).all(), "live positions that are not finite"
