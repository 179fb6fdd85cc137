"""Props as obstacles: one volume constraint per motion, for all its performers."""

from studio.core.body.canonical import BodyPart
from studio.core.constraints.area import AreaConstraint, AreaShape
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.constraints.follow import FollowProp
from studio.core.curves.activation import ActivationCurve
from studio.core.stage.project import Project
from studio.core.stage.prop import PropShape
from studio.document.document import Document

PROP_AREAS = {PropShape.TABLE: AreaShape.TABLE, PropShape.BALL: AreaShape.SPHERE, PropShape.STICK: AreaShape.CYLINDER}
"""Shapes of volume constraints for props by prop shape; other props are boxes."""
OBSTACLE_FADE_SECONDS = 0.5
"""Seconds before and after a motion during which the activation of an obstacle fades in and out."""


def obstacles_of(project: Project, prop_id: str) -> dict[str, AreaConstraint]:
    """Volume constraints by id that keep whole bodies out of a prop."""
    return {
        key: each
        for key, each in project.constraints.items()
        if isinstance(each, AreaConstraint)
        and each.whole
        and isinstance(each.centre, FollowProp)
        and each.centre.prop_id == prop_id
    }


def set_obstacle(document: Document, prop_id: str, collides: bool) -> None:
    """Turn the collision of a prop with all performers on or off; one undo step."""
    project = document.project
    prop = project.props[prop_id]
    text = f"{'Enable' if collides else 'Disable'} collision of {prop.name}"
    with document.group(text):
        for key in obstacles_of(project, prop_id):
            document.remove("constraints", key, text)
        played = {clip.motion_id: clip for each in project.performers.values() for clip in each.clips}
        for motion_id, clip in played.items() if collides else ():
            rate = project.frame_rate_of(clip)
            last = (project.captures[project.motions[motion_id].capture_id].frame_count - 1) / rate
            area = AreaConstraint(
                motion_id, f"Outside {prop.name}", BodyPoint(BodyPart.PELVIS), Chain(root=1.0), 0,
                ActivationCurve(-OBSTACLE_FADE_SECONDS, 0.0, last, last + OBSTACLE_FADE_SECONDS),
                shape=PROP_AREAS.get(prop.shape, AreaShape.BOX), centre=FollowProp(prop_id), size=prop.size, whole=True,
            )  # fmt: skip
            document.add("constraints", area, text)
