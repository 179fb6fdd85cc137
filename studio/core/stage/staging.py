"""Default stage: one capture, performed by several characters side by side."""

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from studio.core.body.canonical import BodyPart
from studio.core.body.kinematics import joint_world
from studio.core.body.pose import PoseSequence
from studio.core.captures.capture import Capture
from studio.core.captures.contacts import ContactInterval
from studio.core.mesh.character import Character
from studio.core.stage.clip import Clip
from studio.core.stage.project import Motion, Performer, Project

PERFORMER_SPACING = 1.15
"""Distance in metres from one performer to the next."""
ROW_STEP = 0.5 * PERFORMER_SPACING
"""Step in metres in which the spacing grows for neighbours that need more than ``PERFORMER_SPACING``."""
JOINT_CLEARANCE = 0.3
"""Least distance in metres, across a row, between the joints of two neighbours at any time; hands, feet and flesh reach
beyond the joints.
"""
LEAST_TRAVEL_METRES = 1.0
"""Distance in metres; a motion that stays nearer to its start has no direction of travel."""
HEADING_SAMPLES, SWEEP_SAMPLES = 64, 1024
"""Maximum number of sampled frames of a capture: for its heading, and for the space that it sweeps."""


def performers_side_by_side(characters: Mapping[str, Character], clips: tuple[Clip, ...] = ()) -> dict[str, Performer]:
    """Performers of ``characters``, under the same ids, in a row across the direction of the motion; each plays
    ``clips``.
    """
    middle = (len(characters) - 1) / 2
    return {
        key: Performer(character.name, key, clips, (0.0, PERFORMER_SPACING * (middle - index)))
        for index, (key, character) in enumerate(characters.items())
    }


def travel_heading(capture: Capture, first: int, last: int) -> float | None:
    """Heading in radians in which the body travels from frame ``first`` to ``last``; None if it stays in place.

    It points from the root's first position to its farthest, so that a walk there and back has a heading too.
    """
    if capture.body_map is None:
        return None
    return path_heading(_sampled_positions(capture, first, last, HEADING_SAMPLES)[:, capture.body_map.spine[0], :2])


def swept_points(capture: Capture, first: int, last: int) -> NDArray[np.float64] | None:
    """Horizontal positions (T, P, 2) of all joints from frame ``first`` to ``last``, in leg lengths of the actor.

    They are relative to the root in the first frame. None if the capture has no body map.
    """
    if capture.body_map is None:
        return None
    places = _sampled_positions(capture, first, last, SWEEP_SAMPLES)
    leg = (capture.body_map[part] for part in (BodyPart.LEFT_THIGH, BodyPart.LEFT_SHANK, BodyPart.LEFT_FOOT))
    leg_length = float(np.linalg.norm(np.diff(places[0, list(leg)], axis=0), axis=1).sum())
    joints = list({*capture.body_map.parts.values(), *capture.body_map.spine})
    return np.asarray((places[:, joints, :2] - places[0, capture.body_map.spine[0], :2]) / leg_length)


def _sampled_positions(capture: Capture, first: int, last: int, count: int) -> NDArray[np.float64]:
    """Positions (T, J, 3) of all joints in at most ``count`` frames."""
    rows = np.linspace(first, last, min(count, last - first + 1)).round().astype(np.int64)
    poses = PoseSequence(capture.poses.local_rotations[rows], capture.poses.local_translations[rows])
    return joint_world(capture.skeleton, poses)[0]


def path_heading(path: NDArray[np.float64]) -> float | None:
    """Heading in radians from the begin of ``path`` (T, 2), metres, to its farthest point; None if no point is far."""
    ways = path - path[0]
    x, y = ways[np.argmax(np.linalg.norm(ways, axis=1))].tolist()
    return math.atan2(y, x) if math.hypot(x, y) >= LEAST_TRAVEL_METRES else None


