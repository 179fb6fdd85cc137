"""One target for three bodies; each plays the strike of the bundled library that is found for it (P09,
figures 1, 8).
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
from studio.library.scenes.stagehand import BUNDLED_FRAME_RATE, bodies, material
from studio.library.searching import Result, StrikeQuery, search_strikes
from studio.library.striking import EASED_IN, aimed_constraint, tried_strikes

FIGHTER_BODIES = ("child", "adult_woman", "giant")
GUARD_FRAMES = (240, 300)
"""Frames of the punch in which the fighter only stands on guard; the strike takes over from the last one."""
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
    stuff = material(guard=("Guard", "straight_punch"))
    guard, _ = normalize_capture(stuff.captures["straight_punch"])
    library, people = bundled_library(), bodies(5)
    project = Project(stuff.captures, stuff.motions, {}, {}, {}, stuff.contacts)
    for place, key in enumerate(FIGHTER_BODIES):
        asked = target_of(guard, GUARD_FRAMES[1], people[key].morphology)
        best = tried_strikes(search_strikes(library, asked, MOST_STRIKES_TRIED), asked)[0].found
        project = _with_fighter(project, key, people[key], FIGHTER_SPACING * (1 - place), asked, best)
    return project


def target_of(
    guard: NormalizedMotion, frame: int, body: Morphology, position: tuple[float, float] = (TARGET_AHEAD, TARGET_HEIGHT)
) -> StrikeQuery:
    """Search query for strikes from ``frame`` of the guard stance ``guard`` at a target ``position``: metres ahead of
    the root of ``body``, and above the ground.
    """
    pose = replace(guard, channels=guard.channels[frame : frame + 1])
    x, y, _ = realize_motion(pose, body)[0][0, 0].tolist()
    return StrikeQuery(pose, body, (x + position[0], y, position[1]))


def _with_fighter(
    project: Project, key: str, character: Character, y: float, asked: StrikeQuery, found: Result
) -> Project:
    """``project`` with one more body that stands on guard and then plays the strike found for it."""
    motion_id, target, begins = (
        found.clip.take.motion.name,
        f"target {key}",
        (GUARD_FRAMES[1] - GUARD_FRAMES[0] + 1) / BUNDLED_FRAME_RATE,
    )
    capture = load_capture(Path(found.clip.take.path))
    contacts = {f"{motion_id} {place}": each for place, each in enumerate(detected_contacts(capture, motion_id))}
    clip = Clip(
        motion_id, found.start, found.clip.label.last, begins, f"{key} strike", ease=EASED_IN * found.seconds_to_hit
    )
    performer = Performer(character.name, key, (Clip("guard", *GUARD_FRAMES, id=f"{key} guard"), clip), (0.0, y))
    x, aside, z = np.asarray(asked.place).tolist()
    ball = Prop(
        f"Target of {character.name.lower()}",
        (BALL_DIAMETER, BALL_DIAMETER, BALL_DIAMETER),
        (x, y + aside, z),
        shape=PropShape.BALL,
    )
    return replace(
        project,
        captures={**project.captures, motion_id: capture},
        motions={**project.motions, motion_id: Motion(motion_id.replace("_", " ").capitalize(), motion_id)},
        contacts={**project.contacts, **contacts},
        characters={**project.characters, key: replace(character, grip=hand_shapes.FIST_GRIP)},
        performers={**project.performers, key: performer},
        props={**project.props, target: ball},
        constraints={**project.constraints, target: aimed_constraint(found, clip, FollowProp(target), asked.body)},
    )
