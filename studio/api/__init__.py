"""The public interface of Morpho Studio for scripts: open, edit, adapt, measure, export, render, search.

    from studio import api

    scene = api.new_scene()
    walk = scene.add_capture("walk.bvh")
    child = scene.add_performer(scene.add_character("child"), walk)
    scene.export(child, "child.bvh")

Lengths are metres, angles radians, times seconds, Z is up; quaternions are (x, y, z, w). Everything that is named here
keeps its meaning as long as the first number of ``VERSION`` stays; other modules of the studio may change at any time.
Errors that a user can mend are ``StudioError``, a sentence each.
"""

from studio.startup import process as _process

_process.name_kernel_cache()  # a script that Python runs by itself has not been prepared

from studio.api.results import Adapted
from studio.api.scene import Scene, new_scene, open_scene
from studio.core.body.canonical import BodyPart
from studio.core.captures.capture import Capture
from studio.core.captures.contacts import ContactInterval, ContactPoint, Touch
from studio.core.constraints.area import AreaConstraint
from studio.core.constraints.balance import BalanceConstraint
from studio.core.constraints.base import BodyPoint, Chain, Constraint, KindInfo
from studio.core.constraints.clear import ClearConstraint
from studio.core.constraints.distance import DistanceConstraint
from studio.core.constraints.follow import FollowBody, FollowPerformer, FollowProp, FollowTracked
from studio.core.constraints.kinds import ConstraintKind
from studio.core.constraints.look_at import LookAtConstraint
from studio.core.constraints.orientation import OrientationConstraint
from studio.core.constraints.own_place import KeyedOwnPlace, OwnPlace
from studio.core.constraints.parallel import ParallelConstraint
from studio.core.constraints.position import PositionConstraint
from studio.core.constraints.rail import RailConstraint
from studio.core.constraints.scope import Scope
from studio.core.constraints.upright import UprightConstraint
from studio.core.curves.activation import ActivationCurve, EaseShape
from studio.core.curves.keyed import KeyedPlace, KeyedTurn
from studio.core.errors import StudioError
from studio.core.grounds.ground import Ground
from studio.core.mesh.character import Character
from studio.core.quality.motion_measures import MotionMeasure
from studio.core.stage.clip import Clip
from studio.core.stage.correction import Correction, KeyedPoses, PoseOffsets
from studio.core.stage.project import Motion, Performer, Project
from studio.core.stage.prop import Prop
from studio.io.export_options import ExportOptions
from studio.io.importing import ImportOptions
from studio.io.plug_ins import Panel, Verb
from studio.library.clip_labels import Kind, Limb
from studio.library.searching import Result
from studio.resources_folder import example_captures_folder

VERSION = "1.2.0"
"""Semantic version of this interface, apart from that of the program."""

__all__ = [
    "VERSION",
    "ActivationCurve",
    "Adapted",
    "AreaConstraint",
    "BalanceConstraint",
    "BodyPart",
    "BodyPoint",
    "Capture",
    "Chain",
    "Character",
    "ClearConstraint",
    "Clip",
    "Constraint",
    "ConstraintKind",
    "ContactInterval",
    "ContactPoint",
    "Correction",
    "DistanceConstraint",
    "EaseShape",
    "ExportOptions",
    "FollowBody",
    "FollowPerformer",
    "FollowProp",
    "FollowTracked",
    "Ground",
    "ImportOptions",
    "KeyedOwnPlace",
    "KeyedPlace",
    "KeyedPoses",
    "KeyedTurn",
    "Kind",
    "KindInfo",
    "Limb",
    "LookAtConstraint",
    "Motion",
    "MotionMeasure",
    "OrientationConstraint",
    "OwnPlace",
    "Panel",
    "ParallelConstraint",
    "Performer",
    "PoseOffsets",
    "PositionConstraint",
    "Project",
    "Prop",
    "RailConstraint",
    "Result",
    "Scene",
    "Scope",
    "StudioError",
    "Touch",
    "UprightConstraint",
    "Verb",
    "example_captures_folder",
    "new_scene",
    "open_scene",
]