def performers_in_row(
    performers: Mapping[str, Performer], travel: float, sweeps: Mapping[str, NDArray[np.float64]] | None = None
) -> dict[str, Performer]:
    """Performers moved into a row across the heading ``travel``, about their middle, in their present order.

    All face along their motion. ``sweeps`` (T, P, 2), metres, has by performer points of the body at the same times,
    relative to the performer's position: neighbours stand so far apart that they never overlap across the row.
    """
    across = np.array([-math.sin(travel), math.cos(travel)])
    keys, places = list(performers), np.array([each.position for each in performers.values()])
    reaches = {key: points @ across for key, points in (sweeps or {}).items()}
    row: dict[str, float] = {}
    for index in np.argsort(-(places @ across), kind="stable"):
        key = keys[index]
        ends = (offset - _spacing(reaches.get(other), reaches.get(key)) for other, offset in row.items())
        row[key] = min(ends, default=0.0)
    middle = places.mean(axis=0) - np.mean(list(row.values())) * across
    positions = {key: (middle + offset * across).tolist() for key, offset in row.items()}
    return {key: replace(each, position=(*positions[key],), heading=0.0) for key, each in performers.items()}


def _spacing(left: NDArray[np.float64] | None, right: NDArray[np.float64] | None) -> float:
    """Distance in metres from a performer to its right neighbour; ``left`` and ``right`` (T, P) are positions across
    the row of their points.
    """
    if left is None or right is None:
        return PERFORMER_SPACING
    count = min(len(left), len(right))
    overlap = float((right[:count].max(axis=1) - left[:count].min(axis=1)).max(initial=-math.inf))
    return (
        max(PERFORMER_SPACING, ROW_STEP * math.ceil((overlap + JOINT_CLEARANCE) / ROW_STEP))
        if count
        else PERFORMER_SPACING
    )


def is_unarranged(performers: Mapping[str, Performer]) -> bool:
    """True if the performers stand as ``performers_side_by_side`` or ``performers_in_row`` placed them; some may be
    missing.
    """
    direction = row_direction(performers)
    if direction is None:
        return False
    places = np.array([each.position for each in performers.values()])
    steps = (places - places[0]) @ direction / ROW_STEP
    return np.allclose(steps, np.round(steps), atol=1e-6) and len({*np.round(steps).tolist()}) == len(steps)


def row_direction(performers: Mapping[str, Performer]) -> NDArray[np.float64] | None:
    """Unit vector (2,) on the ground from the first performer to the far end of the row; None if they form no row."""
    places = np.array([each.position for each in performers.values()])
    if len(places) < 2 or any(each.heading for each in performers.values()):
        return None
    row = places - places[0]
    end = row[np.argmax(np.linalg.norm(row, axis=1))]
    if not end.any():
        return None
    direction = end / np.linalg.norm(end)
    return direction if np.allclose(row, np.outer(row @ direction, direction), atol=1e-6) else None


def next_row_position(
    performers: Mapping[str, Performer],
    gaps: Mapping[str, float],
    sweeps: Mapping[str, NDArray[np.float64]] | None = None,
    own: NDArray[np.float64] | None = None,
) -> tuple[float, float]:
    """Position in metres of one more performer beyond the end of the row.

    ``gaps`` are the distances in metres to keep from each performer by id. ``sweeps`` and ``own`` (T, P, 2), metres,
    are points of the bodies and of the new body over time. Performers that form no row are treated as a row across
    heading 0.
    """
    if not performers:
        return 0.0, 0.0
    direction = row_direction(performers)
    direction = np.array([0.0, -1.0]) if direction is None else direction
    last = max(performers, key=lambda key: float(performers[key].position @ direction))
    left, right = (None if points is None else points @ -direction for points in ((sweeps or {}).get(last), own))
    spacing = max(_spacing(left, right), ROW_STEP * math.ceil(gaps[last] / ROW_STEP))
    x, y = (performers[last].position + spacing * direction).tolist()
    return x, y


def project_of_capture(
    capture: Capture, contacts: tuple[ContactInterval, ...], characters: Mapping[str, Character], motion_id: str
) -> Project:
    """Project in which every character performs ``capture`` from the begin of its motion to its last frame.

    ``contacts`` are those of ``motion_id``, which is the id of both capture and motion.
    """
    clips = (Clip(motion_id, capture.first_frame, capture.frame_count - 1, id=f"{motion_id} clip"),)
    return Project(
        captures={motion_id: capture},
        motions={motion_id: Motion(capture.name, motion_id)},
        characters=characters,
        performers=performers_side_by_side(characters, clips),
        contacts={f"contact {index}": contact for index, contact in enumerate(contacts)},
    )
