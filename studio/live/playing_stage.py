"""Live stage: all performers solved a frame at a time, with the next clips decided during playback.

Only the clips are known in advance. The project may change at any step: targets, priorities, ground, bodies,
performers. In each step leaders are solved first, and performers who follow each other in iterations that start from
the result of the last step, so the cost of a step stays about the same.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from studio.core.constraints.base import Constraint
from studio.core.constraints.follow import FollowPerformer
from studio.core.constraints.target import follows_of
from studio.core.errors import StudioError
from studio.core.normalized.transition import LEAST_TRANSITION_SECONDS
from studio.core.rigs.played_fingers import fingers_of_performer
from studio.core.solver.adapt import body_point_positions, solve_constraints, solve_request
from studio.core.solver.performers.anticipated_targets import anticipated_time, with_expected_positions
from studio.core.solver.performers.dependency_cycles import CycleMember, Paths, paths_of, solve_cycle
from studio.core.solver.performers.rows import corrections_in
from studio.core.solver.performers.stage import leaders_first, props_of, tracks_followed_by, tracks_of
from studio.core.solver.performers.staged_performances import PrepareCapture
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.core.solver.task_assembly.tracks import Track, Tracks
from studio.core.stage.behaviour import BehaviourProgress, advanced_progress, initial_progress
from studio.core.stage.clip import Clip
from studio.core.stage.conditions import ConditionInput
from studio.core.stage.placement import Placement
from studio.core.stage.project import Performer, Project
from studio.live.distance_keeping import distance_step
from studio.live.live_behaviour import StageView, StartedAct, condition_input, started_act
from studio.live.playing import PlayingMotion, motion_after_takeover, row_motion, with_constraints_of, with_grounding_of
from studio.live.recorded_take import StageTake, StartedClips

Expected = dict[FollowPerformer, NDArray[np.float64]]

MAX_SWEEPS, MAX_FIRST_SWEEPS = 4, 6
"""Maximum number of iterations per step for performers that follow each other, and in their first step."""
SOON_SECONDS = 1.0 / 60.0
"""Seconds per performer before the end of a clip from which the next clip may begin."""
SETTLED_SECONDS = 0.1
"""Seconds that a clip must have played since its takeover before another one may take over."""
MAX_CLIPS_PER_STEP = 1
"""Maximum number of clips begun in one step by all performers together; the others begin in later steps."""


@dataclass
class _Part:
    """Playback state of one performer."""

    playing: PlayingMotion
    row: tuple[Clip, ...]
    """The project's row and layers when it began; if they change, the row begins again."""
    frame: int = 0
    act: StartedAct | None = None
    """Act that took over; None while its own row plays."""
    wish: StartedAct | None = None
    begun: StartedClips | None = None
    tracks: Tracks = field(default_factory=dict)
    result: AdaptedMotion | None = None
    passed: Mapping[float, AdaptedMotion] = field(default_factory=dict)
    """Frames solved when the performer took or released a prop, by seconds of the stage."""


