"""Conversion of a marker take to a capture; body, axes and floor are guessed as for other files, and listed."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from studio.core.body.canonical import BodyPart
from studio.core.body.kinematics import joint_positions
from studio.core.body.pose import PoseSequence
from studio.core.body.skeleton import Skeleton
from studio.core.captures.capture import Capture, Guess
from studio.core.captures.confidence import Confidence
from studio.core.errors import StudioError
from studio.core.markers.body_axes import HEAD_MARKERS
from studio.core.markers.ends import EXCHANGEABLE, exchanged_ends, exchanged_on_limbs
from studio.core.markers.force_plates import plate_loads, plates_height
from studio.core.markers.label_words import side_and_part
from studio.core.markers.marker_map import MarkerMap, seen_labels
from studio.core.markers.measures import has_pelvis, pelvis_frame
from studio.core.markers.proposing import PROPOSED_MAP_NAME
from studio.core.markers.roles import ROLES_BY_ID, SIDE_WORDS
from studio.core.markers.sides import exchanged_places
from studio.core.markers.solve import SolvedBody, solve_body
from studio.core.markers.take import MarkerTake, TrackedBody, track_body
from studio.core.markers.trial import (
    MARKER_KIND,
    TRIAL_UNIT_METRES,
    VIRTUAL_KIND,
    Trial,
    label_without_subject,
    seen_mask,
    subject_of,
)
from studio.core.names import counted_noun
from studio.core.rotations import IDENTITY_QUATERNION
from studio.io.capture_guesses import reference_by_option
from studio.io.guessing import guess_floor
from studio.io.importing import ImportOptions
from studio.io.registry import Progress
from studio.io.up_axis import C3D_UP_PRIOR, FILE_AXES, BodyPoints, guess_up_axis, parse_axis, turn_to_world

FloatArray = NDArray[np.float64]

_PLACES = {"arms": ("shoulder", "elbow", "wrist"), "legs": ("front_hip", "knee", "ankle")}
_LOOKED_AT = 128
"""Frames, spread over the trial, that decide about the up axis."""
_SHOWN = 6
"""Markers that a sentence names."""
_SKIN = 0.025
"""Metres by which a joint is off most of the time where it is no more the skin that moves (at most 0.017 in trials)."""
_CALIBRATED = 0.035
"""Metres of the floor from zero by feet that are told from markers on them within which it is at zero."""
_TRUNK_OF_LEG = 0.6
"""Length of a trunk, from hips to shoulders, in that of a leg."""
_LEG = (0.2, 2.1)
"""Metres of a leg, or twice an arm, from hip to ankle within which a unit is believed."""


def capture_of_take(
    take: MarkerTake,
    options: ImportOptions,
    repairs: Sequence[str] = (),
    progress: Progress = lambda share, text: None,
) -> Capture:
    """Capture of the body solved from the take, or of its markers alone if they make no body. Raises StudioError."""
    progress(0.0, f"Cleaning the markers of {take.trial.name}")
    take, guesses = _in_unit(take, options)
    there = _there(take)
    followed = None
    lacking = f"{', '.join(there.missing_positions()[:6])} and others are missing"
    if there.has_legs() or there.has_arms():
        followed, lacking = _believable(take, options)
    progress(0.5, f"Finding the body of {take.trial.name}")
    capture = _cloud(take, lacking, options, guesses) if followed is None else _body(take, followed, options, guesses)
    if options.body_map and capture.body_map:
        capture = capture.with_body_map(options.body_map)
    return replace(capture, repairs=(*repairs, *capture.repairs), markers=take)


def _there(take: MarkerTake) -> MarkerMap:
    """Marker map restricted to markers of this trial."""
    return take.marker_map.restricted_to(seen_labels(take.trial, take.subject, (MARKER_KIND, VIRTUAL_KIND)).values())


def _in_unit(take: MarkerTake, options: ImportOptions) -> tuple[MarkerTake, list[Guess]]:
    if options.unit is None:
        return take, []
    if options.unit not in TRIAL_UNIT_METRES:
        raise StudioError(f"'{options.unit}' is not a unit of a marker file. Choose {', '.join(TRIAL_UNIT_METRES)}.")
    return replace(take, trial=replace(take.trial, unit=options.unit)), []


def _body(take: MarkerTake, followed: TrackedBody, options: ImportOptions, guesses: list[Guess]) -> Capture:
    trial, first = take.trial, followed.first_frame
    up_axis = _up_axis(followed, options, guesses)
    turn = turn_to_world(up_axis).T
    joints = {joint: track[first:] @ turn for joint, track in followed.joints.items()}
    tracks = {role: track[first:] @ turn for role, track in followed.tracks.items()}
    seen = {name: own[first:] for name, own in followed.seen.items()}
    solved = solve_body(tracks, joints, followed.measures.radius, _stature(take), seen)
    positions = joint_positions(solved.skeleton, solved.poses)
    off = {
        joint: np.linalg.norm(positions[:, solved.joints[joint]] - track, axis=1)[seen[joint]]
        for joint, track in joints.items()
    }
    guesses += _body_guesses(take, followed, solved, off)
    for toe in (solved.body_map[BodyPart.LEFT_TOE], solved.body_map[BodyPart.RIGHT_TOE]):
        positions[:, solved.skeleton.descendants(toe)] = positions[:, [toe]]  # toes bend where nothing is measured
    floor, floor_guess = _floor(solved, positions, options, trial.frame_rate)
    if options.floor is None and (plate := plates_height(trial, turn, floor)) is not None:
        words, trust = "The top of the force plates, as the file says.", Confidence.SURE
        if trial.metres_of_plates != trial.metres:
            words += " Their corners are in another unit than the points: their sides would be no plate's in it."
            trust = Confidence.LIKELY
        floor, floor_guess = plate, [Guess("floor", f"{plate:.4f} m", words, trust)]
    guesses += floor_guess
    rate = options.frame_rate or trial.frame_rate
    return Capture(
        name=trial.name,
        source=trial.source,
        skeleton=solved.skeleton,
        poses=_from_the_start(solved.poses, first),
        frame_rate=rate,
        body_map=solved.body_map,
        reference_rotations=_reference(solved, options),
        floor=floor,
        unit=trial.unit,
        up_axis=up_axis,
        first_frame=first,
        guesses=tuple(guesses),
        repairs=(),
        plate_loads=plate_loads(trial, turn),
    )


def _from_the_start(poses: PoseSequence, first: int) -> PoseSequence:
    """Poses preceded by ``first`` still frames, in which the body is not seen."""
    before = ((first, 0), (0, 0), (0, 0))
    return PoseSequence(
        np.pad(poses.local_rotations, before, mode="edge"), np.pad(poses.local_translations, before, mode="edge")
    )


def _believable(take: MarkerTake, options: ImportOptions) -> tuple[TrackedBody | None, str]:
    """Tracked body; None, and the reason, if it is not of human size, so that the map must be wrong."""
    followed = track_body(take)
    if not followed.joints:
        return None, f"the marker map '{take.marker_map.name}' leaves a joint of every limb without markers"
    length = _limb_length(followed.joints)
    if length > 0.0 and (options.unit is not None or _LEG[0] < length < _LEG[1]):
        return followed, ""
    return None, f"with the marker map '{take.marker_map.name}' the body would be {length / 0.491:.3g} m tall"


def _limb_length(joints: Mapping[str, FloatArray]) -> float:
    """Length of a leg in metres; estimated from the arms if only these are shown."""
    legs = "left_hip" in joints
    names = ("hip", "knee", "ankle") if legs else ("shoulder", "elbow", "wrist")
    near, middle, far = (joints[f"left_{name}"] for name in names)
    bones = np.linalg.norm(middle - near, axis=1) + np.linalg.norm(far - middle, axis=1)
    return float(np.median(bones)) * (1.0 if legs else 1.5)


def _up_axis(followed: TrackedBody, options: ImportOptions, guesses: list[Guess]) -> str:
    if options.up_axis is not None:
        return parse_axis(options.up_axis)
    joints, first = _with_a_trunk(followed), followed.first_frame
    if "left_hip" in joints and "left_shoulder" in joints:
        guess = guess_up_axis(_points(joints, first), C3D_UP_PRIOR)
    else:
        low, high = ("ankle", "hip") if "left_hip" in joints else ("wrist", "shoulder")
        way = np.mean([joints[f"{side}_{high}"] - joints[f"{side}_{low}"] for side in SIDE_WORDS], axis=0)[first:].mean(
            axis=0
        )
        heights = {
            axis: way @ turn[2] / np.linalg.norm(way) + C3D_UP_PRIOR.get(axis, 0.0) for axis, turn in FILE_AXES.items()
        }
        second, best = sorted(heights, key=lambda axis: float(heights[axis]))[-2:]
        confidence = Confidence.of(float(heights[best] - heights[second]), 0.3, 0.6)
        guess = Guess("up axis", best, f"Through the trial the {high}s are above the {low}s along {best}.", confidence)
    guesses.append(guess)
    return guess.value


def _with_a_trunk(followed: TrackedBody) -> Mapping[str, FloatArray]:
    """Joint centres by name; shoulders without markers are placed above their hips, upright as the pelvis."""
    joints = followed.joints
    if "left_hip" not in joints or "left_shoulder" in joints or not has_pelvis(followed.tracks):
        return joints
    trunk = _TRUNK_OF_LEG * _limb_length(joints) * pelvis_frame(followed.tracks)[1][..., 2]
    return {**joints, **{f"{side}_shoulder": joints[f"{side}_hip"] + trunk for side in SIDE_WORDS}}


def _points(joints: Mapping[str, FloatArray], first: int) -> BodyPoints:
    """Joint centres in frames spread over the trial and in the frames after them."""
    frames = len(next(iter(joints.values())))
    looked_at = np.unique(np.linspace(first, frames - 1, _LOOKED_AT).astype(int))
    both = np.stack([looked_at, np.minimum(looked_at + 1, frames - 1)])

    def pair(joint: str) -> FloatArray:
        return np.stack([joints[f"{side}_{joint}"][both] for side in SIDE_WORDS], axis=2)

    everything = np.stack([track[both] for track in joints.values()], axis=2)
    return BodyPoints(pair("shoulder"), pair("hip"), pair("knee"), pair("ankle"), None, everything)


def _stature(take: MarkerTake) -> float | None:
    """Stature stored in the file, if it is human."""
    stored = take.trial.measures.get("HEIGHT", 0.0)
    heights = (stored * take.trial.metres, stored)
    return next((height for height in heights if 0.6 < height < 2.5), None)


def _floor(
    solved: SolvedBody, positions: FloatArray, options: ImportOptions, frame_rate: float
) -> tuple[float, list[Guess]]:
    """Height of the ground under standing feet, with guesses; zero, the level of a laboratory's calibration, if that is
    near.
    """
    if options.floor is not None:
        return options.floor, []
    guess = guess_floor(solved.skeleton, positions, solved.body_map, frame_rate)
    if "legs" in solved.resting:
        guess = replace(guess, reason="Where the legs, which are not shown, would stand.")
    height = float(guess.value.split()[0])
    if 0.0 < abs(height) <= _CALIBRATED:
        reason = f"{guess.reason} That fits a floor at zero: markers lie on feet, and laboratories are calibrated."
        return 0.0, [Guess("floor", "0.0000 m", reason, Confidence.SURE)]
    return height, [guess]


def _reference(solved: SolvedBody, options: ImportOptions) -> FloatArray:
    """Zero pose, because bodies are solved with a T-pose there."""
    return reference_by_option(solved.skeleton, solved.poses, solved.body_map, options.reference or "zero")


def _body_guesses(
    take: MarkerTake,
    followed: TrackedBody,
    solved: SolvedBody,
    off: Mapping[str, FloatArray],
) -> list[Guess]:
    """Guesses about the body; ``off`` (N,) are distances in metres from each joint to its centre in frames that show
    it.
    """
    used = _there(take)
    first = followed.first_frame
    every = np.concatenate(list(off.values()))
    guesses = [
        Guess(
            "marker map",
            take.marker_map.name,
            f"{counted_noun(len(used.labels), 'marker')} at {counted_noun(len(used.markers), 'body location')}.",
            Confidence.LIKELY if take.marker_map.name == PROPOSED_MAP_NAME else Confidence.SURE,
        ),
        Guess(
            "measures",
            followed.measures.words,
            f"Bone widths; the middle of a marker is {1000 * followed.measures.radius:.1f} mm over the skin.",
            Confidence.SURE if "LKNEEWIDTH" in take.trial.measures else Confidence.LIKELY,
        ),
        Guess(
            "skeleton",
            "bones of constant length",
            f"Its joints lie {1000 * float(np.median(every)):.0f} mm from the joint centres, "
            f"{1000 * float(np.max(every)):.0f} mm at worst: skin moves over bones.{_far_off(off)}",
            Confidence.of(-float(np.median(every)), -_SKIN, -0.5 * _SKIN),
        ),
        *_side_guesses(take),
        *_end_guesses(take),
    ]
    if solved.resting:
        guesses.append(_not_shown(take, used, solved.resting))
    subjects = sorted({subject_of(label) for label in take.trial.markers} - {""})
    if len(subjects) > 1:
        reason = f"The file holds {', '.join(subjects)}. Choose the subject under Edit > Markers."
        trust = Confidence.LIKELY if take.subject else Confidence.DOUBTFUL
        guesses.append(Guess("subject", take.subject or "all together", reason, trust))
    guesses += [
        Guess(report.title.lower(), report.summary.rstrip("."), "; ".join(report.details), Confidence.LIKELY)
        for report in followed.reports
        if report.told
    ]
    if first or followed.unseen:
        unseen = counted_noun(followed.unseen, "frame")
        words = f"In {unseen} a body location is not visible: it is interpolated relative to the pelvis."
        guesses.append(Guess("first frame", str(first), words if followed.unseen else "", Confidence.SURE))
    if left_out := take.trial.frame_count - len(next(iter(followed.joints.values()))):
        reason = f"Of the {take.trial.frame_count} recorded, {left_out} at the end show no body and were left out."
        guesses.append(Guess("frames", str(take.trial.frame_count - left_out), reason, Confidence.SURE))
    return guesses


def _far_off(off: Mapping[str, FloatArray]) -> str:
    """Clause about joints that are farther from their centres than skin moves; empty if there are none."""
    far = [joint.replace("_", " ") for joint, own in off.items() if len(own) and float(np.median(own)) > _SKIN]
    return f" {', '.join(far).capitalize()} are farther away most of the time." if far else ""


def _side_guesses(take: MarkerTake) -> list[Guess]:
    """Guesses about positions whose left and right are exchanged, and labels that the map has corrected."""
    names = exchanged_places(take.trial, take.marker_map, take.subject)
    if names:
        shown = ", ".join(name.replace("_", " ") for name in names)
        moving = f"The markers at {shown} move with the other side of the body"
        return [
            Guess(
                "sides", "as the map says", f"{moving}: labels of left and right may be swapped.", Confidence.DOUBTFUL
            )
        ]
    labels = sorted(
        label
        for role, own in take.marker_map.markers.items()
        for label in own
        if (said := side_and_part(label)) is not None and said[0] and not role.startswith(said[0])
    )
    if not labels:
        return []
    shown = ", ".join(labels[:_SHOWN]) + (f" and {len(labels) - _SHOWN} more" if len(labels) > _SHOWN else "")
    reason = f"{shown} are named after one side and move with the other: their labels were swapped, and are corrected."
    return [Guess("sides", "left and right swapped, corrected", reason, Confidence.LIKELY)]


def _end_guesses(take: MarkerTake) -> list[Guess]:
    """Guesses about roles of one side that carry each other's names, and labels that the map has corrected."""
    ends = exchanged_ends(take.trial, take.marker_map, take.subject)
    limbs = exchanged_on_limbs(take.trial, take.marker_map, take.subject)
    if there := sorted({*ends, *limbs}):
        shown = ", ".join(role.replace("_", " ") for role in there)
        reason = (
            f"The markers at {shown} are placed as if their labels were swapped."
            " Check the marker map under Edit > Markers."
        )
        return [Guess("places", "as the map says", reason, Confidence.DOUBTFUL)]
    labels = sorted(
        label
        for role, own in take.marker_map.markers.items()
        for label in own
        if (said := side_and_part(label)) is not None
        and frozenset((said[1], role.removeprefix("left_").removeprefix("right_"))) in EXCHANGEABLE
    )
    if not labels:
        return []
    shown = ", ".join(labels[:_SHOWN]) + (f" and {len(labels) - _SHOWN} more" if len(labels) > _SHOWN else "")
    reason = (
        f"{shown} are at each other's body locations in the whole capture:"
        " their labels were swapped, and are corrected."
    )
    return [Guess("places", "swapped labels corrected", reason, Confidence.LIKELY)]


