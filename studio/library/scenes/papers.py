"""Scenes of figures of the first paper, with one motion each (K05, figures 2, 6, 12 and 13; section 7)."""

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
from studio.library.scenes.stagehand import BUNDLED_FRAME_RATE, SourceMotions, around, bodies, material

WHOLE_TAKE = ActivationCurve(-1.0, 0.0, 60.0, 61.0)
RIGHT_WRIST, RIGHT_ELBOW = (
    BodyPoint(BodyPart.RIGHT_FOREARM, at_end=True),
    BodyPoint(BodyPart.RIGHT_UPPER_ARM, at_end=True),
)
REACH_CHAIN = Chain(trunk=1.0, root=1.0)


def five_bodies() -> Project:
    """One walk on five bodies (figure 2)."""
    return row(material(walk=("Walk and turn", "walk_turn")), "walk", 5, apart=1.3)


def table() -> Project:
    """Three bodies reach, each over a table of its own, above which arms and trunk stay (figure 6)."""
    project = row(material(reach=("Reach", "reach_grasp")), "reach", 3)
    props, asked = {}, dict[str, Constraint]()
    for key, performer in project.performers.items():
        name = f"Table of {performer.name.lower()}"
        x, y = TABLE_AHEAD, performer.position[1]
        props[f"table {key}"] = Prop(name, TABLE_SIZE, (x, y, TABLE_SIZE[2] / 2), shape=PropShape.TABLE)
        asked[f"body {key}"] = AreaConstraint(
            "reach", f"Arms and trunk outside {name}", RIGHT_WRIST, Chain(), 0, WHOLE_TAKE, scope=Scope(key),
            shape=AreaShape.TABLE, centre=FollowProp(f"table {key}"), size=TABLE_SIZE, whole=True,
        )  # fmt: skip
    return replace(project, props=props, constraints=asked)


TABLE_AHEAD, TABLE_SIZE = 0.75, (0.8, 0.9, 1.0)
"""Distance of a table ahead of the body, and its length, breadth and height, in metres."""


def balance() -> Project:
    """The same far reach with balance and without (figure 12)."""
    project = row(material(reach=("Reach", "reach_grasp")), "reach", 2, same=True)
    kept, free = project.performers
    renamed = {kept: "With balance", free: "Without balance"}
    performers = {key: replace(project.performers[key], name=name) for key, name in renamed.items()}
    far = OwnPlace(RIGHT_WRIST, FAR_TARGET_FRAME / BUNDLED_FRAME_RATE, (0.35, 0.0, -0.15))
    asked: dict[str, Constraint] = {
        "reach": PositionConstraint(
            "reach", "Reach farther", RIGHT_WRIST, REACH_CHAIN, 1, around(FAR_TARGET_FRAME, 30, 20), target=far
        ),
        "balance": BalanceConstraint(
            "reach",
            "Balance",
            BodyPoint(BodyPart.PELVIS),
            Chain(root=1.0),
            0,
            WHOLE_TAKE,
            scope=Scope(performer_id=kept),
        ),
    }
    return replace(project, performers=performers, constraints=asked)


FAR_TARGET_FRAME = 250
"""Frame of the reach in which the wrist's target is farther away."""


def wrist_before_elbow() -> Project:
    """The wrist's target has priority over the elbow's; for one body both are within reach (figure 13)."""
    project = row(material(reach=("Reach", "reach_grasp")), "reach", 2, same=True)
    near, far = project.performers
    renamed = {near: "Elbow in reach", far: "Elbow out of reach"}
    project = project.with_entities(
        "performers", [(key, replace(project.performers[key], name=name), None) for key, name in renamed.items()]
    )
    asked: dict[str, Constraint] = {
        "wrist": PositionConstraint(
            "reach", "Wrist", RIGHT_WRIST, REACH_CHAIN, 0, around(FAR_TARGET_FRAME, 30, 20),
            target=OwnPlace(RIGHT_WRIST, FAR_TARGET_FRAME / BUNDLED_FRAME_RATE, (0.0, 0.02, 0.03)),
        )
    }  # fmt: skip
    for key, aside in ((near, (0.0, 0.02, 0.03)), (far, (0.0, 0.4, 0.6))):
        asked[f"elbow {key}"] = PositionConstraint(
            "reach", "Elbow", RIGHT_ELBOW, REACH_CHAIN, 1, around(FAR_TARGET_FRAME, 30, 20),
            target=OwnPlace(RIGHT_ELBOW, FAR_TARGET_FRAME / BUNDLED_FRAME_RATE, aside), scope=Scope(performer_id=key),
        )  # fmt: skip
    return replace(project, constraints=asked)


def slope() -> Project:
    """A walk over a slope (section 7)."""
    project = row(material(walk=("Walk and turn", "walk_turn")), "walk", 5, apart=1.3)
    return replace(project, grounds={GROUND_ID: Slope(angle=0.14)})


def row(stuff: SourceMotions, motion_id: str, count: int, apart: float = 1.15, same: bool = False) -> Project:
    """Project of performers side by side who play one motion, on bodies of their own or all on the ``same``."""
    characters = bodies(1 if same else count)
    names = list(characters) * (count if same else 1)
    capture = stuff.captures[stuff.motions[motion_id].capture_id]
    performers = {
        f"{name} {place}": Performer(
            characters[name].name, name, (Clip(motion_id, 0, capture.frame_count - 1, id="clip"),),
            (0.0, apart * ((count - 1) / 2 - place)),
        )
        for place, name in enumerate(names)
    }  # fmt: skip
    return Project(stuff.captures, stuff.motions, characters, performers, {}, stuff.contacts)