class LiveStage:
    """Live play of a project: call ``step`` for each frame; ``project`` may be replaced before any step, ``start``
    begins a clip.

    ``results`` has one frame of each performer, in the space of its motion, and ``failures`` the reasons why others
    have none. A behaviour controls its performers; ``send`` and ``press`` pass events and keys to behaviours.
    """

    def __init__(self, project: Project, prepare: PrepareCapture, seconds: float = 0.0) -> None:
        """Begin all performers with their own rows, as the timeline has them at ``seconds`` of the stage."""
        self.seconds = seconds
        self.results: dict[str, AdaptedMotion] = {}
        self.failures: dict[str, str] = {}
        self._prepare = prepare
        self._parts: dict[str, _Part] = {}
        self._paths: dict[tuple[str, ...], tuple[Paths, Paths]] = {}
        self.running: dict[str, BehaviourProgress] = {}
        """State of the behaviour of each performer that has one."""
        self._events: dict[str, frozenset[str]] = {}
        self._sent: frozenset[str] = frozenset()
        self._keys: frozenset[str] = frozenset()
        self.project = self._seen = self._staged = project
        self._step = 0.0
        self._recorded: list[tuple[str, StartedClips]] | None = None
        self._given: list[tuple[float, Project]] = []
        self._recorded_from = 0.0

    @property
    def staged(self) -> Project:
        """Project in which each performer's track is what it currently plays; ``results`` refer to it."""
        return self._staged

    def playing_clip(self, key: str) -> Clip | None:
        """Clip that a performer currently plays; None before its first step."""
        part = self._parts.get(key)
        return None if part is None else _clip_of(part)

    def active_constraints(self, key: str) -> tuple[tuple[str, Constraint, float], ...]:
        """Id, constraint and activation of each constraint of a performer in this step, in the order of its result's
        residuals.

        The id is that in ``staged``; empty for a constraint of the previous motion that fades out.
        """
        playing, frame = self._parts[key].playing, self._parts[key].frame
        time, names = playing.time_of(frame), {id(each): name for name, each in playing.asked}
        return tuple((names.get(id(each), ""), each, float(each.activation.at(time))) for each in playing.active(frame))

    def start(self, key: str, clip: Clip, blend: float = 0.0) -> None:
        """Let a performer change to a clip from its current pose, blended in ``blend`` seconds; 0 chooses the time that
        it needs.
        """
        if key in self._parts:
            self._parts[key].wish = StartedAct(replace(clip, ease=blend, joined=True))

    def send(self, event: str) -> None:
        """Send an event to all behaviours, for the next step."""
        self._sent |= {event}

    def press(self, key: str) -> None:
        """Send a pressed key to all behaviours, for the next step."""
        self._keys |= {key}

    def record(self) -> None:
        """Start a recording of what is played, which ``recorded`` returns."""
        self._recorded_from, self._given = self.seconds, [(self.seconds, self.project)]
        self._recorded = [(key, part.begun) for key, part in self._parts.items() if part.begun is not None]

    def recorded(self) -> StageTake | None:
        """End the recording and return what was played since ``record``; None without a recording."""
        recorded, self._recorded = self._recorded, None
        if recorded is None:
            return None
        return StageTake(self._recorded_from, self.seconds, tuple(recorded), tuple(self._given))

    def step(self, dt: float) -> Mapping[str, AdaptedMotion]:
        """Advance by ``dt`` seconds and return one frame of every visible performer, by its id."""
        self.seconds, self._step = self.seconds + dt, dt
        self.failures.clear()
        self._take_project()
        self._advance_behaviours()
        self._begin_takeovers()
        for part in self._parts.values():
            part.frame = part.playing.frame_at(self.seconds)
        solved: dict[str, AdaptedMotion] = {}
        for followed in leaders_first(self._staged, self._parts):
            circle = tuple(key for key in followed if key in self._parts)  # one that is hidden does not play
            try:
                solved |= self._solved(circle, solved)
            except StudioError as error:
                self.failures |= dict.fromkeys(circle, str(error))
        for key, result in solved.items():
            self._parts[key].result = result
        self._remember_hands(solved)
        self.results = solved
        return solved

    def _remember_hands(self, results: Mapping[str, AdaptedMotion]) -> None:
        """Store the frames in which performers took or released a prop: the clips that play then are not kept."""
        for held in (held for prop in self.project.props.values() for held in prop.holds):
            part, result = self._parts.get(held.performer_id), results.get(held.performer_id)
            for moment in (held.begin, held.end):
                if moment is not None and part and result and moment <= self.seconds and moment not in part.passed:
                    part.passed = {**part.passed, moment: replace(result, passed_constraints={})}

    # What plays

    def _take_project(self) -> None:
        """Update the playback to the current project."""
        given, seen = self.project, self._seen
        players = {key: each for key, each in given.performers.items() if _plays(given, each)}
        for key, part in list(self._parts.items()):
            if key not in players:
                del self._parts[key]
            elif part.wish and part.wish.clip.motion_id not in given.motions:
                part.wish = None
        if given is seen and players.keys() == self._parts.keys():
            return
        if self._recorded is not None:
            self._given.append((self.seconds, given))
        self._seen, self._staged = given, _staged(given, self._parts)
        for key, performer in players.items():
            try:
                if key in self._parts and self._is_lost(key):
                    self._begin_row(key)
                self._take_performer(key, performer, seen)
            except StudioError as error:
                self._parts.pop(key, None)
                self.failures[key] = str(error)

    def _take_performer(self, key: str, performer: Performer, seen: Project) -> None:
        part, given = self._parts.get(key), self._staged
        before = seen.performers.get(key)
        if part is None or (part.act is None and part.row != performer.all_clips):
            self._parts[key] = _Part(row_motion(given, key, self._prepare), performer.all_clips)
            self._note(key)
        elif before is None or _stands_otherwise(self.project, seen, key):
            part.playing, part.row = with_grounding_of(given, key, part.playing, self._prepare), performer.all_clips
        else:
            part.playing, part.row = with_constraints_of(given, key, part.playing), performer.all_clips

    def _is_lost(self, key: str) -> bool:
        """True if the motion or clip that a performer plays was removed from the project."""
        part, given = self._parts[key], self.project
        clip = _clip_of(part)
        return clip.motion_id not in given.motions or (
            part.act is None and clip.id not in {each.id for each in given.performers[key].clips}
        )

    def _begin_row(self, key: str) -> None:
        """Begin the first clip of a performer's row from its current pose, or restart the row if that clip is too
        short.
        """
        part = self._parts[key]
        part.row = self.project.performers[key].all_clips
        act = self._first_of_row(part)
        if act is None or part.result is None:
            del self._parts[key]
            self._staged = _staged(self.project, self._parts)
        else:
            self._begin(key, act)

    def _advance_behaviours(self) -> None:
        """Advance the behaviours: a performer that enters another state requests its act, others request a step if they
        need one.
        """
        events, self._events = self._events, {}
        sent, keys, self._sent, self._keys = self._sent, self._keys, frozenset(), frozenset()
        seen = StageView(self.project, self.results, dict(self.running), self.seconds)
        for key, part in self._parts.items():
            behaviour = self.project.behaviours.get(self.project.behaviour_of(key) or "")
            role = behaviour.role_of(key) if behaviour else None
            if behaviour is None or role is None:
                self.running.pop(key, None)
                continue
            before, after = self.running.get(key), initial_progress(behaviour)
            if before is not None:
                ends = part.wish is None and self._ends(part)
                heard = ConditionInput(self._step, {}, ends, events.get(key, frozenset()) | sent, keys)
                after = advanced_progress(behaviour, before, condition_input(seen, behaviour, role, heard))
            self.running[key] = after
            state = behaviour.state(after.state)
            if state is not None and (before is None or after.seconds == 0.0):
                clip = _clip_of(part)
                frame = round(_motion_frame(part))
                blend = after.through.blend if after.through else 0.0
                part.wish = started_act(state, role, blend, clip, frame, self.project.frame_rate_of(clip))
                if state.event and role.partner_id:
                    self._events[role.partner_id] = self._events.get(role.partner_id, frozenset()) | {state.event}
            elif part.wish is None and part.act is not None:
                part.wish = distance_step(seen, key, part.act, part.playing.composite, part.frame)

    def _ends(self, part: _Part) -> bool:
        """True if the motion of a performer is about to end; one step per performer is reserved to begin the next
        clips.
        """
        return part.playing.composite.timing.end - self.seconds < min(self._step, SOON_SECONDS) * len(self._parts)

    def _settled(self, part: _Part) -> bool:
        """True if the last takeover has played for ``SETTLED_SECONDS`` seconds: clips that begin sooner each keep the
        velocity that they find, and carry the body away.
        """
        return part.act is None or self.seconds - part.act.clip.start > SETTLED_SECONDS

    def _next(self, key: str, part: _Part) -> StartedAct | None:
        """Act that follows without a request: the looped clip of a state, or the first clip of a row. None if the last
        pose is held, or the clip is too short for a transition.
        """
        behaviour = self.project.behaviours.get(self.project.behaviour_of(key) or "")
        state = behaviour.state(self.running[key].state) if behaviour and key in self.running else None
        if state is None:
            return self._first_of_row(part)
        if part.act is None or state.clip is None or not state.loop:
            return None
        return self._going_on(replace(part.act, clip=replace(state.clip, ease=part.act.clip.ease), steps=False))

    def _first_of_row(self, part: _Part) -> StartedAct | None:
        return self._going_on(StartedAct(part.row[0]))

    def _going_on(self, act: StartedAct) -> StartedAct | None:
        """Act with its clip begun from the current pose; None if the clip is too short for a transition."""
        if act.clip.length(self.project.frame_rate_of(act.clip)) < LEAST_TRANSITION_SECONDS:
            return None
        return replace(act, clip=replace(act.clip, joined=True, turn=0.0, offset=(0.0, 0.0)))

    def _begin_takeovers(self) -> None:
        """Let clips take over that were requested, or that follow a motion which is about to end."""
        waiting = []
        for key, part in self._parts.items():
            if part.result is not None and part.wish is None and self._ends(part):
                part.wish = self._next(key, part)
            if part.result is not None and part.wish is not None and self._settled(part):
                waiting.append(key)
        for key in waiting[:MAX_CLIPS_PER_STEP]:
            wish, self._parts[key].wish = self._parts[key].wish, None
            assert wish is not None
            self._begin(key, wish)

    def _begin(self, key: str, act: StartedAct) -> None:
        """Let ``act`` take over now."""
        part, act = self._parts[key], replace(act, clip=replace(act.clip, start=self.seconds))
        staged = _staged(self.project, self._parts, {key: act})
        before, frame = part.playing, part.frame
        fingers = fingers_of_performer(self._staged, key, before.composite, np.array([frame]))
        playing = motion_after_takeover(staged, key, before, frame, part.tracks, self._prepare)
        part.playing = replace(playing, composite=replace(playing.composite, fingers_before=fingers))
        part.act, self._staged = act, staged
        self._note(key)

    def _note(self, key: str) -> None:
        """Store the act that a performer has just begun, and add it to the recording."""
        part = self._parts[key]
        composite, act = part.playing.composite, part.act
        if act is None:
            part.begun = StartedClips(self.seconds, part.row, composite.played, composite.timing, own=True)
        else:
            part.begun = StartedClips(self.seconds, (act.clip,), composite.played[1:], composite.timing, act.asked)
        if self._recorded is not None:
            self._recorded.append((key, part.begun))

    # Where they are

    def _solved(self, circle: tuple[str, ...], solved: Mapping[str, AdaptedMotion]) -> dict[str, AdaptedMotion]:
        """One frame of performers that follow each other, usually of a single one, solved after all that they
        follow.
        """
        awaited = {key: self._awaited(key) for key in circle}  # before the tracks of the last step are replaced
        players = {key: self._player(key, circle, solved, awaited[key]) for key in circle}
        unasked = dict(paths_of(players, {key: self._unasked(key) for key in circle})) if len(circle) > 1 else {}
        if not unasked:
            self._paths.pop(circle, None)
            return {key: self._frame(key, each.request) for key, each in players.items()}
        expected = self._expected(circle, unasked)
        found = solve_cycle(players, self._frame, expected, MAX_SWEEPS if expected else MAX_FIRST_SWEEPS)
        self._paths[circle] = found.paths, unasked
        for key, request in found.requests.items():
            self._parts[key].tracks = request.tracks
        return dict(found.results)

    def _player(
        self, key: str, circle: tuple[str, ...], solved: Mapping[str, AdaptedMotion], expected: Expected
    ) -> CycleMember:
        part = self._parts[key]
        playing, frame = part.playing, part.frame
        constraints = playing.active(frame)
        holds = any(key in each.holders for each in props_of(self._staged, key))
        own = self._unasked(key) if holds else None
        followed = tracks_followed_by(self._staged, key, solved.get, circle, constraints, own)
        if followed is None:
            name = self._staged.performers[key].name
            raise StudioError(f"'{name}' follows a character that cannot be adapted. Choose another target.")
        part.tracks = with_expected_positions(tracks_of(followed, playing.composite.at(frame)), expected)
        standing = playing.standing
        request = AdaptRequest(
            standing.motion,
            standing.morphology,
            standing.contacts,
            constraints,
            standing.ground,
            part.tracks,
            corrections=corrections_in(self._staged, key, playing.composite.timing),
        )
        placement = Placement.of(self._staged.performers[key])
        return CycleMember(request, playing.composite, placement, self._staged.props, frame, expected)

    def _awaited(self, key: str) -> Expected:
        """Predicted positions (3,), in the motion's space, of the points that a performer anticipates, by the motions
        and constraints of now.
        """
        part, found = self._parts[key], Expected()
        time = part.playing.time_of(part.frame)
        for constraint in part.playing.active(part.frame):
            moment = anticipated_time(constraint.activation, time)
            for follow in follows_of(constraint):
                if moment is not None and isinstance(follow, FollowPerformer) and follow.awaits:
                    place = self._place_at(follow, part.playing.composite.timing.begin + moment)
                    if place is not None:
                        found[follow] = Placement.of(self._staged.performers[key]).to_motion(place)
        return found

    def _place_at(self, follow: FollowPerformer, seconds: float) -> NDArray[np.float64] | None:
        """Stage position (3,) of a followed point at ``seconds``; None if its performer does not play."""
        part = self._parts.get(follow.performer_id)
        if part is None or part.result is None:
            return None
        frame = part.playing.frame_at(seconds)
        asked = [each for each in part.playing.active(frame) if part.tracks.keys() >= {*follows_of(each)}]
        then = solve_constraints(part.playing.solvable, asked, frame, frame, part.tracks)
        return np.asarray(
            Placement.of(self._staged.performers[follow.performer_id]).to_stage(
                body_point_positions(follow.point, then)[0]
            )
        )

    def _frame(self, key: str, request: AdaptRequest) -> AdaptedMotion:
        part = self._parts[key]
        posed = solve_request(part.playing.solvable, request, part.frame, part.frame)
        return replace(posed, composite=part.playing.composite, passed_constraints=part.passed)

    def _unasked(self, key: str) -> AdaptedMotion:
        part = self._parts[key]
        posed = solve_constraints(part.playing.standing, (), part.frame, part.frame)
        return replace(posed, composite=part.playing.composite, passed_constraints=part.passed)

    def _expected(self, circle: tuple[str, ...], unasked: Paths) -> Paths:
        """Expected tracks of all followed points: unconstrained ones, displaced as much as in the last step."""
        known, last = self._paths.get(circle, ({}, {}))
        expected = dict(unasked) if known else {}
        for name in expected.keys() & known.keys() & last.keys():
            places = unasked[name].positions + known[name].positions - last[name].positions
            expected[name] = Track(places, known[name].rotations)
        return expected


