"""Insertion of a strike into a project. A trial solves the project with the strike before the user chooses it."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from studio.core.body.morphology import Morphology
from studio.core.body.pose import PoseSequence
from studio.core.body.skeleton import Skeleton
from studio.core.captures.capture import Capture
from studio.core.constraints.follow import Follow
from studio.core.constraints.target import Place
from studio.core.mesh.hand_shapes import FIST_GRIP
from studio.core.normalized.compose import Composite
from studio.core.normalized.motion import NormalizedMotion
from studio.core.normalized.normalize import normalize_capture
from studio.core.solver.adapt import grounded_motion, solve_request
from studio.core.solver.grounding.grounded_motion import grounded_motion_of
from studio.core.solver.performers.rows import composite_of
from studio.core.solver.performers.stage import constraints_of_performer
from studio.core.solver.performers.staged_performances import PrepareCapture, motion_of, player_of
from studio.core.solver.request import AdaptedMotion
from studio.core.stage.clip import Clip
from studio.core.stage.clip_row import clips_until, copies_for_parts
from studio.core.stage.placement import Placement
from studio.core.stage.project import Motion, Project
from studio.library.catalogue import LibraryTake
from studio.library.clip_labels import Kind
from studio.library.searching import Result
from studio.library.striking import BLEND_IN_FRACTION, aimed_constraint

FloatArray = NDArray[np.float64]
TRIED_STRIKE_ID = "tried strike"
"""Id of the capture, motion, clip and constraint of a strike during a trial."""


@dataclass(frozen=True, eq=False)
class StrikeScene:
    """Project in which a performer is to strike ``target`` from stage second ``time`` on.

    ``target`` is followed by the strike until it hits, or a fixed position (3,) on the stage.
    """

    project: Project
    performer_id: str
    time: float
    target: Follow | FloatArray
    results: Mapping[str, AdaptedMotion] = field(default_factory=dict)
    """Present adapted motions by performer id; a trial takes those of the other performers as they are."""
    motions_by_path: Mapping[str, str] = field(default_factory=dict)
    """Motion ids of the project by the path of their file; a strike from such a file plays that motion."""

    def solved_residual(self, found: Result) -> float:
        """Residual in metres of a strike at its hit after it is inserted and solved; infinite if it is not
        active then.
        """
        take, key = found.clip.take, self.performer_id
        motion_id = self.motions_by_path.get(take.path, TRIED_STRIKE_ID)
        project = self.project if motion_id != TRIED_STRIKE_ID else _with_take(self.project, take)

        def prepare(capture: Capture) -> tuple[NormalizedMotion, Morphology]:
            if capture is project.captures.get(TRIED_STRIKE_ID):
                return take.motion, found.clip.actor.body
            return _prepared(capture)

        made = inserted_strike(
            replace(self, project=project), found, motion_id, TRIED_STRIKE_ID, TRIED_STRIKE_ID, prepare
        )
        player = player_of(made, key, (key,), prepare, self.results.get)
        timing, request = player.composite.timing, player.request
        hit = min(round((self.time + found.seconds_to_hit - timing.begin) * timing.frame_rate), timing.last)
        standing = grounded_motion(request, grounded_motion_of(request, [slice(hit, hit + 1)]))
        adapted = solve_request(standing, request, hit, hit)
        row = [each.constraint_id for each in constraints_of_performer(made, key)].index(TRIED_STRIKE_ID)
        residual = float(adapted.residuals[row, 0])
        return residual if math.isfinite(residual) else math.inf


def _prepared(capture: Capture) -> tuple[NormalizedMotion, Morphology]:
    """Normalised motion of a capture, and the morphology of its actor."""
    motion, actor = normalize_capture(capture)
    return motion, actor.morphology


def inserted_strike(
    scene: StrikeScene,
    found: Result,
    motion_id: str,
    clip_id: str,
    constraint_id: str,
    prepare: PrepareCapture = _prepared,
) -> Project:
    """Project of ``scene`` in which the performer plays a strike, driven to the target, as the clip ``clip_id``.

    ``motion_id`` is the id in the project of the strike's motion.
    """
    project, key, label = scene.project, scene.performer_id, found.clip.label
    before = project.performers[key]
    kept = clips_until(before, scene.time, {each.motion_id: project.frame_rate_of(each) for each in before.clips})
    for collection, copies in copies_for_parts(project, before, kept).items():
        project = project.with_entities(collection, ((each, entity, None) for each, entity in copies.items()))
    grip = FIST_GRIP if label.kind is Kind.PUNCH else None
    ease = BLEND_IN_FRACTION * found.seconds_to_hit
    clip = Clip(motion_id, found.start, label.last, scene.time, clip_id, ease=ease, grip=grip)
    project = project.with_entity("performers", key, replace(before, clips=(*kept, clip)))
    target: Place
    if isinstance(scene.target, np.ndarray):
        row = composite_of(project, key, lambda each: motion_of(project, each, prepare))
        x, y, z = _space_of_last_clip(project, key, row).to_motion(scene.target).tolist()
        target = (x, y, z)
    else:
        target = scene.target
    body = project.characters[before.character_id].morphology
    return project.with_entity("constraints", constraint_id, aimed_constraint(found, clip, target, body))


def _space_of_last_clip(project: Project, performer_id: str, row: Composite) -> Placement:
    """Placement on the stage of the motion space of the last clip in a performer's ``row``."""
    performer = project.performers[performer_id]
    body = project.characters[performer.character_id].morphology
    placement = row.played[-1].placement
    x, y = placement.offset
    return Placement.of(performer).compose(Placement((body.leg_length * x, body.leg_length * y), placement.turn))


def _with_take(project: Project, take: LibraryTake) -> Project:
    """Project with the motion and contacts of ``take``, and a capture without a skeleton in place of its file."""
    motion, joint = take.motion, np.array([[0.0, 0.0, 0.0, 1.0]])
    still = np.tile(joint, (motion.frame_count, 1, 1)), np.zeros((motion.frame_count, 1, 3))
    skeleton = Skeleton(("root",), np.array([-1]), np.zeros((1, 3)), np.array([False]))
    capture = Capture(
        motion.name, "", skeleton, PoseSequence(*still), motion.frame_rate, None, joint, 0.0, "m", "Z", 0, (), ()
    )
    contacts = (
        (f"{TRIED_STRIKE_ID} {index}", replace(each, motion_id=TRIED_STRIKE_ID), None)
        for index, each in enumerate(take.contacts)
    )
    project = project.with_entity("captures", TRIED_STRIKE_ID, capture)
    return project.with_entity("motions", TRIED_STRIKE_ID, Motion(motion.name, TRIED_STRIKE_ID)).with_entities(
        "contacts", contacts
    )
