"""A stage set without anyone arranging it: one capture, performed by some characters side by side."""

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from studio.core.body.kinematics import joint_world
from studio.core.body.pose import PoseSequence
from studio.core.captures.capture import Capture
from studio.core.captures.contacts import ContactInterval
from studio.core.mesh.character import Character
from studio.core.stage.clip import Clip
from studio.core.stage.project import Motion, Performer, Project

SPACING = 1.15
"""Metres from one performer to the next."""
LEAST_TRAVEL = 1.0
"""Metres; a motion that goes less far has no direction of travel."""
SPACING_SAMPLES = 64


def side_by_side(characters: Mapping[str, Character], clips: tuple[Clip, ...] = ()) -> dict[str, Performer]:
    """One performer a character under the same id, in a row across the direction of the motion."""
    middle = (len(characters) - 1) / 2
    return {
        key: Performer(character.name, key, clips, (0.0, SPACING * (middle - place)))
        for place, (key, character) in enumerate(characters.items())
    }


def travel_heading(capture: Capture, first: int, last: int) -> float | None:
    """Heading in radians in which the body travels from frame ``first`` to ``last``; None where it stays about.

    It leads to where the root is farthest from its beginning, so that a walk there and back has one as well.
    """
    if capture.body_map is None:
        return None
    rows = np.linspace(first, last, min(SPACING_SAMPLES, last - first + 1)).round().astype(np.int64)
    poses = PoseSequence(capture.poses.local_rotations[rows], capture.poses.local_translations[rows])
    places, _ = joint_world(capture.skeleton, poses)
    root = places[:, capture.body_map.spine[0], :2]
    ways = root - root[0]
    x, y = ways[np.argmax(np.linalg.norm(ways, axis=1))].tolist()
    return math.atan2(y, x) if math.hypot(x, y) >= LEAST_TRAVEL else None


def lined_up(performers: Mapping[str, Performer], travel: float) -> dict[str, Performer]:
    """The performers in a row across heading ``travel`` about their middle, in the order in which they stand along it.

    They all face as their motion does.
    """
    across = np.array([-math.sin(travel), math.cos(travel)])
    places = np.array([each.position for each in performers.values()])
    middle = places.mean(axis=0)
    order = np.argsort(-(places @ across), kind="stable")
    rank = np.empty(len(order))
    rank[order] = np.arange(len(order))
    offsets = SPACING * ((len(order) - 1) / 2 - rank)
    row = (middle + offsets[:, None] * across).tolist()
    return {
        key: replace(each, position=(x, y), heading=0.0)
        for (key, each), (x, y) in zip(performers.items(), row, strict=True)
    }


def is_unarranged(performers: Mapping[str, Performer]) -> bool:
    """True if the performers stand in a row as ``side_by_side`` or ``lined_up`` puts them."""
    places = np.array([each.position for each in performers.values()])
    if len(places) < 2 or any(each.heading for each in performers.values()):
        return False
    across = places[0] - places[-1]
    travel = math.atan2(-across[0], across[1])
    row = [each.position for each in lined_up(performers, travel).values()]
    return bool(np.allclose(places, row, atol=1e-6))


def staged(
    capture: Capture, contacts: tuple[ContactInterval, ...], characters: Mapping[str, Character], motion_id: str
) -> Project:
    """A project in which every character performs the capture from where its motion begins to its last frame.

    ``contacts`` are those of ``motion_id``, the id that capture and motion get.
    """
    clips = (Clip(motion_id, capture.first_frame, capture.frame_count - 1, id=f"{motion_id} clip"),)
    return Project(
        captures={motion_id: capture},
        motions={motion_id: Motion(capture.name, motion_id)},
        characters=characters,
        performers=side_by_side(characters, clips),
        contacts={f"contact {place}": contact for place, contact in enumerate(contacts)},
    )
