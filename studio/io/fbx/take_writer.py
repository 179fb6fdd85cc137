"""Writer of a take as binary FBX 7.4: joints, skin with its bind pose, materials, and curves with a key at
every frame.
"""

import hashlib
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from studio.core.mesh.appearance import EMISSIVE_MAP, METALLIC_MAP, NORMAL_MAP, ROUGHNESS_MAP, Material
from studio.core.rigs.joint_skin import JointSkin
from studio.core.rotations import IDENTITY_QUATERNION
from studio.io.atomic_write import write_pieces
from studio.io.export import Take, plain_material, skin_of
from studio.io.fbx.binary import FbxElement, Int64, block, element, encode_document
from studio.io.fbx.document import (
    SCENE_ROOT_ID,
    FbxDocument,
    animated,
    choice,
    colour,
    matrix,
    number,
    properties,
    row,
    whole,
)
from studio.io.fbx.euler import euler_curves
from studio.io.registry import Progress

FloatArray = NDArray[np.float64]
ProgressFraction = Callable[[float], None]
"""Callback for the fraction of the work that is done, 0 to 1; it may raise an exception to cancel."""

CENTIMETRES_PER_METRE = 100.0
"""Centimetres in a metre; files are in centimetres."""
WORLD_TO_FILE = [1, 2, 0]
"""World axis of each file axis, Y up and facing +Z: file x is world Y (left), y is Z (up), z is X (forward)."""
_TRAVELS = 1e-7
"""Metres by which a joint must leave its offset to have curves of its position."""
_DETACHED = 2e-6
"""Metres, a fifth of the accuracy of the file."""
CURVES_DONE_FRACTION = 0.8
"""Fraction of the work after which all curves are made."""
_EVEN = 1e-6
"""Relative difference of a scale that is one."""
_LINEAR = 4
"""The flag of keys that are interpolated linearly."""
_PIECE = 1 << 20
"""Bytes that are written between two reports of progress."""


def write_take(path: Path, take: Take, progress: Progress) -> None:
    """Write joints, animation and the character's skin, or a figure of bones if it has none.

    The file is in centimetres, Y up, facing +Z; every angle is zero in the zero pose of the skeleton, and the bind pose
    is that of the skin. Read back, every joint is within 0.01 mm and 0.01 degrees. Raises StudioError if the file
    cannot be written.
    """
    document = FbxDocument(take.name, take.frame_rate, take.poses.frame_count)
    put_take(
        document, take, SCENE_ROOT_ID, lambda share: progress(CURVES_DONE_FRACTION * share, f"Writing {path.name}")
    )
    write_document(path, document, progress)


def write_document(path: Path, document: FbxDocument, progress: Progress) -> None:
    """Write the finished document; progress continues from ``CURVES_DONE_FRACTION``."""
    write_pieces(path, _reported(document.elements(), lambda: progress(CURVES_DONE_FRACTION, f"Writing {path.name}")))
    progress(1.0, f"Wrote {path.name}")


def _reported(elements: Sequence[FbxElement], report: Callable[[], None]) -> Iterator[memoryview]:
    for piece in encode_document(elements):
        for first in range(0, len(piece), _PIECE):
            report()
            yield memoryview(piece)[first : first + _PIECE]


def put_take(document: FbxDocument, take: Take, parent: Int64, progress: ProgressFraction) -> None:
    """Add the joints, curves and skin of ``take`` below the node ``parent``, 0 for the scene itself."""
    skin = skin_of(take)
    joints = _put_joints(document, take, skin, parent, progress)
    axes = _turned(skin.bind_rotations)
    if skin.bind_scales is not None:
        axes = axes * skin.bind_scales[:, None, None]
    stands = [
        (joint, _placed(position, rotation))
        for joint, position, rotation in zip(
            joints, positions_in_file(_detached(take, skin.bind_positions)), axes, strict=True
        )
    ]
    if len(skin.triangles):
        mesh = _put_mesh(document, take, skin, parent)
        geometry = document.add("Geometry", take.name, "Mesh", _geometry(skin), within=mesh)
        _put_skin(document, take.name, skin, geometry, stands)
        stands.append((mesh, np.eye(4)))
    nodes = [
        block("PoseNode", children=[element("Node", key), element("Matrix", matrix(stand))]) for key, stand in stands
    ]
    about = [element("Type", "BindPose"), element("Version", 100), element("NbPoseNodes", len(nodes))]
    document.add("Pose", take.name, "BindPose", [*about, *nodes])


