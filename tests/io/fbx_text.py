"""A body in motion as an FBX file of text, as the format's own programs write it: curves of degrees a joint."""

import numpy as np
from scipy.spatial.transform import Rotation

from studio.core.body.pose import PoseSequence
from studio.core.body.skeleton import Skeleton
from tests.builders import make_poses, make_skeleton

TICKS = 46_186_158_000
"""Parts of a second."""
RATE = 30
WORLD_TO_FILE = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
"""Y up, Z forward."""
BESIDE, ARMATURE, ROOT, ATTRIBUTE, TRAVEL, TURNS = 100, 999, 1000, 2000, 9000, 10_000
"""First number of each kind of object."""

HEAD = """; FBX 7.4.0 project file
FBXHeaderExtension: { FBXHeaderVersion: 1003
FBXVersion: 7400 }
GlobalSettings: { Version: 1000
Properties70: {
P: "UpAxis", "int", "Integer", "",1
P: "UpAxisSign", "int", "Integer", "",1
P: "FrontAxis", "int", "Integer", "",2
P: "FrontAxisSign", "int", "Integer", "",1
P: "CoordAxis", "int", "Integer", "",0
P: "CoordAxisSign", "int", "Integer", "",1
P: "UnitScaleFactor", "double", "Number", "",1
P: "TimeMode", "enum", "", "",6
} }
Objects: {
AnimationLayer: 2, "AnimLayer::Base", "" { }
"""
MODEL = """Model: {number}, "Model::{name}", "{kind}" {{ Version: 232
Properties70: {{
P: "Lcl Translation", "Lcl Translation", "", "A",{place}
P: "Lcl Scaling", "Lcl Scaling", "", "A",{scale},{scale},{scale}
P: "RotationActive", "bool", "", "",1
P: "RotationOrder", "enum", "", "",{order}
P: "PreRotation", "Vector3D", "Vector", "",{before}
}} }}"""
ORDERS = ("xyz", "xzy", "yzx", "yxz", "zxy", "zyx")
PLAIN = {"order": 0, "before": "0,0,0"}
STACK = """AnimationStack: 1, "AnimStack::Take", "" {{ Properties70: {{
P: "LocalStart", "KTime", "Time", "",0
P: "LocalStop", "KTime", "Time", "",{stop}
}} }}"""
CURVE = """AnimationCurve: {number}, "AnimCurve::", "" {{ Default: 0
KeyVer: 4008
KeyTime: *{count} {{ a: {times} }}
KeyValueFloat: *{count} {{ a: {keys} }}
KeyAttrFlags: *1 {{ a: 4 }}
KeyAttrDataFloat: *4 {{ a: 0,0,0,0 }}
KeyAttrRefCount: *1 {{ a: {count} }} }}"""


def body() -> tuple[Skeleton, PoseSequence]:
    skeleton = make_skeleton()
    return skeleton, make_poses(skeleton, 20)


def fbx_text(
    scale: float = 1.0,
    armature: bool = False,
    beside: tuple[str, ...] = (),
    order: str = "xyz",
    before: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> str:
    """``body`` in centimetres; below an armature of that scale, as Blender has it; empty things ``beside`` it.

    ``order`` is that of the angles; ``before`` is how every joint is turned before them, as Maya and Mixamo have it.
    """
    skeleton, poses = body()
    axes = Rotation.from_euler("xyz", before, degrees=True)
    turns = {"order": ORDERS.index(order), "before": _numbers(np.array(before))}
    objects = [STACK.format(stop=round((poses.frame_count - 1) / RATE * TICKS))]
    links = ['C: "OO",2,1']
    for joint, parent in enumerate(skeleton.parents.tolist()):
        place = _numbers(WORLD_TO_FILE @ skeleton.offsets[joint] * 100 / scale)
        name = skeleton.names[joint]
        objects.append(MODEL.format(number=ROOT + joint, name=name, kind="LimbNode", place=place, scale=1, **turns))
        objects.append(f'NodeAttribute: {ATTRIBUTE + joint}, "NodeAttribute::", "LimbNode" {{ TypeFlags: "Skeleton" }}')
        above = ROOT + parent if parent >= 0 else ARMATURE if armature else 0
        links += [f'C: "OO",{ATTRIBUTE + joint},{ROOT + joint}', f'C: "OO",{ROOT + joint},{above}']
        turned = WORLD_TO_FILE @ Rotation.from_quat(poses.local_rotations[:, joint]).as_matrix() @ WORLD_TO_FILE.T
        angles = np.degrees(np.unwrap((axes.inv() * Rotation.from_matrix(turned)).as_euler(order), axis=0))
        angles = angles[:, [order.index(axis) for axis in "xyz"]]
        _animate(objects, links, TURNS + 10 * joint, ROOT + joint, "Lcl Rotation", angles)
    _animate(
        objects, links, TRAVEL, ROOT, "Lcl Translation", poses.local_translations[:, 0] @ WORLD_TO_FILE.T * 100 / scale
    )
    if armature:
        objects.append(MODEL.format(number=ARMATURE, name="Armature", kind="Null", place="0,0,0", scale=scale, **PLAIN))
        links.append(f'C: "OO",{ARMATURE},0')
    for number, name in enumerate(beside, BESIDE):
        objects.append(MODEL.format(number=number, name=name, kind="Null", place="0,0,0", scale=1, **PLAIN))
        links.append(f'C: "OO",{number},0')
    return HEAD + "\n".join(objects) + "\n}\nConnections: {\n" + "\n".join(links) + "\n}\n"


def _animate(objects: list[str], links: list[str], first: int, model: int, member: str, values: np.ndarray) -> None:
    objects.append(f'AnimationCurveNode: {first}, "AnimCurveNode::{member[4]}", "" {{ }}')
    links += [f'C: "OO",{first},2', f'C: "OP",{first},{model}, "{member}"']
    times = ",".join(str(round(frame / RATE * TICKS)) for frame in range(len(values)))
    for axis in range(3):
        number, keys = first + axis + 1, _numbers(values[:, axis])
        objects.append(CURVE.format(number=number, count=len(values), times=times, keys=keys))
        links.append(f'C: "OP",{number},{first}, "d|{"XYZ"[axis]}"')


def _numbers(values: np.ndarray) -> str:
    return ",".join(f"{value:.9g}" for value in values)