def _not_shown(take: MarkerTake, used: MarkerMap, resting: Sequence[str]) -> Guess:
    """Guess about limbs at rest: their missing positions, and unused markers that may be there."""
    there = {*used.markers, *used.centres}
    sentences = []
    for part in resting:
        if part == "head":
            sentences.append(
                f"The head needs markers at three body locations and has {sum(role in there for role in HEAD_MARKERS)}."
            )
            continue
        places = [f"{side}_{joint}" for joint in _PLACES[part] for side in SIDE_WORDS]
        lacking = [ROLES_BY_ID[place].words.partition(",")[0].lower() for place in places if place not in there]
        lack = f"The {part} lack markers at {', '.join(lacking)}."
        sentences.append(lack if lacking else f"The {part} cannot be solved from their markers.")
    known = used.labels | set(used.centres.values())
    unused = [bare for bare in seen_labels(take.trial, take.subject).values() if bare not in known]
    more = f" and {len(unused) - _SHOWN} more" if len(unused) > _SHOWN else ""
    beside = f" Not in the marker map: {', '.join(unused[:_SHOWN])}{more}." if unused else ""
    words = f"{' '.join(sentences)} Parts that are not shown stay in the rest pose.{beside}"
    return Guess("not shown", " and ".join(resting), words, Confidence.DOUBTFUL)


