"""Conversion of a capture to its morphology-independent motion (K05 section 4; METHOD 2)."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from studio.core.body.canonical import BodyLayout
from studio.core.body.kinematics import joint_world
from studio.core.body.morphology import Morphology
from studio.core.captures.capture import Capture
from studio.core.captures.captured_steps import CapturedStance, find_stances, find_steps, foot_levels
from studio.core.captures.contacts import (
    BODY_POINTS,
    LOW_KNEE_HEIGHT,
    LYING_HIP_HEIGHT,
    SHORTEST_CONTACT_SECONDS,
    ContactInterval,
    ContactPoint,
    contact_mask,
    detect_body_contacts,
    detect_contacts,
    joined_over_still_gaps,
    lying_shank_mask,
    parted_at_slides,
    plank_leg_mask,
    prone_mask,
    spans_outside_mask,
    touching_points,
    trailing_toe_contacts,
    with_step_gaps_closed,
)
from studio.core.captures.floor_slope import FloorSlope, find_floor_slope
from studio.core.captures.plate_steps import contacts_fitted_to_plates
from studio.core.captures.rising_heels import rising_heels
from studio.core.errors import StudioError
from studio.core.grounds.steps import Steps
from studio.core.kernels import channel_columns as channel
from studio.core.kernels.body.encode_channels import encode_frames, unwrap_channels
from studio.core.normalized.actor import SourceRig
from studio.core.normalized.alignment import align_soles, find_alignments
from studio.core.normalized.encode import actor_sizes
from studio.core.normalized.landmarks import Landmarks, find_landmarks, measured_frames
from studio.core.normalized.measure import measure_actor
from studio.core.normalized.motion import HEADING_SMOOTHING_SECONDS, NormalizedMotion
from studio.core.normalized.realize import girdle_of, spine_fractions
from studio.core.normalized.soles import sole_points
from studio.core.rotations import from_matrix, sign_continuous
from studio.core.sharing import Shared
from studio.core.threads import do_over_frames
from studio.core.windows import bell_average

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]
Contacts = dict[ContactPoint, list[tuple[int, int]]]

HEELS = (ContactPoint.LEFT_HEEL, ContactPoint.RIGHT_HEEL)
FOOT_LANDMARKS = (HEELS[0], ContactPoint.LEFT_TOE), (HEELS[1], ContactPoint.RIGHT_TOE)
LEAST_STANDING_HIP = 0.5
"""Least height of the hip above the ankle, as a fraction of the leg length, while a foot stands on its heel."""
FLOOR_QUANTILE = 0.05
"""Quantile of the heights of standing heels that is the lowest floor; lower heights are noise."""


def normalize_capture(
    capture: Capture, progress: Callable[[float], object] = lambda share: None
) -> tuple[NormalizedMotion, SourceRig]:
    """Motion of the capture without its actor's measures, and the actor.

    ``progress`` is called with a fraction from 0 to 1 and may raise an exception to cancel. Raises StudioError if the
    capture has no body map, so that its joints are unknown.
    """
    return _NORMALIZED(capture, progress)


def _normalize(capture: Capture, progress: Callable[[float], object]) -> tuple[NormalizedMotion, SourceRig]:
    if capture.body_map is None:
        raise StudioError(
            f"'{capture.name}' has no body map: choose which joint plays which part of the body, then try again."
        )
    marks = find_landmarks(capture, capture.body_map)
    progress(0.4)
    found = _FOUND(capture, marks)
    contacts = found.contacts
    progress(0.6)
    alignments = find_alignments(marks)
    align_soles(marks, alignments, _standing_feet(contacts, len(marks.points)), capture.frame_rate)
    rotations = marks.align_rotations(alignments)
    progress(0.8)
    origin = np.array([*marks.points[capture.first_frame, 0, :2], capture.floor])
    soles = capture.floor + found.slope.rise(
        marks.points[:, [marks.layout.ankle_point(0), marks.layout.ankle_point(1)]]
    )
    body = measure_actor(marks, alignments, rotations, contacts, capture.first_frame, soles)
    channels = _channels(body, marks.points, rotations, capture.frame_rate)
    channels[:, channel.HIPS : channel.HIPS + 3] -= origin / body.leg_length
    channels.setflags(write=False)
    motion = NormalizedMotion(capture.name, capture.frame_rate, channels, spine_fractions(body.spine), girdle_of(body))
    return motion, SourceRig(capture.skeleton, body, marks.segment_joints, alignments, origin, capture.poses)


_NORMALIZED: Shared[Capture, tuple[NormalizedMotion, SourceRig]] = Shared(_normalize)


def motion_origin(capture: Capture) -> NDArray[np.float64]:
    """Origin (3,) of the motion's space in the capture's: the ground under the pelvis at the first frame.

    Raises StudioError if the capture has no body map.
    """
    if capture.body_map is None:
        raise StudioError(f"'{capture.name}' has no body map, so the start position of its motion is unknown.")
    begin = capture.poses.frames(capture.first_frame, capture.first_frame)
    pelvis = joint_world(capture.skeleton, begin)[0][0, capture.body_map.spine[0]]
    return np.array([*pelvis[:2], capture.floor])


def capture_contacts(capture: Capture) -> Contacts:
    """Contacts of the points of a mapped capture with the ground, from its own joints; none without a body map."""
    if capture.body_map is None:
        return {point: [] for point in ContactPoint}
    return _FOUND(capture).contacts


def sole_heights(capture: Capture) -> list[list[float]]:
    """Heights in metres of the ankle of each foot, one for each contact of its heel, of a mapped capture."""
    return _FOUND(capture).sole_heights


def captured_steps(capture: Capture) -> Steps | None:
    """Steps on which a capture was recorded, in the motion's space; None if there were none, or without a body map."""
    steps = None if capture.body_map is None else find_steps(_FOUND(capture).stances)
    return steps and replace(steps, height=round(steps.height / steps.rise) * steps.rise)


