"""Fight training (K05 section 10, figure 14): eight fighters in pairs, with three motions between them."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from studio.core.body.canonical import BodyPart
from studio.core.captures.contacts import ContactPoint
from studio.core.constraints.base import BodyPoint, Chain, Constraint
from studio.core.constraints.follow import FollowPerformer
from studio.core.constraints.own_place import OwnPlace
from studio.core.constraints.position import PositionConstraint
from studio.core.constraints.scope import Scope
from studio.core.mesh import hand_shapes
from studio.core.mesh.character import Character
from studio.core.stage.behaviour import Behaviour, Role, State, Transition
from studio.core.stage.clip import Clip
from studio.core.stage.conditions import (
    ClipEndCondition,
    DistanceCondition,
    EventCondition,
    KeyCondition,
    TimeCondition,
)
from studio.core.stage.project import Performer, Project
from studio.core.stage.reactions import KeepDistance
from studio.library.scenes.stagehand import (
    BUNDLED_FRAME_RATE,
    held_activation,
    hit_activation,
    source_motions,
    varied_characters,
)

KICK_FRAME, PUNCH_FRAME = 152, 181
"""Frames of the captures at which the leg and the arm are stretched most."""
FIGHT_DISTANCE = 1.7
"""Distance between two fighters in mean leg lengths at which the captured kick and punch reach without adaptation."""
PAIR_SPACING = 2.2
"""Metres from one pair to the next."""
KICKING_ANKLE_POINT = BodyPoint(BodyPart.RIGHT_SHANK, at_end=True)
WARDING_FOREARM_POINT = BodyPoint(BodyPart.LEFT_FOREARM, (0.0, 0.0, 0.12))
RIGHT_FIST_POINT = BodyPoint(BodyPart.RIGHT_HAND, (0.0, 0.0, 0.09))
POINT_BEFORE_CHEST = BodyPoint(BodyPart.THORAX, (0.24, 0.0, -0.02))
POINT_BEFORE_BELLY = BodyPoint(BodyPart.PELVIS, (0.24, 0.0, 0.02))
CHEST_KICK_STATURE_FRACTION = 0.9
"""Fraction of the partner's stature; a shorter kicker does not reach the partner's chest."""
CHIN_POINT = BodyPoint(BodyPart.HEAD, (0.12, 0.0, 0.03))
LEAN_BACK_OFFSET = (-0.22, 0.0, -0.05)
"""Displacement in leg lengths of a head that leans back from a fist."""
KICK_CHAIN, FIGHT_PUNCH_CHAIN, LEAN_BACK_CHAIN = Chain(root=1.0), Chain(trunk=0.6, root=0.6), Chain(trunk=1.0)
"""Segments that help in the kick, in the punch, and in leaning back."""
GUARD_CHAIN, LOW_GUARD_CHAIN = Chain(), Chain(trunk=0.8)
"""Segments that help in warding off a kick at the chest, and at the belly."""


KICK_SECONDS, WARD_DELAY_SECONDS = 1.0, 0.65
"""Stage second at which the kick begins, and seconds from then to the warding off."""
GUARD_DISTANCE = 1.4
"""Initial distance between the hips of a pair on guard, in leg lengths."""
KEEP_GUARD_DISTANCE, MOST_KICK_DISTANCE = (
    KeepDistance(distance=GUARD_DISTANCE, room=0.12, legs=True),
    GUARD_DISTANCE + 0.3,
)
"""Reaction that keeps the distance in live playback, and the distance in leg lengths above which nobody kicks."""


@dataclass(frozen=True)
class Pair:
    """Pair of fighters by character: white kicks and leans back, red wards off and punches."""

    white: str
    red: str


def fight_training(pairs: int = 4) -> Project:
    """Project of the scene. Raises StudioError if a bundled file cannot be read."""
    stuff = source_motions(
        rest=("Rest", "straight_punch"), kick=("Kick", "front_kick"), ward_off=("Ward off, punch", "straight_punch")
    )
    characters = {key: replace(each, grip=hand_shapes.FIST_GRIP) for key, each in varied_characters(2 * pairs).items()}
    keys = sorted(characters, key=lambda key: characters[key].morphology.stature)
    fighters = [Pair(*keys[index : index + 2]) for index in range(0, 2 * pairs, 2)]
    performers: dict[str, Performer] = {}
    constraints: dict[str, Constraint] = {}
    for index, pair in enumerate(fighters):
        apart = FIGHT_DISTANCE * (_leg(characters[pair.white]) + _leg(characters[pair.red])) / 2
        across = PAIR_SPACING * (index - (pairs - 1) / 2)
        for key, x, heading, clips, colour in (
            (pair.white, 0.0, 0.0, _white(pair.white), "White"),
            (pair.red, apart, math.pi, _red(pair.red), "Red"),
        ):
            name = f"{colour} {index + 1}, {characters[key].name.lower()}"
            performers[key] = Performer(name, key, clips, (x, across), heading)
        small = (
            characters[pair.white].morphology.stature
            < CHEST_KICK_STATURE_FRACTION * characters[pair.red].morphology.stature
        )
        constraints |= _asked(pair, POINT_BEFORE_BELLY if small else POINT_BEFORE_CHEST)
    behaviours = {"white": _kicking(fighters), "red": _warding(fighters)}
    contacts = {key: each for key, each in stuff.contacts.items() if isinstance(each.point, ContactPoint)}
    # Hands on guard are near each other, but a hand that wards off must not drag the other along.
    return Project(stuff.captures, stuff.motions, characters, performers, constraints, contacts, behaviours=behaviours)


def _kicking(fighters: Sequence[Pair]) -> Behaviour:
    """Behaviour of the fighters in white for live playback: they kick when a key is pressed.

    The constraints of the kick act in any case.
    """
    guard = State("Guard", Clip("rest", 240, 340, id="guard"), manners=(KEEP_GUARD_DISTANCE,))
    kick = State("Kick", Clip("kick", 90, 240, id="kick"), False, event="kick", place=(288.0, 0.0))
    ways = (
        Transition(
            "Guard", "Kick", (KeyCondition("X"), DistanceCondition(KEEP_GUARD_DISTANCE.gap, MOST_KICK_DISTANCE)), 0.3
        ),
        Transition("Kick", "Guard", (ClipEndCondition(),), 0.3),
    )
    cast = tuple(Role(pair.white, pair.red) for pair in fighters)
    return Behaviour("White", (guard, kick), ways, cast=cast)


def _warding(fighters: Sequence[Pair]) -> Behaviour:
    """Behaviour of the fighters in red for live playback: they wait for the partner's kick, ward it off and punch."""
    guard = State("Guard", Clip("rest", 240, 340, id="guard"), manners=(KEEP_GUARD_DISTANCE,))
    waits = State("Wait", Clip("rest", 240, 340, id="wait"), place=(264.0, -72.0))
    ward = State("Ward off, punch", Clip("ward_off", 100, 230, id="ward off"), False, place=(528.0, 0.0))
    ways = (
        Transition("Guard", "Wait", (EventCondition("kick"),), 0.3),
        Transition("Wait", ward.name, (TimeCondition(WARD_DELAY_SECONDS - 2 / BUNDLED_FRAME_RATE),), 0.3),
        Transition(ward.name, "Guard", (ClipEndCondition(),), 0.3),
    )
    cast = tuple(Role(pair.red, pair.white) for pair in fighters)
    return Behaviour("Red", (guard, waits, ward), ways, cast=cast)


