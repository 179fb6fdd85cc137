"""Feet on the ground, frame by frame in plain words. States: bit 1 the heel stands, bit 2 the toe."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from tests.core.twins.rotation import from_vector, level, to_vector

HEEL, TOE, FLAT = 1, 2, 3
REACH = 5.5
FADE = 5.0
ASIDE = 0.35
SOLE_DOWN = 0.5


@dataclass
class Sole:
    """A foot: ankle to toe joint in foot axes, ankle above the sole, heel behind the ankle."""

    foot: np.ndarray
    ankle_height: float
    heel_length: float

    def heel_below_ankle(self, rotation: np.ndarray) -> np.ndarray:
        return rotation @ np.array([-self.heel_length, 0.0, -self.ankle_height])

    def pad_below_ankle(self, rotation: np.ndarray) -> np.ndarray:
        """Three fifths of the way from the edge of the heel to below the ankle, along the ground."""
        ahead = rotation[:, 0] * [1.0, 1.0, 0.0]
        return self.heel_below_ankle(rotation) + 0.6 * self.heel_length * ahead / np.linalg.norm(ahead)

    def ball_below_ankle(self, rotation: np.ndarray) -> np.ndarray:
        """The ball's sole hangs straight below the toe joint, for toes lie level."""
        return rotation @ self.foot - np.array([0.0, 0.0, self.ankle_height + self.foot[2]])


def stretches(mask: np.ndarray) -> Iterator[range]:
    """Unbroken runs of true frames."""
    inside = [frame for frame in range(len(mask)) if mask[frame]]
    for first in (frame for frame in inside if frame - 1 not in inside):
        last = first
        while last + 1 in inside:
            last += 1
        yield range(first, last + 1)


def fill_gaps(values: np.ndarray, known: np.ndarray) -> np.ndarray:
    frames = np.flatnonzero(known)
    if not len(frames):
        return np.zeros_like(values)
    filled = values.copy()
    for frame in np.flatnonzero(~known):
        before, after = frames[frames < frame], frames[frames > frame]
        if len(before) and len(after):
            t = (frame - before[-1]) / (after[0] - before[-1])
            ease = 6 * t**5 - 15 * t**4 + 10 * t**3
            filled[frame] = (1 - ease) * values[before[-1]] + ease * values[after[0]]
        else:
            filled[frame] = values[before[-1] if len(before) else after[0]]
    return filled


def fade_gaps(values: np.ndarray, known: np.ndarray, track: np.ndarray, least: float) -> np.ndarray:
    """Corrections (F, 3) that fade beside known ones with their velocity, as fast as the own acceleration allows."""
    faded = np.where(known[:, None], values, 0.0)
    bends = np.diff(np.pad(track, ((1, 1), (0, 0)), mode="reflect", reflect_type="odd"), 2, axis=0)
    for gap in stretches(~known):
        inside = [frame for frame in gap if 0 < frame < len(known) - 1]
        allowed = 0.5 * max(np.sqrt((bends[inside] ** 2).sum() / max(len(inside), 1)), 1e-12)
        open_ended = gap[0] == 0 or gap[-1] == len(known) - 1
        whole = np.inf if open_ended else len(gap) + 1
        for edge, inner in ((gap[0] - 1, gap[0] - 2), (gap[-1] + 1, gap[-1] + 2)):
            if not 0 <= edge < len(known):
                continue
            steps = np.abs(np.array(gap) - edge)
            span = min(max(np.sqrt(10 / np.sqrt(3) * np.linalg.norm(values[edge]) / allowed), least), whole)
            t = np.minimum(steps / span, 1.0)
            faded[gap] += (1 - (6 * t**5 - 15 * t**4 + 10 * t**3))[:, None] * values[edge]
            if 0 <= inner < len(known) and known[inner]:
                t = np.minimum(steps / min(REACH, len(gap) + 1), 1.0)
                faded[gap] += (steps * (1 - t) ** 2)[:, None] * (values[edge] - values[inner])
    return faded


def level_soles(rotations: np.ndarray, states: np.ndarray) -> np.ndarray:
    corrections = np.zeros((len(states), 3))
    for stretch in stretches(states == FLAT):
        wanted = level(rotations[stretch].mean(axis=0))
        for frame in stretch:
            corrections[frame] = to_vector(wanted @ rotations[frame].T)
    corrections = fade_gaps(corrections, states == FLAT, rotations[:, :, 0], np.inf)
    turns = [from_vector(each) for each in fade_gaps(corrections, states != 0, rotations[:, :, 0], FADE)]
    return np.array(turns) @ rotations