def _contents(trial: Trial, markers: int) -> str:
    """``8 markers, 1 force plate``."""
    counts = {"marker": markers, "force plate": len(trial.plates), "signal": len(trial.analog.labels)}
    return ", ".join(f"{count} {word}{'' if count == 1 else 's'}" for word, count in counts.items() if count)


def _shown(trial: Trial) -> str:
    """Clause about a trial without markers: ``all 12 points that it holds are angles or moments``, or none is ever
    seen.
    """
    kinds = sorted({kind for kind, ever in zip(trial.kinds, trial.ever_seen, strict=True) if ever})
    if not kinds:
        return f"none of its {len(trial.labels)} points is ever seen"
    return f"all that is seen of its {len(trial.labels)} points are computed ones ({', '.join(kinds)})"


def _cloud(take: MarkerTake, lacking: str, options: ImportOptions, guesses: list[Guess]) -> Capture:
    """Capture with every marker as a joint of its own under one root, until the labels are known."""
    trial = take.trial
    labels = tuple(seen_labels(trial, take.subject))
    if not labels:
        raise StudioError(f"{trial.source} shows no marker: {_shown(trial)}. Export it with its markers.")
    up_axis = parse_axis(options.up_axis or "Z")
    points = trial.metres * trial.points[:, [trial.labels.index(label) for label in labels]] @ turn_to_world(up_axis).T
    frames = np.arange(trial.frame_count)
    for index in range(len(labels)):
        seen = np.flatnonzero(seen_mask(points[:, index]))
        for axis in range(3):
            points[:, index, axis] = np.interp(frames, seen, points[seen, index, axis])
    translations = np.concatenate([np.zeros((len(points), 1, 3)), points], axis=1)
    names = ("Markers", *(label_without_subject(label) for label in labels))
    skeleton = Skeleton(
        names,
        np.array([-1, *[0] * len(labels)]),
        translations[0],
        np.zeros(len(names), dtype=bool),
    )
    rotations = np.tile(IDENTITY_QUATERNION, (*translations.shape[:2], 1))
    guesses += [
        Guess(
            "marker map",
            "not complete",
            f"The file holds {_contents(trial, len(labels))}. Which markers are which is not known: {lacking}. "
            "Assign them under Edit > Markers; the map can be saved and used again.",
            Confidence.DOUBTFUL,
        ),
        Guess(
            "up axis",
            up_axis,
            "Without a body nothing tells what is up; most laboratories have Z up.",
            Confidence.DOUBTFUL,
        ),
    ]
    return Capture(
        name=trial.name,
        source=trial.source,
        skeleton=skeleton,
        poses=PoseSequence(rotations, translations),
        frame_rate=options.frame_rate or trial.frame_rate,
        body_map=None,
        reference_rotations=np.tile(IDENTITY_QUATERNION, (len(names), 1)),
        floor=options.floor or 0.0,
        unit=trial.unit,
        up_axis=up_axis,
        first_frame=0,
        guesses=tuple(guesses),
        repairs=(),
    )