def _put_joints(
    document: FbxDocument, take: Take, skin: JointSkin, parent: Int64, progress: ProgressFraction
) -> list[Int64]:
    """Add the joints in the zero pose of the skeleton, and their curves; nodes that only carry bones become empties."""
    skeleton, poses = take.skeleton, take.poses
    scales, units = skin.local_scales(skeleton.parents)
    offsets = positions_in_file(skeleton.offsets) / units[:, None]
    travels = _travelling(take)
    rests = (
        take.rest_rotations
        if take.rest_rotations is not None
        else np.tile(IDENTITY_QUATERNION, (skeleton.joint_count, 1))
    )
    joints: list[Int64] = []
    for joint, name in enumerate(skeleton.names):
        progress(joint / skeleton.joint_count)
        order, angles = euler_curves(np.vstack([rests[joint], poses.local_rotations[:, joint]])[:, [*WORLD_TO_FILE, 3]])
        above = int(skeleton.parents[joint])
        stands = [animated("Lcl Translation", offsets[joint]), animated("Lcl Rotation", angles[0])]
        if not np.isclose(scales[joint], 1.0, rtol=_EVEN, atol=0.0):
            stands.append(animated("Lcl Scaling", [float(scales[joint])] * 3))
        is_bone = skin.bones is None or bool(skin.bones[joint])
        kind, flags = ("LimbNode", "Skeleton") if is_bone else ("Null", "Null")
        within = joints[above] if above >= 0 else parent
        key = document.add("Model", name, kind, node(*stands, order=order), within=within)
        attribute = [element("TypeFlags", flags), *([properties(number("Size", 1.0))] if is_bone else [])]
        document.add("NodeAttribute", name, kind, attribute, within=key)
        if is_bone and (not skeleton.end_sites[joint] or joint == 0):
            put_curves(document, key, "Lcl Rotation", "R", angles[1:])
        if travels[joint] or (is_bone and joint == 0):
            places = positions_in_file(poses.local_translations[:, joint]) / units[joint]
            put_curves(document, key, "Lcl Translation", "T", places)
        joints.append(key)
    return joints


def _travelling(take: Take) -> NDArray[np.bool_]:
    """Mask (J,) of joints that leave their offset."""
    away = np.abs(take.poses.local_translations - take.skeleton.offsets)
    return np.asarray(away.max(axis=(0, 2)) > _TRAVELS)


def _detached(take: Take, bind_positions: FloatArray) -> FloatArray:
    """Bind positions (J, 3) with travelling joints and the hips moved by ``_DETACHED``.

    Blender connects a bone whose head is exactly at the tail of its parent, as hips straight above a root are, and
    ignores the translation of connected bones.
    """
    apart = _travelling(take)
    if take.capture.body_map:  # the hips of a character that stands will travel with another file
        apart[take.capture.body_map.spine[0]] = True
    apart &= take.skeleton.parents >= 0
    return bind_positions + _DETACHED * apart[:, None] * [1.0, 1.0, 0.0]


def node(*rows: FbxElement, order: int = 0) -> list[FbxElement]:
    """Properties of a node, with ``rows`` of its own; ``order`` is that of its three rotations."""
    common = [
        row("RotationActive", "bool", "", "", 1),
        choice("RotationOrder", order),
        choice("InheritType", 1),
        whole("DefaultAttributeIndex", 0),
    ]
    return [
        element("Version", 232),
        properties(*common, *rows),
        element("Shading", True),
        element("Culling", "CullingOff"),
    ]


