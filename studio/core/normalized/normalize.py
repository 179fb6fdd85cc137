"""From a capture to its morphology-independent motion (K05 section 4; METHOD 2)."""

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d

from studio.core.capture import Capture
from studio.core.contacts import (
    BODY_POINTS,
    SHORTEST,
    TRAILING,
    ContactInterval,
    ContactPoint,
    contact_mask,
    detect_body_contacts,
    detect_contacts,
    staying,
    touching_points,
    without,
)
from studio.core.errors import StudioError
from studio.core.kernels import layout as at
from studio.core.morphology import Morphology
from studio.core.normalized.actor import Actor
from studio.core.normalized.alignment import find_alignments, level_feet
from studio.core.normalized.landmarks import Landmarks, find_landmarks
from studio.core.normalized.measure import measure_actor
from studio.core.normalized.motion import NormalizedMotion
from studio.core.normalized.realize import trunk_places
from studio.core.rotations import frame_along, from_matrix, normalized, shortest_arc, sign_continuous

FloatArray = NDArray[np.float64]
Contacts = dict[ContactPoint, list[tuple[int, int]]]

FORWARD = np.array([1.0, 0.0, 0.0])
HEADING_SMOOTHING = 0.25
"""Seconds, standard deviation of the low-pass on the pelvis' heading."""


def normalize(capture: Capture) -> tuple[NormalizedMotion, Actor]:
    """The capture's motion without its actor's measures, and the actor.

    Raises StudioError when the capture has no body map: there is no telling what its joints are.
    """
    if capture.body_map is None:
        raise StudioError(
            f"'{capture.name}' has no body map: choose which joint plays which part of the body, then try again."
        )
    marks = find_landmarks(capture, capture.body_map)
    contacts = _contacts_of(marks, capture)
    alignments = find_alignments(marks)
    rotations = marks.rotations @ alignments
    _level_soles(marks, contacts, alignments, rotations)
    rotations = marks.rotations @ alignments
    origin = np.array([*marks.points[capture.first_frame, 0, :2], capture.floor])
    points = marks.points - origin
    body = measure_actor(marks, alignments, rotations, points, contacts, capture.first_frame)
    channels = _channels(body, points, rotations, capture.frame_rate)
    motion = NormalizedMotion(capture.name, capture.frame_rate, channels, trunk_places(body.spine))
    return motion, Actor(capture.skeleton, body, marks.segment_joints, alignments, origin, capture.poses)


def capture_contacts(capture: Capture) -> Contacts:
    """Contacts of a mapped capture, as found in its own joints; none for one without a body map."""
    if capture.body_map is None:
        return {point: [] for point in ContactPoint}
    return _contacts_of(find_landmarks(capture, capture.body_map), capture)


def detected_contacts(capture: Capture, motion_id: str) -> tuple[ContactInterval, ...]:
    """``capture_contacts`` as those of a motion."""
    found = capture_contacts(capture).items()
    return tuple(ContactInterval(motion_id, point, first, last) for point, spans in found for first, last in spans)


def _contacts_of(marks: Landmarks, capture: Capture) -> Contacts:
    layout, points = marks.layout, marks.points
    ankles, toes = (points[:, [joint(0), joint(1)]] for joint in (layout.ankle, layout.toe))
    hips = [layout.hip(0), layout.hip(1)]
    above = points - [0.0, 0.0, capture.floor]
    tracks = {point: above[:, touching_points(point, layout)].mean(axis=1) for point in BODY_POINTS}
    leg = np.linalg.norm(np.diff(marks.reference[hips[0] : hips[0] + 3], axis=0), axis=1).sum()
    bodies = detect_body_contacts(tracks, float(leg), capture.frame_rate, capture.first_frame)
    feet = detect_contacts(ankles, toes, capture.frame_rate, capture.first_frame)
    shortest = round(SHORTEST * capture.frame_rate)
    for side, name in enumerate(("left", "right")):
        heel, toe, knee = (ContactPoint(f"{name}_{member}") for member in ("heel", "toe", "knee"))
        # A heel does not stand while its knee does, or is lower; toes of who lies or kneels may only trail.
        prone = points[:, hips[side] + 1, 2] < points[:, hips[side] + 2, 2]
        feet[heel] = without(feet[heel], prone | contact_mask(bodies[knee], len(points)), shortest)
        down = contact_mask([*bodies[knee], *bodies[ContactPoint.SEAT]], len(points))
        stays = (staying(toes[:, side], *span, TRAILING) if down[slice(*span)].any() else span for span in feet[toe])
        feet[toe] = [(first, last) for first, last in stays if last - first >= shortest]
    return feet | bodies


def _level_soles(marks: Landmarks, contacts: Contacts, alignments: FloatArray, rotations: FloatArray) -> None:
    for side, name in enumerate(("left", "right")):
        heel = contact_mask(contacts[ContactPoint(f"{name}_heel")], len(rotations))
        toe = contact_mask(contacts[ContactPoint(f"{name}_toe")], len(rotations))
        foot = marks.layout.spine_count + 12 + 4 * side
        for segment in (foot, foot + 1):
            level_feet(alignments, rotations[:, segment], segment, heel & toe)


