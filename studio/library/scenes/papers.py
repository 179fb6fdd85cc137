"""Scenes of figures of the first paper, each with one motion (K05, figures 2, 6, 12 and 13; section 7)."""

from dataclasses import replace

from studio.core.body.canonical import BodyPart
from studio.core.constraints.area import AreaConstraint, AreaShape
from studio.core.constraints.balance import BalanceConstraint
from studio.core.constraints.base import BodyPoint, Chain, Constraint
from studio.core.constraints.follow import FollowProp
from studio.core.constraints.own_place import OwnPlace
from studio.core.constraints.position import PositionConstraint
from studio.core.constraints.scope import Scope
from studio.core.curves.activation import ActivationCurve
from studio.core.grounds.slope import Slope
from studio.core.stage.clip import Clip
from studio.core.stage.project import GROUND_ID, Performer, Project
from studio.core.stage.prop import Prop, PropShape
from studio.library.scenes.stagehand import (
    BUNDLED_FRAME_RATE,
    SourceMotions,
    held_activation,
    source_motions,
    varied_characters,
)

WHOLE_TAKE_ACTIVATION = ActivationCurve(-1.0, 0.0, 60.0, 61.0)
"""Activation that is full during the whole take."""
RIGHT_WRIST_POINT, RIGHT_ELBOW_POINT = (
    BodyPoint(BodyPart.RIGHT_FOREARM, at_end=True),
    BodyPoint(BodyPart.RIGHT_UPPER_ARM, at_end=True),
)
REACH_CHAIN = Chain(trunk=1.0, root=1.0)


def five_bodies() -> Project:
    """Project of one walk on five bodies (figure 2)."""
    return performers_in_one_motion(source_motions(walk=("Walk and turn", "walk_turn")), "walk", 5, apart=1.3)


def table() -> Project:
    """Project of three bodies that reach over a table each; arms and trunk stay above it (figure 6)."""
    project = performers_in_one_motion(source_motions(reach=("Reach", "reach_grasp")), "reach", 3)
    props, asked = {}, dict[str, Constraint]()
    for key, performer in project.performers.items():
        name = f"Table of {performer.name.lower()}"
        x, y = TABLE_AHEAD, performer.position[1]
        props[f"table {key}"] = Prop(name, TABLE_SIZE, (x, y, TABLE_SIZE[2] / 2), shape=PropShape.TABLE)
        asked[f"body {key}"] = AreaConstraint(
            "reach", f"Arms and trunk outside {name}", RIGHT_WRIST_POINT, Chain(), 0, WHOLE_TAKE_ACTIVATION,
            scope=Scope(key), shape=AreaShape.TABLE, centre=FollowProp(f"table {key}"), size=TABLE_SIZE, whole=True,
        )  # fmt: skip
    return replace(project, props=props, constraints=asked)


TABLE_AHEAD, TABLE_SIZE = 0.75, (0.8, 0.9, 1.0)
"""In metres: distance of a table ahead of the body, and its length, breadth and height."""


def balance() -> Project:
    """Project of one far reach with a balance constraint and without (figure 12)."""
    project = performers_in_one_motion(source_motions(reach=("Reach", "reach_grasp")), "reach", 2, same=True)
    kept, free = project.performers
    renamed = {kept: "With balance", free: "Without balance"}
    performers = {key: replace(project.performers[key], name=name) for key, name in renamed.items()}
    far = OwnPlace(RIGHT_WRIST_POINT, FAR_TARGET_FRAME / BUNDLED_FRAME_RATE, (0.35, 0.0, -0.15))
    asked: dict[str, Constraint] = {
        "reach": PositionConstraint(
            "reach",
            "Reach farther",
            RIGHT_WRIST_POINT,
            REACH_CHAIN,
            1,
            held_activation(FAR_TARGET_FRAME, 30, 20),
            target=far,
        ),
        "balance": BalanceConstraint(
            "reach",
            "Balance",
            BodyPoint(BodyPart.PELVIS),
            Chain(root=1.0),
            0,
            WHOLE_TAKE_ACTIVATION,
            scope=Scope(performer_id=kept),
        ),
    }
    return replace(project, performers=performers, constraints=asked)


FAR_TARGET_FRAME = 250
"""Frame of the reach in which the wrist's target is farther away."""


def wrist_before_elbow() -> Project:
    """Project in which the wrist's target has priority over the elbow's; for one body both are within reach (figure
    13).
    """
    project = performers_in_one_motion(source_motions(reach=("Reach", "reach_grasp")), "reach", 2, same=True)
    near, far = project.performers
    renamed = {near: "Elbow in reach", far: "Elbow out of reach"}
    project = project.with_entities(
        "performers", [(key, replace(project.performers[key], name=name), None) for key, name in renamed.items()]
    )
    asked: dict[str, Constraint] = {
        "wrist": PositionConstraint(
            "reach", "Wrist", RIGHT_WRIST_POINT, REACH_CHAIN, 0, held_activation(FAR_TARGET_FRAME, 30, 20),
            target=OwnPlace(RIGHT_WRIST_POINT, FAR_TARGET_FRAME / BUNDLED_FRAME_RATE, (0.0, 0.02, 0.03)),
        )
    }  # fmt: skip
    for key, aside in ((near, (0.0, 0.02, 0.03)), (far, (0.0, 0.4, 0.6))):
        asked[f"elbow {key}"] = PositionConstraint(
            "reach", "Elbow", RIGHT_ELBOW_POINT, REACH_CHAIN, 1, held_activation(FAR_TARGET_FRAME, 30, 20),
            target=OwnPlace(RIGHT_ELBOW_POINT, FAR_TARGET_FRAME / BUNDLED_FRAME_RATE, aside),
            scope=Scope(performer_id=key),
        )  # fmt: skip
    return replace(project, constraints=asked)


def slope() -> Project:
    """Project of a walk over a slope (section 7)."""
    project = performers_in_one_motion(source_motions(walk=("Walk and turn", "walk_turn")), "walk", 5, apart=1.3)
    return replace(project, grounds={GROUND_ID: Slope(angle=0.14)})


def performers_in_one_motion(
    stuff: SourceMotions, motion_id: str, count: int, apart: float = 1.15, same: bool = False
) -> Project:
    """Project of ``count`` performers side by side, ``apart`` metres from each other, who play the motion
    ``motion_id``.

    Each has a character of its own unless ``same`` is True.
    """
    characters = varied_characters(1 if same else count)
    names = list(characters) * (count if same else 1)
    capture = stuff.captures[stuff.motions[motion_id].capture_id]
    performers = {
        f"{name} {index}": Performer(
            characters[name].name, name, (Clip(motion_id, 0, capture.frame_count - 1, id="clip"),),
            (0.0, apart * ((count - 1) / 2 - index)),
        )
        for index, name in enumerate(names)
    }  # fmt: skip
    return Project(stuff.captures, stuff.motions, characters, performers, {}, stuff.contacts)
