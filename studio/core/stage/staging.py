"""Default stage: one capture, performed by some characters side by side."""

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from studio.core.body.kinematics import joint_world
from studio.core.body.pose import PoseSequence
from studio.core.captures.capture import Capture
from studio.core.captures.contacts import ContactInterval
from studio.core.mesh.character import Character
from studio.core.stage.clip import Clip
from studio.core.stage.project import Motion, Performer, Project

SPACING = 1.15
"""Metres from one performer to the next."""
CLEARANCE = 0.8
"""Metres between the roots of two performers at any time, at least."""
WIDEST_GAP = 12
"""Spacings between two neighbours at most: bodies that meet even so are left to the user."""
LEAST_TRAVEL = 1.0
"""Metres; a motion that goes less far has no direction of travel."""
SPACING_SAMPLES = 64


def side_by_side(characters: Mapping[str, Character], clips: tuple[Clip, ...] = ()) -> dict[str, Performer]:
    """One performer for each character, under the same id, in a row across the direction of the motion."""
    middle = (len(characters) - 1) / 2
    return {
        key: Performer(character.name, key, clips, (0.0, SPACING * (middle - place)))
        for place, (key, character) in enumerate(characters.items())
    }


def travel_heading(capture: Capture, first: int, last: int) -> float | None:
    """Heading in radians in which the body travels from frame ``first`` to ``last``; None if it stays in place.

    It points to the farthest position of the root from its beginning, so that a walk there and back has one as well.
    """
    if capture.body_map is None:
        return None
    rows = np.linspace(first, last, min(SPACING_SAMPLES, last - first + 1)).round().astype(np.int64)
    poses = PoseSequence(capture.poses.local_rotations[rows], capture.poses.local_translations[rows])
    places, _ = joint_world(capture.skeleton, poses)
    return path_heading(places[:, capture.body_map.spine[0], :2])


def path_heading(path: NDArray[np.float64]) -> float | None:
    """Heading in radians from the begin of a ``path`` (T, 2) in metres to its farthest point; None if that is near."""
    ways = path - path[0]
    x, y = ways[np.argmax(np.linalg.norm(ways, axis=1))].tolist()
    return math.atan2(y, x) if math.hypot(x, y) >= LEAST_TRAVEL else None


def lined_up(
    performers: Mapping[str, Performer], travel: float, paths: Mapping[str, NDArray[np.float64]] | None = None
) -> dict[str, Performer]:
    """Performers in a row across heading ``travel`` about their middle, in their present order across it.

    They all face as their motion does. ``paths`` (T, 2), metres, are those of their roots from their positions at the
    same times: between two that would meet, the gap is a larger multiple of the usual one.
    """
    across = np.array([-math.sin(travel), math.cos(travel)])
    keys, places = list(performers), np.array([each.position for each in performers.values()])
    row: dict[str, float] = {}
    for place in np.argsort(-(places @ across), kind="stable"):
        key = keys[place]
        last = next(reversed(row.values()), SPACING)
        gaps = (last - SPACING * count for count in range(1, WIDEST_GAP + 1))
        row[key] = next((gap for gap in gaps if _is_clear(key, gap * across, row, across, paths or {})), last - SPACING)
    middle = places.mean(axis=0) - np.mean(list(row.values())) * across
    positions = {key: (middle + offset * across).tolist() for key, offset in row.items()}
    return {key: replace(each, position=(*positions[key],), heading=0.0) for key, each in performers.items()}


def _is_clear(
    key: str,
    position: NDArray[np.float64],
    row: Mapping[str, float],
    across: NDArray[np.float64],
    paths: Mapping[str, NDArray[np.float64]],
) -> bool:
    """True if a performer that begins at ``position`` (2,) meets none of a ``row``."""
    if key not in paths:
        return True
    for other, offset in row.items():
        if other in paths:
            count = min(len(paths[key]), len(paths[other]))
            apart = position + paths[key][:count] - offset * across - paths[other][:count]
            if count and float(np.linalg.norm(apart, axis=1).min()) < CLEARANCE:
                return False
    return True


def is_unarranged(performers: Mapping[str, Performer]) -> bool:
    """True if the performers are in a row as placed by ``side_by_side`` or ``lined_up``; some may be missing."""
    direction = row_direction(performers)
    if direction is None:
        return False
    places = np.array([each.position for each in performers.values()])
    steps = (places - places[0]) @ direction / SPACING
    return np.allclose(steps, np.round(steps), atol=1e-6) and len({*np.round(steps).tolist()}) == len(steps)


def row_direction(performers: Mapping[str, Performer]) -> NDArray[np.float64] | None:
    """Unit vector (2,) on the ground from the first performer to the far end of their row; None if they form none."""
    places = np.array([each.position for each in performers.values()])
    if len(places) < 2 or any(each.heading for each in performers.values()):
        return None
    row = places - places[0]
    end = row[np.argmax(np.linalg.norm(row, axis=1))]
    if not end.any():
        return None
    direction = end / np.linalg.norm(end)
    return direction if np.allclose(row, np.outer(row @ direction, direction), atol=1e-6) else None


def end_of_row(performers: Mapping[str, Performer], gaps: Mapping[str, float]) -> tuple[float, float]:
    """Position in metres for one more performer, whole spacings beyond the end of their row.

    ``gaps`` are the metres that it must keep from each of them. Performers who form no row are taken as one across
    heading 0.
    """
    if not performers:
        return 0.0, 0.0
    direction = row_direction(performers)
    direction = np.array([0.0, -1.0]) if direction is None else direction
    last = max(performers, key=lambda key: float(performers[key].position @ direction))
    x, y = (performers[last].position + SPACING * math.ceil(gaps[last] / SPACING) * direction).tolist()
    return x, y


def staged(
    capture: Capture, contacts: tuple[ContactInterval, ...], characters: Mapping[str, Character], motion_id: str
) -> Project:
    """Project in which every character performs the capture from the begin of its motion to its last frame.

    ``contacts`` are those of ``motion_id``, the id of both capture and motion.
    """
    clips = (Clip(motion_id, capture.first_frame, capture.frame_count - 1, id=f"{motion_id} clip"),)
    return Project(
        captures={motion_id: capture},
        motions={motion_id: Motion(capture.name, motion_id)},
        characters=characters,
        performers=side_by_side(characters, clips),
        contacts={f"contact {place}": contact for place, contact in enumerate(contacts)},
    )