def _leg(character: Character) -> float:
    return character.morphology.leg_length


def _white(key: str) -> tuple[Clip, ...]:
    return (
        Clip("rest", 240, 300, 0.0, f"{key} before"),
        Clip("kick", 90, 240, KICK_SECONDS, f"{key} kick"),
        Clip("rest", 240, 340, 3.5, f"{key} after"),
    )


def _red(key: str) -> tuple[Clip, ...]:
    wards = KICK_SECONDS + WARD_DELAY_SECONDS
    return (
        Clip("rest", 240, 339, 0.0, f"{key} before"),
        Clip("ward_off", 100, 230, wards, f"{key} ward off"),
        Clip("rest", 240, 320, wards + 130 / BUNDLED_FRAME_RATE, f"{key} after"),
    )


def _asked(pair: Pair, kicked: BodyPoint) -> dict[str, Constraint]:
    """Constraints of one pair by id; each is on one fighter and follows the adapted body of the other.

    ``kicked`` is the point of the body at which the kick is aimed.
    """
    white, red = Scope(performer_id=pair.white), Scope(performer_id=pair.red)
    met = 100 + round(
        ((KICK_FRAME - 90) / BUNDLED_FRAME_RATE - WARD_DELAY_SECONDS) * BUNDLED_FRAME_RATE
    )  # frames of the one motion at which the other's are
    hit = 90 + round((WARD_DELAY_SECONDS + (PUNCH_FRAME - 100) / BUNDLED_FRAME_RATE) * BUNDLED_FRAME_RATE)
    guard = LOW_GUARD_CHAIN if kicked is POINT_BEFORE_BELLY else GUARD_CHAIN
    asked = (
        PositionConstraint(
            "kick", "Kick", KICKING_ANKLE_POINT, KICK_CHAIN, 0, hit_activation(KICK_FRAME), scope=white,
            target=FollowPerformer(pair.red, kicked),
        ),
        PositionConstraint(
            "ward_off", "Forearm meets ankle", WARDING_FOREARM_POINT, guard, 0, held_activation(met, 17, 0), scope=red,
            target=FollowPerformer(pair.white, KICKING_ANKLE_POINT, awaits=True),
        ),
        PositionConstraint(
            "ward_off", "Fist meets head", RIGHT_FIST_POINT, FIGHT_PUNCH_CHAIN, 0, hit_activation(PUNCH_FRAME),
            scope=red, target=FollowPerformer(pair.white, CHIN_POINT, awaits=True),
        ),
        PositionConstraint(
            "kick", "Lean away", CHIN_POINT, LEAN_BACK_CHAIN, 0, held_activation(hit, 20, 4), scope=white,
            target=OwnPlace(CHIN_POINT, hit / BUNDLED_FRAME_RATE, LEAN_BACK_OFFSET),
        ),
    )  # fmt: skip
    return {f"{pair.white} {each.name}": each for each in asked}