def put_curves(document: FbxDocument, node: Int64, of_property: str, name: str, values: FloatArray) -> None:
    """Add three curves of one property of a node, with a key at every frame; ``values`` (F, 3)."""
    axes = "XYZ"
    first = [row(f"d|{axis}", "Number", "", "A", float(value)) for axis, value in zip(axes, values[0], strict=True)]
    curves = document.add("AnimationCurveNode", name, "", [properties(*first)], within=document.layer)
    document.connect(curves, node, of_property)
    for axis, keys in zip(axes, values.T, strict=True):
        parts = [
            element("Default", float(keys[0])),
            element("KeyVer", 4009),
            element("KeyTime", document.key_times),
            element("KeyValueFloat", keys.astype(np.float32)),
            element("KeyAttrFlags", np.array([_LINEAR], np.int32)),
            element("KeyAttrDataFloat", np.zeros(4, np.float32)),
            element("KeyAttrRefCount", np.array([len(keys)], np.int32)),
        ]
        document.connect(document.add("AnimationCurve", "", "", parts), curves, f"d|{axis}")


def _put_mesh(document: FbxDocument, take: Take, skin: JointSkin, parent: Int64) -> Int64:
    """Add the node of the skin with its materials."""
    mesh = document.add("Model", f"{take.name} skin", "Mesh", node(), within=parent)
    for material in skin.appearance.materials if skin.appearance else (plain_material(take),):
        put_material(document, material, mesh)
    return mesh


MAP_PROPERTIES = {
    NORMAL_MAP: "NormalMap",
    EMISSIVE_MAP: "EmissiveColor",
    METALLIC_MAP: "ReflectionFactor",
    ROUGHNESS_MAP: "ShininessExponent",
}
"""Properties to which Blender and others connect the maps of a material."""


def put_material(document: FbxDocument, material: Material, mesh: Int64) -> None:
    """Add a material of a mesh, with its pictures inside the file."""
    colours = "#FFFFFF" if material.texture is not None else material.colour
    shares = [int(colours[place : place + 2], 16) / 255.0 for place in (1, 3, 5)]
    about = [
        element("Version", 102),
        element("ShadingModel", "lambert"),
        element("MultiLayer", 0),
        properties(colour("DiffuseColor", shares), colour("EmissiveColor", list(material.emission))),
    ]
    key = document.add("Material", material.name, "", about, within=mesh)
    if material.texture is not None:
        document.connect(_put_picture(document, material.texture.tobytes()), key, "DiffuseColor")
    for name, picture in material.maps.items():
        if name in MAP_PROPERTIES:
            document.connect(_put_picture(document, picture.tobytes()), key, MAP_PROPERTIES[name])


def _put_picture(document: FbxDocument, content: bytes) -> Int64:
    """Number of the texture of a picture, which is added once."""
    suffix = "png" if content.startswith(b"\x89PNG") else "jpg"
    name = f"{hashlib.sha256(content).hexdigest()[:16]}.{suffix}"
    if name not in document.pictures:
        path = [element("FileName", name), element("RelativeFilename", name)]
        texture = [element("Type", "TextureVideoClip"), element("Version", 202), element("Media", name), *path]
        document.pictures[name] = document.add("Texture", name, "", texture)
        clip = [element("Type", "Clip"), element("UseMipMap", 0), *path, element("Content", content)]
        document.add("Video", name, "Clip", clip, within=document.pictures[name])
    return document.pictures[name]


def _geometry(skin: JointSkin) -> list[FbxElement]:
    """Vertices, triangles, normals and, with textures, texture coordinates."""
    look = skin.appearance
    kinds = look.triangle_materials if look else np.zeros(len(skin.triangles), np.int32)
    coordinates = look.coordinates if look and any(each.pictures for each in look.materials) else None
    return geometry(skin.vertices, skin.normals, skin.triangles, kinds, coordinates)


