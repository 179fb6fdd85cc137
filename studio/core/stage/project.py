"""The project: all of the user's work, as one immutable value of entities by id.

A document holds one Project and replaces entities in it; a file stores one. Ids are short random strings; entities
refer to each other by id, and an entity never changes in place.
"""

import math
import secrets
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from types import MappingProxyType
from typing import Any, Self

from studio.core.captures.annotations import Label
from studio.core.captures.capture import Capture
from studio.core.captures.contacts import ContactInterval, ContactPoint, Touch
from studio.core.constraints.base import Constraint
from studio.core.constraints.follow import Follow, FollowPerformer, FollowProp
from studio.core.constraints.scope import Scope, in_scope_of, narrowest_scoped
from studio.core.constraints.target import follows_of
from studio.core.curves.tangents import LEFT_OUT_IF_DEFAULT
from studio.core.grounds.ground import Ground
from studio.core.mesh.character import Character
from studio.core.plausible import PLACE_RANGE, TURN_RANGE
from studio.core.stage.behaviour import Behaviour, State, Transition
from studio.core.stage.clip import Clip
from studio.core.stage.correction import Correction
from studio.core.stage.footage import Footage
from studio.core.stage.layer import Layer
from studio.core.stage.prop import Prop
from studio.core.stage.saved_camera import SavedCamera
from studio.core.stage.sound_track import SoundTrack

GROUND_ID = "ground"
_SORTED = "_contacts_by_motion"
"""Name of the cached property that a changed project takes over if its contacts are unchanged."""


def new_id() -> str:
    """Unique id of 12 hexadecimal digits."""
    return new_ids(1)[0]


def new_ids(count: int) -> list[str]:
    """``count`` unique ids."""
    digits = secrets.token_hex(6 * count)
    return [digits[start : start + 12] for start in range(0, len(digits), 12)]


@dataclass(frozen=True)
class Motion:
    """Capture as a motion that any body can perform; contacts and constraints refer to it by id."""

    name: str
    capture_id: str
    tags: tuple[str, ...] = field(default=(), metadata=LEFT_OUT_IF_DEFAULT)
    """Words that the user gave it to find it in the library."""


@dataclass(frozen=True)
class Performer:
    """Character that plays clips at ``position`` (metres) on the stage, rotated by ``heading`` (radians)."""

    name: str
    character_id: str
    clips: tuple[Clip, ...] = ()
    """Row of clips that the performer plays, one after the other."""
    position: tuple[float, float] = (0.0, 0.0)
    heading: float = 0.0
    visible: bool = True
    limited: bool = True
    """True if constraints move shoulders, elbows, wrists, hips, knees and ankles only within the human range."""
    eased: bool = True
    """True if acceleration peaks of joints are smoothed in time, at the cost of exactness."""
    clears: bool = True
    """True if the arms stay out of the performer's own body wherever the actor's arms do."""
    layers: tuple[Layer, ...] = ()
    """Layers of motion on parts of the body, over the clips; later ones lie over earlier ones."""

    def __post_init__(self) -> None:
        if not all(math.isfinite(number) for number in (*self.position, self.heading)):
            raise ValueError(f"'{self.name}': the position on the stage needs finite numbers.")
        PLACE_RANGE.check(self.position)
        TURN_RANGE.check(self.heading)

    @property
    def all_clips(self) -> tuple[Clip, ...]:
        """Clips of its row, then those of its layers."""
        return (*self.clips, *(layer.clip for layer in self.layers))


Entity = (
    Capture
    | Motion
    | Character
    | Performer
    | Constraint
    | ContactInterval
    | Label
    | Ground
    | Prop
    | Behaviour
    | SavedCamera
    | SoundTrack
    | Footage
    | Correction
)

COLLECTIONS = (
    "captures",
    "motions",
    "characters",
    "performers",
    "constraints",
    "contacts",
    "labels",
    "grounds",
    "props",
    "behaviours",
    "cameras",
    "sounds",
    "footage",
    "corrections",
)
"""Names of the collections of entities in a project."""


COLLECTION_CLASSES: Mapping[str, type] = MappingProxyType(
    {
        "captures": Capture,
        "motions": Motion,
        "characters": Character,
        "performers": Performer,
        "constraints": Constraint,
        "contacts": ContactInterval,
        "labels": Label,
        "grounds": Ground,
        "props": Prop,
        "behaviours": Behaviour,
        "cameras": SavedCamera,
        "sounds": SoundTrack,
        "footage": Footage,
        "corrections": Correction,
    }
)
"""Class of the entities of each collection, by the name of the collection."""


def _frozen(entities: Mapping[str, Any]) -> Mapping[str, Any]:
    return entities if isinstance(entities, MappingProxyType) else MappingProxyType(dict(entities))


