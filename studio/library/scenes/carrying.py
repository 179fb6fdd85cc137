"""One two-handed carry with boxes of three sizes (K05, section 10)."""

from dataclasses import replace

from studio.core.constraints.base import Constraint
from studio.core.stage.holding import grip_constraints
from studio.core.stage.project import Project
from studio.core.stage.prop import Carried, Prop
from studio.library.scenes.papers import performers_in_one_motion
from studio.library.scenes.stagehand import BUNDLED_FRAME_RATE, source_motions

BOX_WIDTHS = (0.16, 0.34, 0.52)
"""Widths of the boxes in metres; all are as deep as the first is wide, and a little higher."""
HANDS_CENTRE = (0.42, 0.0, 0.36)
"""Position of the middle between swinging hands relative to the root, in leg lengths."""


def three_boxes() -> Project:
    """Project of three bodies that walk, each with a box."""
    stuff = source_motions(walk=("Walk and turn", "walk_turn"))
    project = performers_in_one_motion(stuff, "walk", 3, apart=1.5)
    last = (stuff.captures["walk_turn"].frame_count - 1) / BUNDLED_FRAME_RATE
    props, asked = {}, dict[str, Constraint]()
    for width, (key, performer) in zip(BOX_WIDTHS, project.performers.items(), strict=True):
        name = f"Box of {performer.name.lower()}"
        box = props[f"box {key}"] = Prop(name, (0.22, width, 0.24), held=Carried(key, HANDS_CENTRE))
        for index, grip in enumerate(grip_constraints("walk", key, f"box {key}", box, (0.0, last), 0)):
            asked[f"grip {key} {index}"] = grip
    return replace(project, props=props, constraints=asked)