def level_toes(feet: np.ndarray, toes: np.ndarray, states: np.ndarray) -> np.ndarray:
    """``toes`` relative to the foot; the answer in the world."""
    standing = (states & TOE) != 0
    corrections = np.zeros((len(states), 3))
    for frame in np.flatnonzero(standing):
        lies = np.clip(1.0 + 2.0 * feet[frame, 2, 2], 0.0, 1.0)
        x, z = feet[frame][:2, 0], feet[frame][:2, 2]
        heads = (1.0 + feet[frame, 2, 2]) * x - feet[frame, 2, 0] * z
        turn = to_vector(
            feet[frame].T @ from_vector(np.array([0.0, 0.0, np.arctan2(heads[1], heads[0])])) @ toes[frame].T
        )
        rolled = np.clip(np.abs(feet[frame, 2, 1]) / ASIDE - 1.0, 0.0, 1.0)
        tipped = np.clip((SOLE_DOWN - feet[frame, 2, 2]) / ASIDE, 0.0, 1.0)
        lies, rolled, tipped = (each**3 * (each * (6.0 * each - 15.0) + 10.0) for each in (lies, rolled, tipped))
        aside = rolled * tipped
        turned = from_vector(lies * (1.0 - aside) * turn)
        toe = (feet[frame] @ turned @ toes[frame])[:, 0]
        down = np.arcsin(toe[2]) * np.array([-toe[1], toe[0], 0.0]) / np.linalg.norm(toe[:2]) @ feet[frame]
        corrections[frame] = to_vector(from_vector((lies + aside - lies * aside) * down) @ turned)
    corrections = fade_gaps(corrections, standing, feet[:, :, 0], np.inf)
    turns = np.array([from_vector(each) for each in fade_gaps(corrections, states != 0, feet[:, :, 0], FADE)])
    return feet @ turns @ toes


def plant_ankles(
    ankles: np.ndarray, feet: np.ndarray, states: np.ndarray, sole: Sole, ground: np.ndarray
) -> np.ndarray:
    shift = np.zeros_like(ankles)
    for episode in stretches(states != 0):
        for frame, place in _planted(ankles, feet, states, sole, episode).items():
            height = -min(sole.heel_below_ankle(feet[frame])[2], sole.ball_below_ankle(feet[frame])[2])
            shift[frame] = [*(place - ankles[frame, :2]), ground[frame] + height - ankles[frame, 2]]
    return ankles + fade_gaps(shift, states != 0, ankles, FADE)


def geometric_median(places: np.ndarray) -> np.ndarray:
    """The place with the least sum of distances: 32 steps of Weiszfeld's search, among distances without a corner."""
    middle = places.mean(axis=0)
    apart = np.linalg.norm(places - middle, axis=1).mean()
    if apart == 0.0:
        return middle
    for _ in range(32):
        weights = 1.0 / np.hypot(np.linalg.norm(places - middle, axis=1), apart / 100)
        middle = weights @ places / weights.sum()
    return middle


def _planted(
    ankles: np.ndarray, feet: np.ndarray, states: np.ndarray, sole: Sole, episode: range
) -> dict[int, np.ndarray]:
    """Place on the ground of the ankle in every frame of one contact."""
    to_toe = (feet @ sole.foot)[:, :2]
    to_heel = np.array([sole.pad_below_ankle(foot)[:2] for foot in feet])
    heels = [run for run in stretches(states & HEEL != 0) if run[0] in episode]
    runs = heels or [run for run in stretches(states & TOE != 0) if run[0] in episode]
    longest = max(runs, key=len)
    seed, pivot = list(longest), to_heel if heels else to_toe
    stood = (ankles[:, :2] + pivot)[seed]
    places = {seed[0]: geometric_median(stood) - pivot[seed[0]]}
    for frames in (range(seed[0] + 1, episode[-1] + 1), range(seed[0] - 1, episode[0] - 1, -1)):
        previous = seed[0]
        for frame in frames:
            pivot = to_heel if states[frame] & states[previous] & HEEL else to_toe
            places[frame] = places[previous] + pivot[previous] - pivot[frame]
            previous = frame
    return places
