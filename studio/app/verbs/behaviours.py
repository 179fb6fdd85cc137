"""Behaviours of the active body: the panel, and ready-made ones."""

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
WARD_EASE, WARD_HOLD = 0.2, 1 / 120
"""Seconds in which a warding arm comes and goes, and to each side of a hit in which it meets the fist."""
STRIKES = ("kick", "punch", "strike", "jab", "hook", "blow")
WARD_WORDS = ("ward", "block", "parry", "guard")

Ready = Callable[[Behaviour], Behaviour]


def show_behaviour(bench: Workbench) -> None:
    """Show the diagram of the active body's behaviour."""
    bench.window.show_dock("Behaviour")


def keep_distance(bench: Workbench) -> None:
    """Add keeping at striking distance of the partner."""
    _make(bench, "Keep striking distance", ready_made.with_distance_kept)


def add_ward_off(bench: Workbench) -> None:
    """Add a parry of attacks, with a motion of the project."""
    _with_motion(
        bench, "Block with clip", WARD_WORDS,
        lambda clip: _make(
            bench, "Block when attacked", lambda old: ready_made.with_parry(old, clip, _when_hit(bench, clip))
        ),
    )  # fmt: skip


def add_lean_away(bench: Workbench) -> None:
    """Add leaning away from the partner's fist."""
    _make(bench, "Lean away from the fist", ready_made.with_lean_away)


def add_strike(bench: Workbench) -> None:
    """Add a strike on a key, with a motion of the project."""
    _with_motion(
        bench, "Strike with clip", STRIKES,
        lambda clip: _make(bench, "Strike on key press", lambda old: ready_made.with_strike(old, clip, STRIKE_KEY)),
    )  # fmt: skip


READY_MADE: dict[str, tuple[str, str, Callable[[Workbench], None]]] = {
    "keep_distance": (
        "Keep striking distance", "Steps towards and away from its partner, and faces it", keep_distance,
    ),
    "ward_off": (
        "Block when attacked", "The forearm meets the fist of a partner that strikes", add_ward_off,
    ),
    "lean_away": (
        "Lean away from the fist", "The torso leans back while the partner's fist is near the head", add_lean_away,
    ),
    "strike_on_key": (
        "Strike on key press", f"During live play, {STRIKE_KEY} strikes and sends an event to the partner", add_strike,
    ),
}  # fmt: skip
"""By their id: text, tooltip, and what makes it."""


def _pair(bench: Workbench) -> tuple[str, str]:
    """Active body and its partner: the present one, else the nearest visible body."""
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


def _make(bench: Workbench, text: str, ready: Ready) -> None:
    """Add to the active body's behaviour, or make one with its first clip; one undo step."""
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
    """Use the only motion of the project with one of these names, or let the user choose."""
    project = bench.document.project
    _pair(bench)
    usable = {
        key: motion
        for key, motion in project.motions.items()
        if project.captures[motion.capture_id].body_map is not None
    }
    if not usable:
        raise StudioError("There is no motion yet. Drop a capture on the window first.")
    fitting = [key for key, motion in usable.items() if any(word in motion.name.lower() for word in names)]
    if len(fitting) == 1:
        make(_whole(project, fitting[0]))
        return
    ordered = sorted(usable, key=lambda key: key not in fitting)
    choices = [((usable[key].name, ""), partial(lambda key: make(_whole(project, key)), key)) for key in ordered]
    bench.window.choose(title, choices)


def _when_hit(bench: Workbench, clip: Clip) -> ActivationCurve:
    """Seconds, in the motion of a clip that begins with the partner's strike, at which the blow hits;
    else all of it.
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
        hit - WARD_HOLD - WARD_EASE, hit - WARD_HOLD, hit + WARD_HOLD, hit + WARD_HOLD + WARD_EASE, EaseShape.SMOOTH
    )


def _whole(project: Project, motion_id: str) -> Clip:
    """New clip of a motion, trimmed like one in a row, else whole."""
    for clip in project.clips.values():
        if clip.motion_id == motion_id:
            return replace(clip, start=0.0, repeats=1, id=new_id())
    capture = project.captures[project.motions[motion_id].capture_id]
    return Clip(motion_id, capture.first_frame, capture.frame_count - 1, id=new_id())
