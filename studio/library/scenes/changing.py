"""Scenes of bodies and grounds that differ or change: clapping hands, a walk over steps, growing bodies."""

from dataclasses import replace

from studio.core.body.canonical import BodyPart
from studio.core.body.growth import KeyedProportions
from studio.core.body.morphology import Proportions
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.constraints.distance import DistanceConstraint
from studio.core.curves.activation import ActivationCurve
from studio.core.curves.keyed import KeyedNumber
from studio.core.grounds.steps import Steps
from studio.core.stage.clip import Clip
from studio.core.stage.project import GROUND_ID, Project
from studio.library.scenes.papers import performers_in_one_motion
from studio.library.scenes.stagehand import BUNDLED_FRAME_RATE, source_motions

GUARD_STANCE_FRAMES = (240, 340)
"""First and last frame of the punch between which the body only stands, both hands before the chest."""
APART_PALMS_METRES, TOGETHER_PALMS_METRES = 0.45, 0.0
"""Distance in metres between the palms between claps, and in a clap."""
CLAP_SECONDS = (0.5, 1.0, 1.5)
"""Times in seconds at which the hands meet."""
ARM_SCALES = (0.8, 1.0, 1.25)
PALM_POINTS = tuple(BodyPoint(BodyPart(f"{side}_hand"), (0.0, 0.0, 0.08)) for side in ("left", "right"))
"""Middle of the left and of the right palm."""
STEP_RISE_METRES, STEP_TREAD_METRES = 0.10, 0.45
"""Height and depth of a step in metres."""


def clap() -> Project:
    """Project of three bodies with short, usual and long arms that clap at the same moments (K05, section 8)."""
    project = performers_in_one_motion(source_motions(rest=("Stand", "straight_punch")), "rest", 3, same=True)
    [(key, character)] = project.characters.items()
    characters = {
        f"{key} {index}": replace(
            character,
            name=("Short arms", "Usual arms", "Long arms")[index],
            proportions=Proportions(upper_arms=factor, forearms=factor),
        )
        for index, factor in enumerate(ARM_SCALES)
    }
    clips = (Clip("rest", *GUARD_STANCE_FRAMES, id="clip"),)
    performers = {
        name: replace(performer, name=characters[own].name, character_id=own, clips=clips)
        for (name, performer), own in zip(project.performers.items(), characters, strict=True)
    }
    begin, end = (frame / BUNDLED_FRAME_RATE for frame in GUARD_STANCE_FRAMES)
    beats = [(begin + CLAP_SECONDS[0] - 0.25, APART_PALMS_METRES)]
    for second in CLAP_SECONDS:
        beats += [(begin + second, TOGETHER_PALMS_METRES), (begin + second + 0.25, APART_PALMS_METRES)]
    times, distances = zip(*beats, strict=True)
    hands = DistanceConstraint(
        "rest", "Clap", PALM_POINTS[0], Chain(), 0, ActivationCurve(begin, begin + 0.25, end - 0.05, end),
        other=PALM_POINTS[1], distance=KeyedNumber(times, distances),
    )  # fmt: skip
    return replace(project, characters=characters, performers=performers, constraints={"clap": hands})


def steps() -> Project:
    """Project of five bodies that walk up a flight of low steps and turn on it (K05, section 7)."""
    project = performers_in_one_motion(source_motions(walk=("Walk and turn", "walk_turn")), "walk", 5, apart=1.3)
    return replace(
        project, grounds={GROUND_ID: Steps(rise=STEP_RISE_METRES, tread=STEP_TREAD_METRES, count=12, start=(0.5, 0.0))}
    )


def growing() -> Project:
    """Project of one body that grows and one that shrinks while they walk (K05, section 10)."""
    project = performers_in_one_motion(source_motions(walk=("Walk and turn", "walk_turn")), "walk", 2, apart=1.6)
    ways = (("Grows", 0.8, 1.3), ("Shrinks", 1.3, 0.75))
    for (key, character), (name, before, after) in zip(project.characters.items(), ways, strict=True):
        keys = KeyedProportions((1.0, 7.0), (Proportions(stature=before), Proportions(stature=after)))
        project = project.with_entity("characters", key, replace(character, name=name, proportions=keys))
    performers = [
        (key, replace(each, name=name), None)
        for (key, each), (name, _, _) in zip(project.performers.items(), ways, strict=True)
    ]
    return project.with_entities("performers", performers)
