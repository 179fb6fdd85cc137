"""Virtual markers: a motion written as a marker trial that other programs can solve."""

from collections.abc import Callable, Iterable

import numpy as np
from numpy.typing import NDArray

from studio.core.body.canonical import BodyPart
from studio.core.body.humanoid import BodyMap
from studio.core.body.kinematics import joint_world, rest_poses
from studio.core.captures.capture import Capture
from studio.core.captures.contacts import ContactInterval, ContactPoint
from studio.core.markers.roles import JOINTS, SIDE_WORDS
from studio.core.markers.trial import MARKER_KIND, VIRTUAL_KIND, Trial, TrialEvent

FloatArray = NDArray[np.float64]

_UNIT = 1000.0
"""Millimetres in a metre; marker laboratories use millimetres."""
_PART = {
    "hip": "THIGH", "knee": "SHANK", "ankle": "FOOT", "shoulder": "UPPER_ARM", "elbow": "FOREARM", "wrist": "HAND",
}  # fmt: skip
_WORN: tuple[tuple[str, str, str, tuple[float, float, float]], ...] = (
    ("front_hip", "PELVIS", "PELVIS", (0.06, 0.07, 0.05)),
    ("back_hip", "PELVIS", "PELVIS", (-0.055, 0.03, 0.05)),
    ("thigh", "THIGH", "THIGH", (0.0, 0.055, -0.1)),
    ("knee", "SHANK", "SHANK", (0.0, 0.032, 0.0)),
    ("inner_knee", "SHANK", "SHANK", (0.0, -0.032, 0.0)),
    ("shank", "SHANK", "SHANK", (0.0, 0.045, -0.1)),
    ("ankle", "FOOT", "SHANK", (0.0, 0.023, 0.0)),
    ("inner_ankle", "FOOT", "SHANK", (0.0, -0.023, 0.0)),
    ("heel", "FOOT", "FOOT", (-0.03, 0.0, -0.03)),
    ("elbow", "FOREARM", "UPPER_ARM", (0.0, 0.0, 0.025)),
    ("inner_elbow", "FOREARM", "UPPER_ARM", (0.0, 0.0, -0.025)),
    ("wrist", "HAND", "FOREARM", (0.016, 0.0, 0.0)),
    ("outer_wrist", "HAND", "FOREARM", (-0.016, 0.0, 0.0)),
    ("front_head", "HEAD", "HEAD", (0.055, 0.035, 0.06)),
    ("back_head", "HEAD", "HEAD", (-0.045, 0.035, 0.06)),
)
"""Markers as (role, part at whose near joint it lies, part with which it moves, position): fractions of stature
forward, outward and up in the reference pose.
"""
_TRUNK: tuple[tuple[str, tuple[float, float, float]], ...] = (
    ("neck_back", (-0.03, 0.0, 0.02)),
    ("collar", (0.04, 0.0, -0.01)),
    ("breastbone", (0.06, 0.0, -0.11)),
    ("back", (-0.06, 0.0, -0.11)),
)


def marker_label(role: str) -> str:
    """Label of a marker: ``LeftInnerKneeMarker`` for ``left_inner_knee``; no joint of a skeleton has such a name."""
    return f"{_joined(role)}Marker"


def centre_label(joint: str) -> str:
    """Label of a joint centre: ``LeftKneeCentre`` for ``left_knee``."""
    return f"{_joined(joint)}Centre"


def virtual_trial(
    capture: Capture,
    contacts: Iterable[ContactInterval] = (),
    progress: Callable[[float], object] = lambda share: None,
) -> Trial:
    """Marker trial with the joints of a motion as named points and the markers of a human body.

    It is in millimetres, Z up; foot contacts become events. Frames before ``first_frame`` are left out. ``progress`` is
    called with a fraction from 0 to 1 and may raise an exception to cancel.
    """
    poses = capture.poses.frames(capture.first_frame, capture.frame_count - 1)
    kinds: dict[str, str] = {}
    points = np.empty((poses.frame_count, 0, 3))
    for run, some in poses.runs():
        progress(run.start / poses.frame_count)
        tracks, kinds = _points(capture, *joint_world(capture.skeleton, some))
        if not run.start:
            points = np.empty((poses.frame_count, len(tracks), 3))
        points[run] = _UNIT * np.stack(list(tracks.values()), axis=1)
    return Trial(
        name=capture.name,
        source=capture.source,
        labels=tuple(kinds),
        kinds=tuple(kinds.values()),
        points=points,
        residuals=np.zeros(points.shape[:2]),
        frame_rate=capture.frame_rate,
        first_frame=1,
        unit="mm",
        events=_events(capture, contacts),
    )


