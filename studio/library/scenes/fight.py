"""Fight training (K05 section 10, figure 14): eight fighters in pairs, with three motions between them."""

import math
from dataclasses import dataclass, replace

from studio.core import hand_shapes
from studio.core.canonical import BodyPart
from studio.core.character import Character
from studio.core.constraints.activation import ActivationCurve
from studio.core.constraints.balance import BalanceConstraint
from studio.core.constraints.base import BodyPoint, Chain, Constraint
from studio.core.constraints.follow import FollowPerformer
from studio.core.constraints.own_place import OwnPlace
from studio.core.constraints.position import PositionConstraint
from studio.core.project import Clip, Performer, Project
from studio.core.scope import Scope
from studio.library.scenes.stagehand import RATE, around, bodies, material

KICK, PUNCH = 152, 181
"""Frames of the captures at which the leg and the arm are stretched most."""
REACH = 1.42
"""Leg lengths between two who fight, of the mean of their legs."""
BESIDE = 2.2
"""Metres from one pair to the next."""
PELVIS = BodyPoint(BodyPart.PELVIS)
ANKLE = BodyPoint(BodyPart.RIGHT_SHANK, at_end=True)
FOREARM = BodyPoint(BodyPart.LEFT_FOREARM, (0.0, 0.0, 0.12))
FIST = BodyPoint(BodyPart.RIGHT_HAND, (0.0, 0.0, 0.09))
BEFORE_CHEST = BodyPoint(BodyPart.THORAX, (0.24, 0.0, -0.02))
BEFORE_BELLY = BodyPoint(BodyPart.PELVIS, (0.24, 0.0, 0.02))
SMALL = 0.85
"""Of the other's stature, below which a leg does not reach the chest."""
CHIN = BodyPoint(BodyPart.HEAD, (0.12, 0.0, 0.03))
BACK = (-0.22, 0.0, -0.05)
"""Leg lengths by which a head leans back from a fist."""
LEG, PUNCHING, LEAN = Chain(root=1.0), Chain(trunk=0.6, root=0.6), Chain(trunk=1.0)
GUARD, LOW_GUARD = Chain(), Chain(trunk=0.8)


@dataclass(frozen=True)
class Pair:
    """Who kicks and leans back, and who wards off and punches."""

    white: str
    red: str


def fight_training(pairs: int = 4) -> Project:
    """The scene; StudioError where a bundled file cannot be read."""
    stuff = material(
        rest=("Rest", "straight_punch"), kick=("Kick", "front_kick"), ward_off=("Ward off, punch", "straight_punch")
    )
    characters = {key: replace(each, grip=hand_shapes.FIST) for key, each in bodies(2 * pairs).items()}
    keys = sorted(characters, key=lambda key: characters[key].morphology.stature)
    fighters = [Pair(*keys[place : place + 2]) for place in range(0, 2 * pairs, 2)]
    performers: dict[str, Performer] = {}
    constraints: dict[str, Constraint] = {}
    for place, pair in enumerate(fighters):
        apart = REACH * (_leg(characters[pair.white]) + _leg(characters[pair.red])) / 2
        across = BESIDE * (place - (pairs - 1) / 2)
        for key, x, heading, clips, colour in (
            (pair.white, 0.0, 0.0, _white(pair.white), "White"),
            (pair.red, apart, math.pi, _red(pair.red), "Red"),
        ):
            name = f"{colour} {place + 1}, {characters[key].name.lower()}"
            performers[key] = Performer(name, key, clips, (x, across), heading)
        small = characters[pair.white].morphology.stature < SMALL * characters[pair.red].morphology.stature
        constraints |= _asked(pair, BEFORE_BELLY if small else BEFORE_CHEST)
    return Project(stuff.captures, stuff.motions, characters, performers, constraints, stuff.contacts)


def _leg(character: Character) -> float:
    return character.morphology.leg_length


def _white(key: str) -> tuple[Clip, ...]:
    return (
        Clip("rest", 240, 300, 0.0, f"{key} before"),
        Clip("kick", 90, 240, 1.0, f"{key} kick"),
        Clip("rest", 240, 340, 3.5, f"{key} after"),
    )


def _red(key: str) -> tuple[Clip, ...]:
    return (
        Clip("rest", 240, 339, 0.0, f"{key} before"),
        Clip("ward_off", 100, 230, 1.65, f"{key} ward off"),
        Clip("rest", 240, 320, 1.65 + 130 / RATE, f"{key} after"),
    )


def _asked(pair: Pair, kicked: BodyPoint) -> dict[str, Constraint]:
    """Of one pair: each of its own fighter alone, after the other's adapted body."""
    white, red = Scope(performer_id=pair.white), Scope(performer_id=pair.red)
    met = 100 + round((1.0 + (KICK - 90) / RATE - 1.65) * RATE)  # frames of the one motion at which the other's are
    hit = 90 + round((1.65 + (PUNCH - 100) / RATE - 1.0) * RATE)
    guard = LOW_GUARD if kicked is BEFORE_BELLY else GUARD
    always = ActivationCurve(-1.0, 0.0, 10.0, 11.0)
    asked = (
        PositionConstraint(
            "kick", "Kick", ANKLE, LEG, 0, around(KICK), scope=white,
            target=FollowPerformer(pair.red, kicked),
        ),
        PositionConstraint(
            "ward_off", "Forearm meets ankle", FOREARM, guard, 0, around(met), scope=red,
            target=FollowPerformer(pair.white, ANKLE),
        ),
        PositionConstraint(
            "ward_off", "Fist meets head", FIST, PUNCHING, 0, around(PUNCH), scope=red,
            target=FollowPerformer(pair.white, CHIN),
        ),
        PositionConstraint(
            "kick", "Lean away", CHIN, LEAN, 0, around(hit, 20, 4), scope=white,
            target=OwnPlace(CHIN, hit / RATE, BACK),
        ),
        *(
            BalanceConstraint(motion, f"Balance, {motion}", PELVIS, Chain(root=1.0), 1, always, scope=whose)
            for motion, whose in (("kick", white), ("ward_off", red))
        ),
    )  # fmt: skip
    return {f"{pair.white} {each.name}": each for each in asked}