def references(entity: Entity) -> tuple[tuple[str, str], ...]:
    """(collection, id) of every entity on which ``entity`` depends."""
    match entity:
        case Motion():
            return (("captures", entity.capture_id),)
        case Performer():
            return (
                ("characters", entity.character_id),
                *(("motions", clip.motion_id) for clip in entity.all_clips),
            )
        case ContactInterval():
            return (("motions", entity.motion_id), *_scoped(entity.scope))
        case Constraint():
            followed = (pair for each in follows_of(entity) for pair in _followed(each))
            return (("motions", entity.motion_id), *_scoped(entity.scope), *followed)
        case Label():
            return (("motions", entity.motion_id),)
        case Correction():
            return (("performers", entity.performer_id),)
        case Prop():
            return tuple(("performers", each.performer_id) for each in entity.holds)
        case Behaviour():
            return entity.references
    return ()


def _scoped(scope: Scope) -> tuple[tuple[str, str], ...]:
    return (("performers", scope.performer_id),) if scope.performer_id else ()


def _followed(follow: Follow) -> tuple[tuple[str, str], ...]:
    match follow:
        case FollowPerformer():
            return (("performers", follow.performer_id),)
        case FollowProp():
            return (("props", follow.prop_id),)
    return ()


@dataclass(frozen=True)
class Project:
    """All entities by collection and id; the order of a collection is that in the window."""

    captures: Mapping[str, Capture] = field(default_factory=dict)
    motions: Mapping[str, Motion] = field(default_factory=dict)
    characters: Mapping[str, Character] = field(default_factory=dict)
    performers: Mapping[str, Performer] = field(default_factory=dict)
    constraints: Mapping[str, Constraint] = field(default_factory=dict)
    contacts: Mapping[str, ContactInterval] = field(default_factory=dict)
    labels: Mapping[str, Label] = field(default_factory=dict)
    grounds: Mapping[str, Ground] = field(default_factory=lambda: {GROUND_ID: Ground()})
    props: Mapping[str, Prop] = field(default_factory=dict)
    behaviours: Mapping[str, Behaviour] = field(default_factory=dict)
    cameras: Mapping[str, SavedCamera] = field(default_factory=dict)
    sounds: Mapping[str, SoundTrack] = field(default_factory=dict)
    footage: Mapping[str, Footage] = field(default_factory=dict)
    corrections: Mapping[str, Correction] = field(default_factory=dict)
    carried: Mapping[str, Any] = field(default_factory=dict)
    """JSON of a newer version that this version does not know, by its place in the file; it is written back unchanged.
    """

    def __post_init__(self) -> None:
        if GROUND_ID not in self.grounds:  # as in a damaged file
            object.__setattr__(self, "grounds", {**self.grounds, GROUND_ID: Ground()})
        for name in (*COLLECTIONS, "carried"):
            object.__setattr__(self, name, _frozen(getattr(self, name)))

    @property
    def ground(self) -> Ground:
        """Ground of the stage."""
        return self.grounds[GROUND_ID]

    @cached_property
    def known(self) -> dict[Any, Any]:
        """Cache of values that callers have computed from this project, under keys of their own."""
        return {}

    @property
    def motions_played(self) -> dict[str, frozenset[str]]:
        """Motion ids in the row of each performer, by performer id."""
        return {
            key: frozenset(clip.motion_id for clip in each.clips) for key, each in self.performers.items() if each.clips
        }

    @cached_property
    def clips(self) -> Mapping[str, Clip]:
        """Clips that performers play, by id; of a clip with several performers, the version of the first."""
        played = [clip for performer in self.performers.values() for clip in performer.all_clips]
        return MappingProxyType({clip.id: clip for clip in reversed(played)})

    @cached_property
    def states(self) -> Mapping[str, State]:
        """States of all behaviours, by the behaviour's id and the state's name."""
        return MappingProxyType(
            {f"{key}/{each.name}": each for key, one in self.behaviours.items() for each in one.states}
        )

    @cached_property
    def transitions(self) -> Mapping[str, Transition]:
        """Transitions of all behaviours, by the behaviour's id and their index in it."""
        found = ((f"{key}/{k}", each) for key, one in self.behaviours.items() for k, each in enumerate(one.transitions))
        return MappingProxyType(dict(found))

    def get(self, collection: str, entity_id: str) -> Any:
        """Entity of a collection, or value of ``clips``, ``states`` or ``transitions``, with that id; None if there is
        none.
        """
        return getattr(self, collection).get(entity_id)

    def place(self, collection: str, entity_id: str) -> int | None:
        """Index of an entity in its collection; None if there is no such entity."""
        ids = tuple(getattr(self, collection))
        return ids.index(entity_id) if entity_id in ids else None

    def with_entity(self, collection: str, entity_id: str, entity: Entity | None, index: int | None = None) -> Self:
        """Project with one entity added, replaced or, for None, removed.

        A replaced entity keeps its index; a new one is inserted at ``index``, or at the end.
        """
        return self.with_entities(collection, ((entity_id, entity, index),))

    def with_entities(self, collection: str, changes: Iterable[tuple[str, Entity | None, int | None]]) -> Self:
        """Project with several entities of one collection added, replaced or removed.

        Each change is (id, entity or None to remove it, index or None), as the arguments of ``with_entity``.
        """
        entities = dict(getattr(self, collection))
        for entity_id, entity, place in changes:
            if entity is None:
                entities.pop(entity_id, None)
            elif entity_id in entities or place is None or place >= len(entities):
                entities[entity_id] = entity
            else:
                ordered = list(entities.items())
                ordered.insert(place, (entity_id, entity))
                entities = dict(ordered)
        changed = replace(self, **{collection: MappingProxyType(entities)})
        if collection != "contacts" and _SORTED in self.__dict__:
            changed.__dict__[_SORTED] = self.__dict__[_SORTED]
        return changed

    def referring_to(self, collection: str, entity_id: str) -> tuple[tuple[str, str], ...]:
        """(collection, id) of the entities that refer to the entity ``entity_id`` of ``collection``."""
        return tuple(
            (name, key)
            for name in COLLECTIONS
            for key, entity in getattr(self, name).items()
            if (collection, entity_id) in references(entity)
        )

    def missing_references(self, entity: Entity) -> tuple[tuple[str, str], ...]:
        """(collection, id) of the entities that ``entity`` refers to and that are not in this project."""
        return tuple(reference for reference in references(entity) if self.get(*reference) is None)

    def constraints_of(self, motion_id: str) -> dict[str, Constraint]:
        """The motion's constraints by id, highest priority first."""
        own = {key: item for key, item in self.constraints.items() if item.motion_id == motion_id}
        return dict(sorted(own.items(), key=lambda pair: pair[1].priority))

    def places_of(self, motion_id: str) -> dict[str, int]:
        """Rank of each constraint of a motion by constraint id; 1 is the highest, and equal priorities share a rank."""
        own = self.constraints_of(motion_id)
        levels = sorted({each.priority for each in own.values()})
        return {key: levels.index(each.priority) + 1 for key, each in own.items()}

    def contacts_of(self, motion_id: str) -> dict[str, ContactInterval]:
        """Contacts of a motion by id, in order of time."""
        return dict(self._contacts_by_motion.get(motion_id, ()))

    def labels_of(self, motion_id: str) -> dict[str, Label]:
        """Labels of a motion by id, in order of time."""
        own = {key: each for key, each in self.labels.items() if each.motion_id == motion_id}
        return dict(sorted(own.items(), key=lambda pair: (pair[1].first, pair[1].last)))

    def contacts_for(self, performer_id: str, clip: Clip) -> dict[str, ContactInterval]:
        """Contacts of a performer during ``clip``, by id; at each contact point those of the narrowest scope."""
        meant = in_scope_of(self.contacts_of(clip.motion_id), performer_id, clip.id)
        if not any(each.scope.is_narrow for each in meant.values()):
            return meant
        own: dict[ContactPoint | Touch, dict[str, ContactInterval]] = {}
        for key, each in meant.items():
            own.setdefault(each.point, {})[key] = each
        return {key: each for contacts in own.values() for key, each in narrowest_scoped(contacts).items()}

    def constraints_for(self, performer_id: str, clip: Clip) -> dict[str, Constraint]:
        """Constraints on a performer during ``clip``, by id, highest priority first."""
        return in_scope_of(self.constraints_of(clip.motion_id), performer_id, clip.id)

    def corrections_of(self, performer_id: str) -> dict[str, Correction]:
        """Corrections of a performer by id, in the order in which they are applied."""
        return {key: each for key, each in self.corrections.items() if each.performer_id == performer_id}

    def behaviour_of(self, performer_id: str) -> str | None:
        """The id of the behaviour that a performer plays, or None."""
        return next((key for key, each in self.behaviours.items() if each.role_of(performer_id)), None)

    def frame_rate_of(self, clip: Clip) -> float:
        """Frame rate of the capture that a clip plays."""
        return self.captures[self.motions[clip.motion_id].capture_id].frame_rate

    @cached_property
    def _contacts_by_motion(self) -> dict[str, list[tuple[str, ContactInterval]]]:
        """Contacts by motion, sorted once, since a long capture has thousands."""
        by_motion: dict[str, list[tuple[str, ContactInterval]]] = {}
        for pair in sorted(self.contacts.items(), key=lambda pair: (pair[1].point, pair[1].first)):
            by_motion.setdefault(pair[1].motion_id, []).append(pair)
        return by_motion