def geometry(
    vertices: FloatArray,
    normals: FloatArray,
    triangles: NDArray[np.int32],
    kinds: NDArray[np.int32],
    coordinates: NDArray[np.float32] | None = None,
) -> list[FbxElement]:
    """Elements of a mesh with ``vertices`` (V, 3) in metres, ``normals`` (V, 3) and ``triangles`` (T, 3).

    ``kinds`` (T,) are the materials of the triangles, and ``coordinates`` (V, 2) those in the textures.
    """
    corners = triangles.astype(np.int32)
    ended = corners ^ np.array([0, 0, -1], np.int32)  # the last corner of a polygon is stored as its complement
    layers = [
        block(
            "LayerElementNormal", 0,
            children=[*_mapped("ByPolygonVertex", "Direct"), element("Normals", _turned_vectors(normals[corners]))],
        ),
        block(
            "LayerElementMaterial", 0,
            children=[*_mapped("ByPolygon", "IndexToDirect"), element("Materials", kinds)],
        ),
    ]  # fmt: skip
    if coordinates is not None:
        places = [element("UV", coordinates.astype(np.float64).ravel()), element("UVIndex", corners.ravel())]
        layers.append(block("LayerElementUV", 0, children=[*_mapped("ByPolygonVertex", "IndexToDirect"), *places]))
    used = [block("LayerElement", children=[element("Type", layer.name), element("TypedIndex", 0)]) for layer in layers]
    return [
        element("GeometryVersion", 124),
        element("Vertices", positions_in_file(vertices).ravel()),
        element("PolygonVertexIndex", ended.ravel()),
        *layers,
        block("Layer", 0, children=[element("Version", 100), *used]),
    ]


def _mapped(mapping: str, reference: str) -> list[FbxElement]:
    return [
        element("Version", 101),
        element("Name", ""),
        element("MappingInformationType", mapping),
        element("ReferenceInformationType", reference),
    ]


def _put_skin(
    document: FbxDocument, name: str, skin: JointSkin, geometry: Int64, stands: Sequence[tuple[Int64, FloatArray]]
) -> None:
    """Add a cluster for each joint: its vertices, its bind pose, and that of the node that carries the skeleton."""
    carrier = skin.carrier()
    associated = [] if carrier is None else [element("TransformAssociateModel", matrix(stands[carrier][1]))]
    about = [element("Version", 101), element("Link_DeformAcuracy", 50.0)]
    deformer = document.add("Deformer", name, "Skin", about, within=geometry)
    for joint, (key, stand) in enumerate(stands):
        vertices, columns = np.nonzero((skin.joints == joint) & (skin.weights > 0.0))
        parts = [
            element("Version", 100),
            element("UserData", "", ""),
            element("Indexes", vertices.astype(np.int32)),
            element("Weights", skin.weights[vertices, columns].astype(np.float64)),
            element("Transform", matrix(np.asarray(np.linalg.inv(stand), np.float64))),
            element("TransformLink", matrix(stand)),
            *associated,
        ]
        cluster = document.add("Deformer", name, "Cluster", parts, within=deformer, own_class="SubDeformer")
        document.connect(key, cluster)


def positions_in_file(points: FloatArray) -> FloatArray:
    """Positions (..., 3) in centimetres and file axes, of ``points`` (..., 3) in metres and world axes."""
    return np.asarray(CENTIMETRES_PER_METRE * points[..., WORLD_TO_FILE])


def _turned_vectors(directions: FloatArray) -> FloatArray:
    return np.ascontiguousarray(directions[..., WORLD_TO_FILE], np.float64).ravel()


def _turned(rotations: FloatArray) -> FloatArray:
    """Rotations (..., 3, 3) in file axes, of those in world axes."""
    return rotations[..., WORLD_TO_FILE, :][..., WORLD_TO_FILE]


def _placed(position: FloatArray, rotation: FloatArray) -> FloatArray:
    """Matrix (4, 4) of a position and a rotation."""
    placed = np.eye(4)
    placed[:3, :3], placed[:3, 3] = rotation, position
    return placed