def detected_contacts(capture: Capture, motion_id: str, *, on_steps: bool = False) -> tuple[ContactInterval, ...]:
    """Contacts of a capture with the ground, and touches of its hands (``touching``), for the motion ``motion_id``.

    With ``on_steps`` feet stand on the treads of ``captured_steps``, else only on the floor.
    """
    from studio.core.normalized.touching import find_touches  # it needs a body, which is measured here

    if capture.body_map is None:
        return ()
    motion, actor = normalize_capture(capture)
    standing = capture_contacts(capture)
    if on_steps:
        standing = _contacts_of(find_landmarks(capture, capture.body_map), capture, on_steps=True)[0]
    hands = (standing[ContactPoint.LEFT_HAND], standing[ContactPoint.RIGHT_HAND])
    free = np.array([~contact_mask(spans, motion.frame_count) for spans in hands])
    touches = find_touches(motion, actor.morphology, free, capture.first_frame)
    return (
        *(ContactInterval(motion_id, point, *span) for point, spans in standing.items() for span in spans),
        *(ContactInterval(motion_id, touch, *span) for touch, span in touches),
    )


@dataclass(frozen=True, eq=False)
class _FoundContacts:
    """Analysis of the ground of a capture, in the motion's space.

    It has the contacts, the slope of the floor, the ankle height in metres in each contact of each heel, and the
    stances of the feet at any height.
    """

    contacts: Contacts
    slope: FloorSlope
    sole_heights: list[list[float]]
    stances: list[CapturedStance]


def _find(capture: Capture, marks: Landmarks | None = None) -> _FoundContacts:
    """Contacts, floor slope and sole heights of a mapped capture; ``marks`` are its landmarks, computed if None."""
    assert capture.body_map is not None
    marks = marks or find_landmarks(capture, capture.body_map)
    contacts, slope = _contacts_of(marks, capture)
    ankles = [marks.points[:, marks.layout.ankle_point(side), 2] for side in range(2)]
    heights = [
        [float(np.median(track[first : last + 1])) for first, last in contacts[heel]]
        for track, heel in zip(ankles, HEELS, strict=True)
    ]
    _, soles, upright = _legs(marks, capture)
    stances = find_stances(soles - motion_origin(capture), upright, capture.frame_rate)
    return _FoundContacts(contacts, slope, heights, stances)


def _terms(capture: Capture) -> object:
    """Properties of a capture, except its poses, on which its contacts depend."""
    offsets, reference = capture.skeleton.offsets.tobytes(), capture.reference_rotations.tobytes()
    begin = capture.frame_rate, capture.floor, capture.first_frame
    return offsets, reference, capture.body_map, *begin, capture.plate_loads


_FOUND: Shared[Capture, _FoundContacts] = Shared(_find, owner=lambda capture: capture.poses, terms=_terms)
"""Cached ground analysis, shared by captures that differ only in their guesses."""