def _channels(body: Morphology, points: FloatArray, rotations: FloatArray, frame_rate: float) -> FloatArray:
    layout = body.layout
    thorax, neck, head = layout.spine_count - 1, layout.neck_base, layout.head_joint
    channels = np.zeros((len(points), at.SPINE + 4 * (layout.spine_count - 1)))
    pelvis = rotations[:, 0]
    ankle = np.array([0.0, 0.0, body.ankle_height.mean()])
    hips = points[:, 0] + pelvis @ body.hip_offset.mean(axis=0)
    channels[:, at.HIPS : at.HIPS + 3] = (hips - ankle) / body.leg_length
    yaw = heading(pelvis, frame_rate)
    channels[:, at.YAW] = yaw
    put = _QuaternionWriter(channels)
    put(at.PELVIS, _about_z(-yaw) @ pelvis)
    carrier = rotations[:, neck] @ frame_along(body.neck_rest, FORWARD).T
    put(at.NECK, _local(rotations[:, thorax], carrier))
    put(at.HEAD, _local(carrier, rotations[:, head]))
    for segment in range(1, layout.spine_count):
        put(at.SPINE + 4 * (segment - 1), _local(pelvis, rotations[:, segment]))
    for side in range(2):
        arm, leg = layout.spine_count + 2 + 4 * side, layout.spine_count + 10 + 4 * side
        carrier = rotations[:, arm] @ frame_along(body.clavicle_rest[side], FORWARD).T
        put(at.CLAVICLE + 4 * side, _local(rotations[:, thorax], carrier))
        put(at.HAND + 4 * side, _local(rotations[:, arm + 2], rotations[:, arm + 3]))
        put(at.FOOT + 4 * side, _local(pelvis, rotations[:, leg + 2]))
        put(at.TOE + 4 * side, _local(rotations[:, leg + 2], rotations[:, leg + 3]))
        _encode_limb(channels, put, side, carrier, points, rotations, layout.collar(side) + 1, arm + 1)
        _encode_limb(channels, put, 2 + side, pelvis, points, rotations, layout.hip(side), leg)
        hip = _apply_inverse(pelvis, points[:, layout.hip(side)] - points[:, 0])
        play = at.HIP_PLAY + 3 * side
        channels[:, play : play + 3] = (hip - body.hip_offset[side]) / body.leg_length
    stray = _apply_inverse(rotations[:, neck], points[:, head] - points[:, neck]) / body.neck
    channels[:, at.HEAD_PLAY : at.HEAD_PLAY + 3] = stray - [0.0, 0.0, 1.0]
    return channels


def _encode_limb(
    channels: FloatArray,
    put: "_QuaternionWriter",
    limb: int,
    carrier: FloatArray,
    points: FloatArray,
    rotations: FloatArray,
    root: int,
    upper: int,
) -> None:
    """Frame, reach, bend and twists of one limb (METHOD 2, "limb encoding")."""
    to_middle, to_end = points[:, root + 1] - points[:, root], points[:, root + 2] - points[:, root]
    lengths = [np.linalg.norm(bone, axis=1, keepdims=True) for bone in (to_middle, to_end - to_middle)]
    total = float(np.median(lengths[0]) + np.median(lengths[1]))
    u, z, f = to_middle / lengths[0], normalized(to_end), (to_end - to_middle) / lengths[1]
    hinge = rotations[:, upper, :, 0]
    x = np.einsum("fij,fj->fi", shortest_arc(u, z), hinge)
    x = normalized(x - np.sum(x * z, axis=1, keepdims=True) * z)
    frame = np.stack([x, np.cross(z, x), z], axis=2)
    put(at.LIMB_FRAME + 4 * limb, _local(carrier, frame))
    middle = _apply_inverse(frame, to_middle)
    channels[:, at.LIMB_SLACK + limb] = 1.0 - np.linalg.norm(to_end, axis=1) / total
    channels[:, at.LIMB_OFF_PLANE + limb] = middle[:, 0] / total
    channels[:, at.LIMB_BEND + limb] = np.where(middle[:, 1] < 0.0, -1.0, 1.0)
    for bone, direction in enumerate((u, f)):
        untwisted = shortest_arc(z, direction) @ frame
        rest = _local(untwisted, rotations[:, upper + bone])
        twist = np.unwrap(np.arctan2(rest[:, 1, 0] - rest[:, 0, 1], rest[:, 0, 0] + rest[:, 1, 1]))
        channels[:, at.LIMB_TWIST + 2 * limb + bone] = twist


class _QuaternionWriter:
    """Writes rotations (F, 3, 3) as quaternions continuous in time into four columns."""

    def __init__(self, channels: FloatArray) -> None:
        self.channels = channels

    def __call__(self, column: int, matrices: FloatArray) -> None:
        self.channels[:, column : column + 4] = sign_continuous(from_matrix(matrices))


def heading(pelvis: FloatArray, frame_rate: float) -> FloatArray:
    """Low-passed, unwrapped heading (F,) in radians of pelvis rotations (F, 3, 3): their twist about Z."""
    quaternions = sign_continuous(from_matrix(pelvis))
    turn = np.unwrap(2.0 * np.arctan2(quaternions[:, 2], quaternions[:, 3]))
    return np.asarray(gaussian_filter1d(turn, HEADING_SMOOTHING * frame_rate, mode="nearest"))


def _about_z(angles: FloatArray) -> FloatArray:
    turns = np.zeros((len(angles), 3, 3))
    turns[:, 0, 0] = turns[:, 1, 1] = np.cos(angles)
    turns[:, 1, 0] = np.sin(angles)
    turns[:, 0, 1] = -turns[:, 1, 0]
    turns[:, 2, 2] = 1.0
    return turns


def _local(carrier: FloatArray, rotations: FloatArray) -> FloatArray:
    return np.asarray(np.swapaxes(carrier, -1, -2) @ rotations)


def _apply_inverse(rotations: FloatArray, vectors: FloatArray) -> FloatArray:
    return np.asarray(np.einsum("fji,fj->fi", rotations, vectors))
