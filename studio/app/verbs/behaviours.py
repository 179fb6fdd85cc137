"""Actions on the behaviour of the active performer: its panel, and ready-made states."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial

from studio.app.workbench import Workbench
from studio.core.captures.reaching import farthest_reach_frame
from studio.core.curves.activation import ActivationCurve, EaseShape
from studio.core.errors import StudioError
from studio.core.stage import ready_made
from studio.core.stage.behaviour import Behaviour
from studio.core.stage.clip import Clip
from studio.core.stage.project import Project, new_id
from studio.core.stage.reactions import ACTIVE_WHOLE_CLIP
from studio.document.behaviour_commands import add_behaviour, edit_behaviour, set_cast, state_key

STRIKE_KEY = "X"
WARD_EASE_SECONDS, WARD_HOLD_SECONDS = 0.2, 1 / 120
"""Seconds over which a blocking arm fades in and out, and seconds before and after the hit during which it meets the
fist.
"""
STRIKE_WORDS = ("kick", "punch", "strike", "jab", "hook", "blow")
WARD_WORDS = ("ward", "block", "parry", "guard")

BehaviourChange = Callable[[Behaviour], Behaviour]


def show_behaviour(bench: Workbench) -> None:
    """Show the behaviour of the active performer."""
    bench.window.show_dock("Behaviour")


def keep_distance(bench: Workbench) -> None:
    """Add a reaction that keeps striking distance to the partner."""
    _make(bench, "Keep striking distance", ready_made.with_distance_kept)


def add_ward_off(bench: Workbench) -> None:
    """Add a state that blocks attacks, with a motion of the project."""
    _with_motion(
        bench, "Choose the clip to block with", WARD_WORDS,
        lambda clip: _make(
            bench, "Block when attacked", lambda old: ready_made.with_parry(old, clip, _when_hit(bench, clip))
        ),
    )  # fmt: skip


def add_lean_away(bench: Workbench) -> None:
    """Add a reaction that leans away from the partner's fist."""
    _make(bench, "Lean away from the fist", ready_made.with_lean_away)


def add_strike(bench: Workbench) -> None:
    """Add a state that strikes when a key is pressed, with a motion of the project."""
    _with_motion(
        bench, "Choose the clip to strike with", STRIKE_WORDS,
        lambda clip: _make(bench, "Strike on key press", lambda old: ready_made.with_strike(old, clip, STRIKE_KEY)),
    )  # fmt: skip


READY_MADE_PARTS: dict[str, tuple[str, str, Callable[[Workbench], None]]] = {
    "keep_distance": (
        "Keep striking distance", "Step towards or away from the partner, and face it", keep_distance,
    ),
    "ward_off": (
        "Block when attacked", "Meet the fist of an attacking partner with the forearm", add_ward_off,
    ),
    "lean_away": (
        "Lean away from the fist", "Lean the torso back while the partner's fist is near the head", add_lean_away,
    ),
    "strike_on_key": (
        "Strike on key press", f"Strike when {STRIKE_KEY} is pressed in live play, and send an event to the partner",
        add_strike,
    ),
}  # fmt: skip
"""Text, tooltip and function of each ready-made part of a behaviour, by action id."""


def _pair(bench: Workbench) -> tuple[str, str]:
    """Ids of the active performer and its partner; without a partner, of the nearest visible performer."""
    project, performer_id = bench.document.project, bench.document.active_performer_id
    if performer_id is None:
        raise StudioError("Select a character first: a behaviour belongs to a character.")
    behaviour = project.behaviours.get(project.behaviour_of(performer_id) or "")
    role = behaviour.role_of(performer_id) if behaviour else None
    if role is not None and role.partner_id:
        return performer_id, role.partner_id
    x, y = project.performers[performer_id].position
    away = {
        key: (each.position[0] - x) ** 2 + (each.position[1] - y) ** 2
        for key, each in project.performers.items()
        if key != performer_id and each.visible
    }
    return performer_id, min(away, key=lambda key: away[key], default="")