def _risen(points: FloatArray, layout: BodyLayout, heels: Sequence[NDArray[np.bool_]], leg_length: float) -> FloatArray:
    """Heights (F,) in metres of the floor above its lowest, from the ``heels`` (F,) of standing legs.

    ``points`` (F, P, 3) are landmarks. Captured floors are tilted, and drift by centimetres, also under the hands.
    Knees and seats follow the drift less, because they come down long after a leg has stood.
    """
    frames, shown = np.arange(len(points)), []
    for side, stands in enumerate(heels):
        hips, ankles = (points[:, layout.hip_point(side) + step, 2] for step in (0, 2))
        known = np.flatnonzero(stands & (hips - ankles > LEAST_STANDING_HIP * leg_length))
        if len(known):
            heights = ankles[known]
            shown.append(np.interp(frames, known, np.maximum(heights - np.quantile(heights, FLOOR_QUANTILE), 0.0)))
    return np.mean(shown, axis=0) if shown else np.zeros(len(frames))


def _off_their_steps(
    points: FloatArray, soles: FloatArray, upright: BoolArray, capture: Capture, layout: BodyLayout
) -> tuple[FloatArray, FloatArray]:
    """Landmarks (F, P, 3) and soles lowered by the treads on which the feet stand; other points by the mean of both
    feet.
    """
    placed = soles - motion_origin(capture)
    stances = find_stances(placed, upright, capture.frame_rate)
    steps = find_steps(stances)
    if steps is None:
        return points, soles
    levels = foot_levels(stances, steps, placed)
    lowered = points - [[0.0, 0.0, 1.0]] * levels.mean(axis=1)[:, None, None]
    for side in range(2):
        leg = slice(layout.hip_point(side), layout.hip_point(side) + 5)
        lowered[:, leg, 2] = points[:, leg, 2] - levels[:, [side]]
    return lowered, soles - levels[:, :, None, None] * [0.0, 0.0, 1.0]


def _legs(marks: Landmarks, capture: Capture) -> tuple[float, FloatArray, BoolArray]:
    """Length of the legs in metres, ``sole_points`` (F, 2, 3, 3), and mask (F, 2) of the frames in which a leg is
    upright.

    No leg counts as upright before the first frame of the motion proper.
    """
    hips = [marks.layout.hip_point(0), marks.layout.hip_point(1)]
    leg = float(np.linalg.norm(np.diff(marks.reference[hips[0] : hips[0] + 3], axis=0), axis=1).sum())
    ankles = marks.points[:, [marks.layout.ankle_point(0), marks.layout.ankle_point(1)], 2]
    upright = marks.points[:, hips, 2] - ankles > LEAST_STANDING_HIP * leg
    upright[: capture.first_frame] = False
    return leg, sole_points(marks, leg, capture.first_frame), upright


