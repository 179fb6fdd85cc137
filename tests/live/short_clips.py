"""Rows of clips that are as short, fast and often repeated as clips can be, one row a seed."""

from functools import cache
from random import Random

import numpy as np

from studio.core.captures.capture import Capture
from studio.core.captures.contacts import ContactInterval, ContactPoint
from studio.core.curves.retiming import FASTEST_CLIP_SPEED, SLOWEST_CLIP_SPEED
from studio.core.solver.adapt import adapt
from studio.core.solver.performers.staged_performances import adapt_performers
from studio.core.stage.clip import Clip
from studio.core.stage.layer import Layer, Region
from studio.core.stage.project import Performer, Project
from studio.jobs.performances import prepared_capture
from studio.library.scenes.stagehand import source_motions, varied_characters
from studio.live.playing_stage import LiveStage

NAMES = "front_kick", "reach_grasp", "walk_turn"


@cache
def stuff() -> Project:
    return source_motions(**{name: (name, name) for name in NAMES})


_known: dict[int, tuple[Capture, tuple]] = {}


def prepare(capture: Capture) -> tuple:
    if id(capture) not in _known:
        _known[id(capture)] = capture, prepared_capture(capture)
    return _known[id(capture)][1]


def short_clip(random: Random, number: int) -> Clip:
    name = random.choice(NAMES)
    count = stuff().captures[name].frame_count
    first = random.choice([0, 0, 100, count - 1, count - 2])
    last = min(first + random.choice([0, 0, 1, 2, 2, 5, 30]), count - 1)
    return Clip(
        name,
        first,
        last,
        random.choice([0.0, 0.0, 0.01, 0.1, 1.0]),
        f"clip {number}",
        speed=random.choice([1.0, FASTEST_CLIP_SPEED, FASTEST_CLIP_SPEED, SLOWEST_CLIP_SPEED, 2.5]),
        repeats=random.choice([1, 1, 2, 3, 10]),
        mirrored=random.random() < 0.3,
        joined=random.random() < 0.7,
        turn=random.choice([0.0, 1.0]),
        ease=random.choice([0.0, 0.0, 0.2]),
    )


def staged(clips: tuple[Clip, ...], layers: tuple[Layer, ...], carried: bool) -> Project:
    """One child that plays a row; ``carried`` by a hand as well, so that clips are blended."""
    contacts = dict(stuff().contacts)
    if carried:
        contacts["hand"] = ContactInterval(clips[0].motion_id, ContactPoint.LEFT_HAND, clips[0].first, clips[0].last)
    one = Performer("One", "child", clips, layers=layers)
    return Project(stuff().captures, stuff().motions, varied_characters(5), {"one": one}, {}, contacts)


def short_layer(random: Random) -> Layer:
    region, fade = random.choice(list(Region)), random.choice([0.0, 0.1])
    return Layer(short_clip(random, 8), region, 1.0, fade, fade, random.random() < 0.3, random.choice([-1, 0, 100]))


def play(seed: int, live: bool = True) -> int:
    """Adapt a row of short clips, play it live and let another one take over. Returns its frames.

    Raises AssertionError where numbers are not finite.
    """
    random = Random(seed)
    clips = tuple(short_clip(random, number) for number in range(random.choice([1, 1, 2, 3])))
    layers = (short_layer(random),) if random.random() < 0.4 else ()
    project = staged(clips, layers, random.random() < 0.3)
    return assert_finite(project, live, short_clip(random, 9))


def assert_finite(project: Project, live: bool, next_clip: Clip | None = None) -> int:
    """Adapt the performer ``one``, play it live, and let ``next_clip`` take over. Returns the adapted frames.

    Raises AssertionError where positions are not finite.
    """
    adapted = adapt_performers(project, ["one"], prepare, adapt).performances["one"].adapted
    assert np.isfinite(adapted.positions).all(), "positions that are not finite"
    if live:
        stage = LiveStage(project, prepare)
        for clip in (None, next_clip):
            if clip is not None:
                stage.start("one", clip)
            for _ in range(3):
                shown = stage.step(1.0 / 60.0)["one"]
            assert np.isfinite(shown.positions).all(), "live positions that are not finite"
    return len(adapted.positions)