def _plays(project: Project, performer: Performer) -> bool:
    return bool(performer.visible and performer.clips and not project.missing_references(performer))


def _clip_of(part: _Part) -> Clip:
    place = part.playing.composite.piece_at(part.frame).piece.origin[0]
    return part.act.clip if part.act else part.row[place]


def _motion_frame(part: _Part) -> float:
    """Frame of its motion that a performer plays, as a fractional number."""
    composite = part.playing.composite
    return float(composite.piece_at(part.frame).motion_frames(np.array([part.frame]), composite.timing)[0])


def _staged(
    project: Project, parts: Mapping[str, _Part], begun: Mapping[str, StartedAct] = MappingProxyType({})
) -> Project:
    """``project`` in which the rows of performers are the clips that took over, and those of the acts in ``begun``."""
    acts = {key: part.act for key, part in parts.items() if part.act is not None} | dict(begun)
    rows = [(key, replace(project.performers[key], clips=(act.clip,), layers=()), None) for key, act in acts.items()]
    corrected = [(each, None, None) for key in acts for each in project.corrections_of(key)]
    asked = [(f"{key} {each.name}", each, None) for key, act in acts.items() for each in act.asked]
    staged = project.with_entities("performers", rows).with_entities("corrections", corrected)
    return staged.with_entities("constraints", asked) if asked else staged


def _stands_otherwise(project: Project, before: Project, key: str) -> bool:
    """True if the body, ground, placement, options or corrections of a performer changed, and so its unconstrained
    pose.
    """
    performer, was = project.performers[key], before.performers[key]
    bodies = [given.characters[each.character_id] for given, each in ((project, performer), (before, was))]
    manners = [(each.position, each.heading, each.limited, each.clears) for each in (performer, was)]
    corrections = [given.corrections_of(key) for given in (project, before)]
    return (
        bodies[0] is not bodies[1]
        or project.ground is not before.ground
        or manners[0] != manners[1]
        or corrections[0] != corrections[1]
    )
