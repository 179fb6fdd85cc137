"""Random commands on rows of clips that are as short and fast as clips can be, one sequence a seed."""

from collections.abc import Callable
from dataclasses import replace
from random import Random

from studio.core.constraints.scope import Scope
from studio.core.curves.keyed import KeyedNumber
from studio.core.curves.retiming import FASTEST_CLIP_SPEED, SLOWEST_CLIP_SPEED, Speed
from studio.core.curves.tangents import TangentMode, tangents_of
from studio.core.errors import StudioError
from studio.core.stage.clip_row import with_first_frame, with_last_frame
from studio.core.stage.layer import Region
from studio.core.stage.project import Project
from studio.document import clip_edits
from studio.document.edited_project import EditedProject
from studio.io.project.entity_json import project_json
from tests.builders import make_constraint
from tests.live.short_clips import NAMES, assert_finite, short_clip, short_layer, staged

STEPS = 10


def keyed_speed(random: Random, near: float) -> Speed:
    """A speed with one to four keys around second ``near`` of a motion, some of them far away."""
    times = sorted({round(near + random.choice([-1.0, 0.0, 0.01, 0.02, 0.5, 1e3, 1e8]), 3) for _ in range(4)})
    values = [random.choice([SLOWEST_CLIP_SPEED, FASTEST_CLIP_SPEED, 1.0, random.uniform(0.1, 10.0)]) for _ in times]
    speed = KeyedNumber(tuple(times), tuple(values))
    modes = (random.choice([None, *TangentMode]) for _ in times)
    tangents = tuple(None if mode is None else tangents_of(mode) for mode in modes)
    return replace(speed, tangents=tangents)


def commands(random: Random, document: EditedProject) -> list[Callable[[], object]]:
    """Edits that are possible on the clips of a project at present."""
    project = document.project
    if not project.clips:
        return [lambda: clip_edits.add_clip(document, ["one"], random.choice(NAMES))]
    clip_id = random.choice(list(project.clips))
    clip, rate = project.clips[clip_id], project.frame_rate_of(project.clips[clip_id])
    count = project.captures[project.motions[clip.motion_id].capture_id].frame_count
    frame = clip.first + random.choice([-1, 0, 0, 1, 2, count])
    time = clip.start + clip.length(rate) * random.choice([-0.1, 0.0, 0.01, 0.5, 0.99, 1.0])
    speed = random.choice(
        [FASTEST_CLIP_SPEED, SLOWEST_CLIP_SPEED, 0.0, -1.0, float("nan"), keyed_speed(random, clip.first / rate)]
    )
    fields = random.choice([
        {"repeats": random.choice([0, 1, 2, 10])}, {"joined": not clip.joined}, {"turn": 2.0}, {"grip": 1.0},
        {"start": random.choice([-1.0, 0.0, time])}, {"offset": (1.0, 0.0)}, {"ease": random.choice([0.0, 0.2, -1.0])},
    ])  # fmt: skip
    return [
        lambda: clip_edits.set_speed(document, clip_id, speed, "Speed"),
        lambda: clip_edits.edit_clip(document, clip_id, lambda each: (with_first_frame(each, rate, frame),), "Begin"),
        lambda: clip_edits.edit_clip(document, clip_id, lambda each: (with_last_frame(each, frame, count),), "End"),
        lambda: clip_edits.edit_clip(document, clip_id, lambda each: (replace(each, **fields),), "Edit"),
        lambda: clip_edits.split_clip(document, clip_id, time),
        lambda: clip_edits.mirror_clip(document, clip_id),
        lambda: clip_edits.duplicate_clip(document, clip_id),
        lambda: clip_edits.remove_clips(document, [clip_id], "Remove"),
        lambda: clip_edits.add_clip(document, ["one"], random.choice(NAMES), random.choice([None, time])),
        lambda: clip_edits.add_layer(document, ["one"], random.choice(NAMES), time),
        lambda: clip_edits.edit_layer(document, clip_id, "Layer", region=random.choice(list(Region)), weight=0.5),
        lambda: document.add("constraints", make_constraint(clip.motion_id, scope=Scope(clip_id=clip_id)), "Add"),
    ]


def short_stage(random: Random) -> Project:
    """A child with a row of short clips, some with layers."""
    clips = tuple(short_clip(random, number) for number in range(random.choice([1, 2, 3])))
    return staged(clips, (short_layer(random),) if random.random() < 0.4 else (), random.random() < 0.3)


def play(seed: int, live: bool = False) -> int:
    """Run commands, perform what they made, undo and redo all of it; returns the number of steps on the undo stack.

    Raises AssertionError where numbers are not finite or where undo and redo do not give the same bytes.
    """
    random = Random(seed)
    first = short_stage(random)
    document, refused = EditedProject(first), "."
    for _ in range(STEPS):
        try:
            random.choice(commands(random, document))()
        except (StudioError, ValueError) as error:
            refused = str(error)
        assert refused.endswith("."), f"no sentence: {refused}"
    last = document.project
    if last.performers["one"].clips and sum(each.length(60.0) for each in last.performers["one"].all_clips) < 60.0:
        assert_finite(last, live)
    while document.undo_stack.canUndo():
        document.undo_stack.undo()
    assert project_json(document.project, {}) == project_json(first, {}), "undo"
    while document.undo_stack.canRedo():
        document.undo_stack.redo()
    assert project_json(document.project, {}) == project_json(last, {}), "redo"
    return document.undo_stack.count()