def _make(bench: Workbench, text: str, ready: BehaviourChange) -> None:
    """Change the active performer's behaviour by ``ready``, or first create one from its first clip; one undo step."""
    document = bench.document
    performer_id, partner_id = _pair(bench)
    behaviour_id = document.project.behaviour_of(performer_id)
    with document.group(text):
        if behaviour_id is None:
            clips = document.project.performers[performer_id].clips
            if not clips:
                name = document.project.performers[performer_id].name
                raise StudioError(f"{name} has no clip yet. Add a clip first: it becomes the guard between strikes.")
            begun = ready_made.guard_behaviour(replace(clips[0], start=0.0))
            behaviour_id = add_behaviour(document, performer_id, begun, partner_id)
        elif partner_id:
            set_cast(document, performer_id, behaviour_id, partner_id)
        before = {each.name for each in document.project.behaviours[behaviour_id].states}
        edit_behaviour(document, behaviour_id, ready, text)
    behaviour = document.project.behaviours[behaviour_id]
    made = next((each.name for each in behaviour.states if each.name not in before), behaviour.start)
    show_behaviour(bench)
    document.selection.set(("performers", performer_id), ("states", state_key(behaviour_id, made)))
    bench.window.behaviour.diagram.fit()


def _with_motion(bench: Workbench, title: str, names: tuple[str, ...], make: Callable[[Clip], None]) -> None:
    """Call ``make`` with a clip of the only motion whose name has one of the words ``names``; if there is not exactly
    one, let the user choose.
    """
    project = bench.document.project
    _pair(bench)
    usable = {
        key: motion
        for key, motion in project.motions.items()
        if project.captures[motion.capture_id].body_map is not None
    }
    if not usable:
        raise StudioError("There is no capture yet. Drop one on the window first.")
    fitting = [key for key, motion in usable.items() if any(word in motion.name.lower() for word in names)]
    if len(fitting) == 1:
        make(_whole(project, fitting[0]))
        return
    ordered = sorted(usable, key=lambda key: key not in fitting)
    choices = [((usable[key].name, ""), partial(lambda key: make(_whole(project, key)), key)) for key in ordered]
    bench.window.choose(title, choices)


def _when_hit(bench: Workbench, clip: Clip) -> ActivationCurve:
    """Activation of a block: around the time at which the partner's strike hits, in seconds of the clip; the whole clip
    if no hit is found.
    """
    project = bench.document.project
    _, partner_id = _pair(bench)
    behaviour = project.behaviours.get(project.behaviour_of(partner_id) or "")
    blows = [each.clip for each in behaviour.states if each.event == ready_made.ATTACK_EVENT] if behaviour else []
    if not blows or blows[0] is None:
        return ACTIVE_WHOLE_CLIP
    blow = blows[0]
    capture = project.captures[project.motions[blow.motion_id].capture_id]
    rate, hit_frame = capture.frame_rate, farthest_reach_frame(capture, blow.first, blow.last)
    struck = float(blow.stage_seconds(hit_frame / rate, rate)) - blow.start
    hit = float(clip.motion_seconds(clip.start + struck, project.frame_rate_of(clip)))
    return ActivationCurve(
        hit - WARD_HOLD_SECONDS - WARD_EASE_SECONDS,
        hit - WARD_HOLD_SECONDS,
        hit + WARD_HOLD_SECONDS,
        hit + WARD_HOLD_SECONDS + WARD_EASE_SECONDS,
        EaseShape.SMOOTH,
    )


def _whole(project: Project, motion_id: str) -> Clip:
    """New clip of a motion, trimmed as an existing clip of it, else of full length."""
    for clip in project.clips.values():
        if clip.motion_id == motion_id:
            return replace(clip, start=0.0, repeats=1, id=new_id())
    capture = project.captures[project.motions[motion_id].capture_id]
    return Clip(motion_id, capture.first_frame, capture.frame_count - 1, id=new_id())
