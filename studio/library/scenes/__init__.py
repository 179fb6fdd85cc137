"""Scenes made by the program from its own captures: each a project, and what to look for in it."""

from collections.abc import Callable
from dataclasses import dataclass

from studio.core.project import Project
from studio.library.scenes import fight, papers


@dataclass(frozen=True)
class Scene:
    """A project that is made when it is asked for; StudioError where a bundled file cannot be read."""

    title: str
    text: str
    """What to look for."""
    make: Callable[[], Project]


SCENES = (
    Scene("Fight training", fight.TEXT, fight.fight_training),
    Scene(
        "One walk on five bodies",
        "Everybody walks the same way: steps are as long as legs allow, and no foot slides.",
        papers.five_bodies,
    ),
    Scene(
        "Wrists above a table",
        "Both wrists stay above the table on every body. Select the table and change its height or size.",
        papers.table,
    ),
    Scene(
        "Reach with balance",
        "Both reach for the same place beside them. One keeps its centre of mass over its feet and moves its hips back;"
        " the other leans where it would fall.",
        papers.balance,
    ),
    Scene(
        "Wrist before elbow",
        "The wrist is where it is to be on both. The first body's elbow nearly gets there too, the other's comes as near as"
        " the wrist lets it. Swap the priorities to see the elbow first.",
        papers.wrist_before_elbow,
    ),
    Scene(
        "Walk on a slope",
        "Feet lie on the slope and stay where they stand. Change the angle while it plays.",
        papers.slope,
    ),
)