def _points(
    capture: Capture, positions: FloatArray, rotations: FloatArray
) -> tuple[dict[str, FloatArray], dict[str, str]]:
    """Positions (N, 3) of joints and markers by label, and the kind of each point by label."""
    points = {name: positions[:, joint] for joint, name in enumerate(capture.skeleton.names)}
    kinds = dict.fromkeys(points, VIRTUAL_KIND)
    if capture.body_map:
        worn = _worn(capture, capture.body_map, positions, rotations)
        points |= {label: track for label, track in worn.items() if label not in points}
        kinds |= {
            label: VIRTUAL_KIND if label.endswith("Centre") else MARKER_KIND for label in worn if label not in kinds
        }
    return points, kinds


def _worn(capture: Capture, body_map: BodyMap, positions: FloatArray, rotations: FloatArray) -> dict[str, FloatArray]:
    """Markers and joint centres by label."""
    still = rest_poses(capture.skeleton, capture.reference_rotations)
    places, reference = joint_world(capture.skeleton, still)
    turns = rotations @ np.swapaxes(reference, -1, -2)  # from the reference pose, in the world
    facing = _facing(places[0], body_map)
    stature = _stature(places[0], body_map)
    found: dict[str, FloatArray] = {}

    def wear(role: str, joint: int, turning: int, at: tuple[float, float, float], out: float) -> None:
        offset = facing @ (stature * np.array([at[0], out * at[1], at[2]]))
        found[marker_label(role)] = positions[:, joint] + turns[:, turning] @ offset

    for side, out in zip(SIDE_WORDS, (1.0, -1.0), strict=True):
        for role, near, turning, at in _WORN:
            joints = [body_map.get(_part(name, side)) for name in (near, turning)]
            if joints[0] is not None and joints[1] is not None:
                wear(f"{side}_{role}", joints[0], joints[1], at, out)
        toe = body_map.get(_part("TOE", side))
        if toe is not None:
            found[marker_label(f"{side}_toe")] = positions[:, toe]
    neck = body_map.get(BodyPart.NECK)
    chest = body_map.spine[-1]
    for role, at in _TRUNK if neck is not None else ():
        wear(role, neck if neck is not None else chest, chest, at, 1.0)
    for joint in JOINTS:
        side, name = joint.split("_")
        found[centre_label(joint)] = positions[:, body_map[_part(_PART[name], side)]]
    return found


def _joined(words: str) -> str:
    return "".join(word.capitalize() for word in words.split("_"))


def _part(name: str, side: str) -> BodyPart:
    return BodyPart[name] if name in ("PELVIS", "HEAD") else BodyPart[f"{side.upper()}_{name}"]


def _facing(positions: FloatArray, body_map: BodyMap) -> FloatArray:
    """Axes (3, 3) of the body in its reference pose: x forward, y left, z up."""
    left = positions[body_map[BodyPart.LEFT_THIGH]] - positions[body_map[BodyPart.RIGHT_THIGH]]
    angle = np.arctan2(-left[0], left[1])
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def _stature(positions: FloatArray, body_map: BodyMap) -> float:
    """Stature, taken as twice the length of the legs."""
    hip, knee, ankle = (positions[body_map[BodyPart[f"LEFT_{part}"]]] for part in ("THIGH", "SHANK", "FOOT"))
    return float(np.linalg.norm(knee - hip) + np.linalg.norm(ankle - knee)) / 0.491


def _events(capture: Capture, contacts: Iterable[ContactInterval]) -> tuple[TrialEvent, ...]:
    """Foot events: a strike when the heel lands, an off when the toes leave the ground."""
    events = []
    for contact in contacts:
        if not isinstance(contact.point, ContactPoint) or not contact.point.is_foot:
            continue
        side = contact.point.value.split("_")[0]
        frame, label = (contact.first, "Foot Strike") if contact.point.is_heel else (contact.last, "Foot Off")
        if capture.first_frame < frame < capture.frame_count - 1:
            events.append(TrialEvent(label, side.capitalize(), (frame - capture.first_frame) / capture.frame_rate))
    return tuple(sorted(events, key=lambda event: event.time))