def _contacts_of(marks: Landmarks, capture: Capture, *, on_steps: bool = False) -> tuple[Contacts, FloorSlope]:
    layout, rate = marks.layout, capture.frame_rate
    own = slice(capture.first_frame, None)
    hips = [layout.hip_point(0), layout.hip_point(1)]
    leg, soles, upright = _legs(marks, capture)
    on_floor = marks.points
    if on_steps:
        on_floor, soles = _off_their_steps(on_floor, soles, upright, capture, layout)
    slope = find_floor_slope(soles[own], upright[own], rate)
    points, soles = slope.levelled(on_floor), slope.levelled(soles)
    toes = points[:, [layout.toe_point(0), layout.toe_point(1)]]
    shortest = round(SHORTEST_CONTACT_SECONDS * capture.frame_rate)
    feet = detect_contacts(soles, rate, capture.first_frame)
    for side, (heel, toe) in enumerate(
        FOOT_LANDMARKS
    ):  # none stands in a plank, over its knee, or flat under a shank that lies
        hip_track, knee_track, ankle, _ = np.moveaxis(points[:, hips[side] : hips[side] + 4], 1, 0)
        raised = (knee_track[:, 2] < ankle[:, 2]) | plank_leg_mask(hip_track, ankle, toes[:, side])
        flat = contact_mask(feet[toe], len(points)) & lying_shank_mask(knee_track, ankle)
        feet[heel] = [
            (a, b) for a, b in spans_outside_mask(feet[heel], raised, shortest) if flat[a : b + 1].mean() < 0.5
        ]
    risen = _risen(on_floor, layout, [contact_mask(feet[heel], len(points)) for heel in HEELS], leg)
    tracks = {point: points[:, touching_points(point, layout)].mean(axis=1) for point in BODY_POINTS}
    for point, track in tracks.items():
        track[:, 2] -= capture.floor + (risen if point.member == "hand" else 0.0)
    bodies = detect_body_contacts(tracks, leg, capture.frame_rate, capture.first_frame)
    prone = prone_mask(points[:, hips], points[:, [layout.collar_point(0) + 1, layout.collar_point(1) + 1]])
    for side, name in enumerate(("left", "right")):
        heel, toe, knee = (ContactPoint(f"{name}_{member}") for member in ("heel", "toe", "knee"))
        # A heel does not stand while its knee does; who lies or kneels may trail its toes.
        feet[heel] = spans_outside_mask(feet[heel], contact_mask(bodies[knee], len(points)), shortest)
        stands, ankle = contact_mask(feet[toe], len(points)), points[:, layout.ankle_point(side)]
        rising = rising_heels(feet[heel], stands, ankle, toes[:, side], leg, rate)
        feet[heel] = spans_outside_mask(feet[heel], rising, shortest)
        low = tracks[knee][:, 2] < LOW_KNEE_HEIGHT * leg
        down = low | contact_mask(bodies[ContactPoint.SEAT], len(points))
        middle = soles[:, side, :2].mean(axis=1)
        feet[toe] = joined_over_still_gaps(trailing_toe_contacts(feet[toe], toes[:, side], down, rate), middle)
        for point, place in ((heel, 0), (toe, 1)):
            feet[point] = parted_at_slides(feet[point], soles[:, side, place], middle, down | prone, rate)
        feet[heel], feet[toe] = with_step_gaps_closed(feet[heel], feet[toe], middle, shortest)
    # Low hips say what knees and toes do; but of who crawls they are carried, until it lies flat.
    flat = tracks[ContactPoint.SEAT][:, 2] < LYING_HIP_HEIGHT * leg
    bodies[ContactPoint.SEAT] = spans_outside_mask(bodies[ContactPoint.SEAT], prone & ~flat, shortest)
    return contacts_fitted_to_plates(feet, soles, capture.plate_loads, rate) | bodies, slope


def _standing_feet(contacts: Contacts, frame_count: int) -> BoolArray:
    """Mask (F, 2) of frames in which heel and toe of the left and the right foot both rest."""
    points = [[ContactPoint(f"{side}_{end}") for end in ("heel", "toe")] for side in ("left", "right")]
    return np.stack([np.all([contact_mask(contacts[p], frame_count) for p in foot], axis=0) for foot in points], axis=1)


def _channels(body: Morphology, points: FloatArray, rotations: FloatArray, frame_rate: float) -> FloatArray:
    layout = body.layout
    roots = [layout.collar_point(0) + 1, layout.collar_point(1) + 1, layout.hip_point(0), layout.hip_point(1)]
    seen = points[measured_frames(len(points))]
    totals = [sum(_median_length(seen[:, root + k], seen[:, root + k + 1]) for k in (0, 1)) for root in roots]
    actor = actor_sizes(body, np.array(totals))
    yaw = smoothed_heading(rotations[:, 0], frame_rate)
    channels = np.zeros((len(points), channel.SPINE + 4 * (layout.spine_count - 1)))
    do_over_frames(lambda run: encode_frames(points[run], rotations[run], yaw[run], actor, channels[run]), len(points))
    unwrap_channels(np.array([*channel.QUATERNION_COLUMNS, *range(channel.SPINE, channels.shape[1], 4)]), channels)
    return channels


def _median_length(starts: FloatArray, ends: FloatArray) -> float:
    return float(np.median(np.linalg.norm(ends - starts, axis=1)))


def smoothed_heading(pelvis: FloatArray, frame_rate: float) -> FloatArray:
    """Low-pass filtered, unwrapped headings (F,) in radians of pelvis rotations (F, 3, 3): their twist about Z."""
    quaternions = sign_continuous(from_matrix(pelvis))
    turn = np.unwrap(2.0 * np.arctan2(quaternions[:, 2], quaternions[:, 3]))
    return bell_average(turn, HEADING_SMOOTHING_SECONDS * frame_rate)
