"""One target for three bodies, each with the strike of the bundled library that the search finds for it (P09, figures
1, 8).
"""

from dataclasses import replace
from pathlib import Path

import numpy as np

from studio.core.body.morphology import Morphology
from studio.core.constraints.follow import FollowProp
from studio.core.mesh import hand_shapes
from studio.core.mesh.character import Character
from studio.core.normalized.motion import NormalizedMotion
from studio.core.normalized.normalize import detected_contacts, normalize_capture
from studio.core.normalized.realize import realize_motion
from studio.core.stage.clip import Clip
from studio.core.stage.project import Motion, Performer, Project
from studio.core.stage.prop import Prop, PropShape
from studio.io.importing import load_capture
from studio.library.indexing import bundled_library
from studio.library.inserted_strike import StrikeScene, inserted_strike
from studio.library.scenes.stagehand import BUNDLED_FRAME_RATE, source_motions, varied_characters
from studio.library.searching import Result, StrikeQuery, search_strikes
from studio.library.striking import tried_strikes

FIGHTER_BODIES = ("child", "adult_woman", "giant")
GUARD_FRAMES = (240, 300)
"""First and last frame of the punch in which the fighter only stands on guard; the strike begins at the last one."""
STRIKE_BEGIN = (GUARD_FRAMES[1] - GUARD_FRAMES[0]) / BUNDLED_FRAME_RATE
"""Stage second at which the strikes begin."""
TARGET_AHEAD, TARGET_HEIGHT = 0.7, 1.1
"""Distance of the target ahead of the root, and its height above the ground, in metres."""
BALL_DIAMETER = 0.12
"""Diameter of the target in metres."""
FIGHTER_SPACING = 2.0
"""Metres from one body to the next."""
MOST_STRIKES_TRIED = 4
"""Maximum number of strikes that are solved to choose the one that meets the target."""


def one_target() -> Project:
    """Project of the scene. Raises StudioError if a bundled file cannot be read."""
    stuff = source_motions(guard=("Guard", "straight_punch"))
    guard, _ = normalize_capture(stuff.captures["straight_punch"])
    library, people = bundled_library(), varied_characters(5)
    project = Project(stuff.captures, stuff.motions, {}, {}, {}, stuff.contacts)
    for index, key in enumerate(FIGHTER_BODIES):
        asked = target_of(guard, GUARD_FRAMES[1], people[key].morphology)
        project = _with_fighter(project, key, people[key], FIGHTER_SPACING * (1 - index), asked)
        scene = StrikeScene(project, key, STRIKE_BEGIN, FollowProp(f"target {key}"))
        found = search_strikes(library, asked, MOST_STRIKES_TRIED)
        project = _with_strike(scene, tried_strikes(found, scene.solved_residual)[0].found)
    return project


def target_of(
    guard: NormalizedMotion, frame: int, body: Morphology, position: tuple[float, float] = (TARGET_AHEAD, TARGET_HEIGHT)
) -> StrikeQuery:
    """Search query for strikes from ``frame`` of the stance ``guard`` at a target ``position``.

    ``position`` is in metres: ahead of the root of ``body``, and above the ground.
    """
    pose = replace(guard, channels=guard.channels[frame : frame + 1])
    x, y, _ = realize_motion(pose, body)[0][0, 0].tolist()
    return StrikeQuery(pose, body, (x + position[0], y, position[1]))


def _with_fighter(project: Project, key: str, character: Character, y: float, asked: StrikeQuery) -> Project:
    """Project with one more body on guard, and a ball at the target of the query ``asked``."""
    performer = Performer(character.name, key, (Clip("guard", *GUARD_FRAMES, id=f"{key} guard"),), (0.0, y))
    x, aside, z = np.asarray(asked.place).tolist()
    ball = Prop(
        f"Target of {character.name.lower()}",
        (BALL_DIAMETER, BALL_DIAMETER, BALL_DIAMETER),
        (x, y + aside, z),
        shape=PropShape.BALL,
    )
    return replace(
        project,
        characters={**project.characters, key: replace(character, grip=hand_shapes.FIST_GRIP)},
        performers={**project.performers, key: performer},
        props={**project.props, f"target {key}": ball},
    )


def _with_strike(scene: StrikeScene, found: Result) -> Project:
    """Project of ``scene`` with the strike ``found`` inserted and its capture added."""
    take, key = found.clip.take, scene.performer_id
    motion_id, capture = take.motion.name, load_capture(Path(take.path))
    contacts = {f"{motion_id} {index}": each for index, each in enumerate(detected_contacts(capture, motion_id))}
    project = replace(
        scene.project,
        captures={**scene.project.captures, motion_id: capture},
        motions={**scene.project.motions, motion_id: Motion(motion_id.replace("_", " ").capitalize(), motion_id)},
        contacts={**scene.project.contacts, **contacts},
    )
    return inserted_strike(replace(scene, project=project), found, motion_id, f"{key} strike", f"target {key}")
