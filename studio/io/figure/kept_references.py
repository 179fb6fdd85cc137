"""Reference poses kept in the user's folder: for each skeleton that of the take which shows it most surely.

Imports into projects and libraries keep them; every reader uses them. A project stores the pose that it uses.
"""

import hashlib
import json
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from platformdirs import user_data_path

from studio.core.body.humanoid import BodyMap
from studio.core.body.kinematics import joint_positions
from studio.core.body.pose import PoseSequence
from studio.core.body.skeleton import Skeleton
from studio.core.captures.capture import Capture
from studio.core.captures.confidence import Confidence
from studio.core.captures.reference_pose import ALL_FRAMES, ReferencePose, ease_weights
from studio.core.errors import StudioError
from studio.io.json_text import read_json, write_json


@dataclass(frozen=True)
class KeptReference:
    """Reference ``pose`` found from all frames of ``take``, in which the body stands at ease for ``seconds``."""

    pose: ReferencePose
    take: str
    seconds: float

    @property
    def certainty(self) -> tuple[int, float]:
        """Rank by which kept and found poses are compared; greater is more certain."""
        return certainty(self.pose.confidence, self.seconds)


FARTHEST_OFFSET_METRES = 1e12
"""Offsets of damaged files beyond it, which no integer of millimetres holds, count as equal."""


def references_folder() -> Path:
    """Folder of the kept reference poses."""
    return user_data_path("morpho-studio", appauthor=False) / "reference_poses"


def skeleton_digest(skeleton: Skeleton) -> str:
    """Hash of a skeleton that is equal for all captures of one actor: joints, and bones to the millimetre."""
    offsets = np.clip(skeleton.offsets[1:], -FARTHEST_OFFSET_METRES, FARTHEST_OFFSET_METRES)
    lengths = np.rint(1000.0 * offsets).astype(np.int64).tolist()
    text = repr((skeleton.names, skeleton.parents.tolist(), lengths))
    return hashlib.sha256(text.encode()).hexdigest()


def kept_reference(skeleton: Skeleton, body_map: BodyMap) -> KeptReference | None:
    """Reference pose kept for a mapped skeleton; None if there is none. Raises StudioError if its file is damaged."""
    path = _file_of(skeleton, body_map)
    if not path.is_file():
        return None
    record = read_json(path)
    try:
        rotations = np.array(record["rotations"], dtype=np.float64)
        seconds = float(record["seconds at ease"])
        if rotations.shape != (skeleton.joint_count, 4) or not _are_unit(rotations) or not np.isfinite(seconds):
            raise ValueError("its rotations are not one quaternion a joint")
        pose = ReferencePose(rotations, ALL_FRAMES, str(record["reason"]), Confidence(record["confidence"]))
        return KeptReference(pose, str(record["take"]), seconds)
    except (KeyError, TypeError, ValueError) as error:
        raise StudioError(f"{path} is not a kept reference pose ({error}). Delete it.") from error


def with_reference_kept(capture: Capture) -> Capture:
    """Capture, after its reference pose is kept if it was found from all frames and none more certain is kept.

    A file that cannot be written is reported among the capture's repairs.
    """
    guess = next((each for each in capture.guesses if each.subject == "reference pose"), None)
    if guess is None or guess.value != ALL_FRAMES or guess.confidence is None or capture.body_map is None:
        return capture
    seconds = seconds_at_ease(capture.skeleton, capture.poses, capture.body_map, capture.frame_rate)
    try:
        kept = kept_reference(capture.skeleton, capture.body_map)
    except StudioError:
        kept = None  # the file is damaged, and replaced
    if kept is not None and kept.certainty >= certainty(guess.confidence, seconds):
        return capture
    record = {
        "take": capture.name,
        "seconds at ease": seconds,
        "reason": guess.reason,
        "confidence": guess.confidence,
        "rotations": capture.reference_rotations.tolist(),
    }
    path = _file_of(capture.skeleton, capture.body_map)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        write_json(path, record)
    except (OSError, StudioError) as error:
        sentence = f"Its reference pose cannot be kept for other takes of its skeleton: {error}"
        return replace(capture, repairs=(*capture.repairs, sentence))
    return capture


def certainty(confidence: Confidence, seconds: float) -> tuple[int, float]:
    """Rank by which reference poses are compared: the confidence of the guess, then the ``seconds`` at ease."""
    return -list(Confidence).index(confidence), seconds


def seconds_at_ease(skeleton: Skeleton, poses: PoseSequence, body_map: BodyMap, frame_rate: float) -> float:
    """Seconds for which a body stands upright and symmetric; frames nearly at ease count in part."""
    return float(ease_weights(joint_positions(skeleton, poses), body_map).sum() / frame_rate)


def _file_of(skeleton: Skeleton, body_map: BodyMap) -> Path:
    text = skeleton_digest(skeleton) + json.dumps(body_map.to_json(skeleton), sort_keys=True)
    return references_folder() / f"{hashlib.sha256(text.encode()).hexdigest()}.json"


def _are_unit(rotations: NDArray[np.float64]) -> bool:
    return bool((np.abs(np.linalg.norm(rotations, axis=1) - 1.0) < 1e-6).all())
