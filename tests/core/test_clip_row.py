"""Edits of clips: what is cut plays as before, and an edit is of all who play the clip."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as some

from studio.core.normalized.compose import compose_pieces
from studio.core.normalized.pieces import MotionPiece
from studio.core.stage.clip import Clip
from studio.core.stage.clip_row import (
    clip_halves,
    frame_at,
    players_of,
    with_clip_edited,
    with_first_frame,
    with_last_frame,
)
from tests.builders import make_project
from tests.core.test_compose import cut, example

RATE = 60.0
NAMES = ("second", "third", "fourth")


def pieces_of(clips: tuple[Clip, ...], motion: MotionPiece) -> tuple[MotionPiece, ...]:
    """Frames that clips of one motion play, repeat by repeat."""
    once = {clip.id: clip.length(RATE) / clip.repeats for clip in clips}
    return tuple(
        cut(
            motion, first=clip.first, last=clip.last, start=clip.start + repeat * once[clip.id], speed=clip.speed,
            mirrored=clip.mirrored, joined=clip.joined or repeat > 0, origin=(place, repeat),
        )
        for place, clip in enumerate(clips)
        for repeat in range(clip.repeats)
    )  # fmt: skip


@pytest.mark.parametrize("name", ["walk_turn", "front_kick"])
@pytest.mark.parametrize("mirrored", [False, True])
def test_a_split_clip_plays_as_it_did(name: str, mirrored: bool) -> None:
    motion = example(name)
    clip = Clip("motion", 20, 220, 0.5, "one", mirrored=mirrored, speed=1.25)
    whole = compose_pieces(pieces_of((clip,), motion))
    parts = compose_pieces(pieces_of(clip_halves(clip, RATE, 2.0, iter(NAMES)), motion))
    assert parts.timing == whole.timing
    assert np.abs(parts.motion.channels - whole.motion.channels).max() < 1e-6  # leg lengths: a micron


@settings(max_examples=200, deadline=None)
@given(
    some.integers(0, 50), some.integers(2, 80), some.integers(1, 5), some.floats(0.1, 10.0), some.floats(-5.0, 5.0),
    some.floats(0.0, 1.0),
)  # fmt: skip
def test_parts_of_a_clip_follow_each_other_and_are_as_long_together(
    first: int, length: int, repeats: int, speed: float, start: float, share: float
) -> None:
    clip = Clip("motion", first, first + length, start, "one", speed, repeats)
    time = start + share * clip.length(RATE)
    played = round((time - start) * speed * RATE)
    if not 0 < played < repeats * length:
        with pytest.raises(ValueError, match="playhead"):
            clip_halves(clip, RATE, time, iter(NAMES))
        return
    parts = clip_halves(clip, RATE, time, iter(NAMES))
    assert parts[0].id == "one"
    assert len({part.id for part in parts}) == len(parts) > 1
    for one, other in pairwise(parts):
        assert other.start == pytest.approx(one.start + one.length(RATE))
    assert sum(part.length(RATE) for part in parts) == pytest.approx(clip.length(RATE))
    assert any(abs(part.start - time) <= 0.51 / (speed * RATE) for part in parts[1:])


@given(some.integers(-40, 140), some.floats(0.1, 10.0))
def test_trimming_the_beginning_leaves_every_frame_when_it_was(frame: int, speed: float) -> None:
    clip = Clip("motion", 10, 60, 2.0, "one", speed)
    trimmed = with_first_frame(clip, RATE, frame)
    assert 0 <= trimmed.first <= trimmed.last == 60
    for time in (1.0, 2.0, 3.0):
        assert frame_at(trimmed, RATE, time) == pytest.approx(frame_at(clip, RATE, time))


@given(some.integers(-40, 140))
def test_an_end_stays_within_the_motion_and_behind_the_beginning(frame: int) -> None:
    assert 10 <= with_last_frame(Clip("motion", 10, 60), frame, 100).last <= 99


def test_an_edit_is_of_all_who_play_the_clip_and_leaves_other_clips_alone() -> None:
    project = make_project(characters=2)
    players = players_of(project, "clip")
    assert len(players) == 2
    other = Clip("motion", 0, 5, 9.0, "other")
    for performer in players.values():
        both = with_clip_edited(performer, "clip", lambda clip: (clip, other))
        late = with_clip_edited(both, "clip", lambda clip: (Clip("motion", 0, 5, 20.0, clip.id),))
        assert [clip.id for clip in late.clips] == ["other", "clip"]  # in the order in which they begin
