"""Inputs of the solve of one performer: the key by which results are compared, and the solver's request."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace

from studio.core.body.morphology import AnyMorphology, Morphology
from studio.core.captures.capture import Capture
from studio.core.captures.contacts import ContactInterval, Touch
from studio.core.constraints.clear import ClearConstraint
from studio.core.grounds.ground import Ground
from studio.core.mesh.skin import SkinnedMesh
from studio.core.mesh.volume import fitted_volume
from studio.core.normalized.motion import NormalizedMotion
from studio.core.solver.performers.anticipated_targets import with_anticipated_targets
from studio.core.solver.performers.dependency_cycles import CycleMember
from studio.core.solver.performers.rows import (
    ClipConstraint,
    composite_of,
    constraints_in,
    corrections_in,
    frame_count_of,
    is_plain,
    timing_of,
)
from studio.core.solver.performers.stage import (
    Followed,
    constraints_of_performer,
    props_of,
    tracks_followed_by,
    tracks_of,
)
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.core.stage.clip import Clip
from studio.core.stage.correction import Correction
from studio.core.stage.layer import Layer
from studio.core.stage.placement import Placement
from studio.core.stage.project import Performer, Project
from studio.core.stage.prop import Prop

Prepare = Callable[[Capture], tuple[NormalizedMotion, Morphology]]
ResultOf = Callable[[str], AdaptedMotion | None]
Skin = tuple[SkinnedMesh, Morphology, Morphology]
"""Skin mesh, the morphology to which it is bound, and the morphology to which it is fitted."""


@dataclass(frozen=True)
class BodyRequest:
    """Inputs on which the solve of one performer depends: if two are equal, no new solve is needed."""

    performer: Performer = field(compare=False)
    motions: tuple[tuple[int, Clip, tuple[ContactInterval, ...]], ...]
    """Identity of the capture, clip and contacts of each clip of the track, then of the layers."""
    morphology: AnyMorphology
    constraints: tuple[ClipConstraint, ...]
    ground: Ground
    followed: tuple[Followed, ...]
    placement: Placement
    skin: Skin | None = None
    """Skin from which the body's volume is measured; None if no constraint needs it."""
    limited: bool = True
    eased: bool = True
    clears: bool = True
    layers: tuple[Layer, ...] = ()
    props: tuple[Prop, ...] = ()
    corrections: tuple[Correction, ...] = ()
    """Correction layers, in seconds of the composite motion of the track."""

    def has_same_grounding(self, other: "BodyRequest | None") -> bool:
        """True if both requests have the same grounded motion."""
        mine = self.motions, self.layers, self.morphology, self.ground, self.skin, self.limited, self.clears
        return other is not None and mine == (
            other.motions, other.layers, other.morphology, other.ground, other.skin, other.limited, other.clears
        )  # fmt: skip


def body_request_of(project: Project, key: str, cycle: tuple[str, ...], result_of: ResultOf) -> BodyRequest | None:
    """Inputs of the solve of a performer; None while a performer that it follows has no result."""
    performer = project.performers[key]
    character = project.characters[performer.character_id]
    followed = tracks_followed_by(project, key, result_of, cycle)
    if followed is None:
        return None
    asked = constraints_of_performer(project, key)
    captures = [project.captures[project.motions[clip.motion_id].capture_id] for clip in performer.all_clips]
    alone = len(captures) == 1 and is_plain(performer.clips[0])  # then it is all the same when it begins
    clips = [replace(clip, start=0.0, first=0) if alone else clip for clip in performer.all_clips]
    stand = [tuple(project.contacts_for(key, clip).values()) for clip in performer.all_clips]
    motions = tuple(zip(map(id, captures), clips, stand, strict=True))
    touches = any(isinstance(contact.point, Touch) for _, _, contacts in motions for contact in contacts)
    clears = performer.clears or any(isinstance(each.constraint, ClearConstraint) for each in asked)
    ground = project.ground.seen_from(performer.position, performer.heading)
    skin = (character.skin, character.build, character.morphology) if clears or touches else None
    timing = timing_of(project, performer)
    body = character.body_over(timing.begin, timing.frame_rate, frame_count_of(project, performer))
    return BodyRequest(
        performer, motions, body, asked, ground, followed, Placement.of(performer), skin,
        performer.limited, performer.eased, performer.clears, performer.layers, props_of(project, key),
        corrections_in(project, key, timing),
    )  # fmt: skip


def player_of(project: Project, key: str, wanted: BodyRequest, prepare: Prepare) -> CycleMember:
    """Performer with its solver request, for a worker thread, since it may normalise captures."""

    def prepared(motion_id: str) -> tuple[NormalizedMotion, Morphology]:
        return prepare(project.captures[project.motions[motion_id].capture_id])

    composite = composite_of(project, key, lambda motion_id: prepared(motion_id)[0])
    actor = prepared(wanted.performer.clips[0].motion_id)[1]
    constraints = constraints_in(wanted.constraints, composite, wanted.morphology.leg_length)
    tracks = with_anticipated_targets(tracks_of(wanted.followed, composite), constraints, composite.timing.frame_rate)
    volume = None if wanted.skin is None else fitted_volume(*wanted.skin)
    request = AdaptRequest(
        composite.motion, wanted.morphology, composite.contacts, constraints, wanted.ground, tracks, volume,
        actor, wanted.limited, wanted.eased, wanted.clears, wanted.corrections,
    )  # fmt: skip
    return CycleMember(request, composite, wanted.placement, project.props)
