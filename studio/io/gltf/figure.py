"""Interpretation of a glTF, GLB or VRM file as a figure: joints in the bind pose, and meshes bound to them."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.core.errors import StudioError
from studio.core.names import readable_name
from studio.io.figure.figure import MOST_FIGURE_JOINTS, NO_SKELETON_MESSAGE, Y_UP_AXES, Figure, rotations_of, scales_of
from studio.io.gltf.accessors import Accessors
from studio.io.gltf.container import GltfFile
from studio.io.gltf.meshes import MeshReader
from studio.io.gltf.nodes import Nodes, read_nodes
from studio.io.gltf.vrm import vrm_bones
from studio.io.json_record import Record

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class _Skin:
    """Skin of a glTF file."""

    joints: list[int]
    inverse_binds: FloatArray
    """Matrices (J, 4, 4) from mesh to joint."""


def figures_in(file: GltfFile) -> list[Figure]:
    """Figures of a file, one for each pose that may be its bind pose, the likeliest first.

    Raises StudioError if the file is damaged or holds no joints.
    """
    path = file.path
    accessors, nodes = Accessors(file), read_nodes(file.root)
    skins = [_skin(record, accessors, len(nodes.parents)) for record in file.root.records("skins")]
    bones = vrm_bones(file.root, len(nodes.parents))
    joints = _joints(skins, bones, nodes)
    if not joints:
        raise StudioError(f"{path.name} {NO_SKELETON_MESSAGE}")
    if len(joints) > MOST_FIGURE_JOINTS:
        raise StudioError(f"{path.name} has more than {MOST_FIGURE_JOINTS:,} joints. Export only the figure's own.")
    poses = [nodes.world]
    if skins and not bones:
        poses.insert(0, _bind_world(nodes, skins))
    reader = MeshReader(file, accessors, nodes, [(skin.joints, skin.inverse_binds) for skin in skins])
    skinned = {node for skin in skins for node in skin.joints} or set(joints)
    return [_figure(file, nodes, joints, world, bones, skinned, reader) for world in poses]


def _figure(
    file: GltfFile,
    nodes: Nodes,
    joints: list[int],
    world: FloatArray,
    bones: dict[str, int],
    skinned: set[int],
    reader: MeshReader,
) -> Figure:
    places = {node: index for index, node in enumerate(joints)}
    names = nodes.names()
    pieces = reader.pieces(world, places)
    return Figure(
        name=readable_name(file.path.stem),
        source=file.path.name,
        joint_names=tuple(names[node] for node in joints),
        parents=tuple(places.get(nodes.parents[node], -1) for node in joints),
        positions=world[joints, :3, 3],
        rotations=rotations_of(world[joints]),
        pieces=tuple(pieces),
        parts={part: names[node] for part, node in bones.items()},
        moves=bool(file.root.records("animations")),
        repairs=tuple(dict.fromkeys(reader.repairs)),
        kind="glTF",
        to_studio=Y_UP_AXES,
        scales=scales_of(world[joints]),
        bones=np.array([node in skinned for node in joints]),
    )


def _skin(record: Record, accessors: Accessors, node_count: int) -> _Skin:
    joints = record.indices("joints", node_count)
    if not joints or len(set(joints)) < len(joints):
        raise StudioError(f"{record.where}: it needs joints, and each of them once. Export the file again.")
    binds = np.tile(np.eye(4), (len(joints), 1, 1))
    index = record.index("inverseBindMatrices", accessors.count)
    if index is not None:
        read = accessors.numbers(index, 16).reshape(-1, 4, 4)
        if len(read) < len(joints):
            raise StudioError(f"{record.where}: it has {len(joints)} joints and {len(read)} bind matrices.")
        binds = np.swapaxes(read[: len(joints)], 1, 2)
    if (np.abs(np.linalg.det(binds[:, :3, :3])) < 1e-18).any():
        raise StudioError(f"{record.where}: an inverse bind matrix is singular, so its joint cannot be bound.")
    return _Skin(joints, binds)


def _joints(skins: list[_Skin], bones: dict[str, int], nodes: Nodes) -> list[int]:
    """Nodes that may be body parts, and all their ancestors, parents first; all nodes if the file has no skin."""
    wanted = {node for skin in skins for node in skin.joints} | set(bones.values())
    if not wanted:
        wanted = set(range(len(nodes.parents)))
    for node in list(wanted):
        while (node := nodes.parents[node]) >= 0 and node not in wanted:
            wanted.add(node)
    return [node for node in nodes.order if node in wanted]


def _bind_world(nodes: Nodes, skins: list[_Skin]) -> FloatArray:
    """World matrices (N, 4, 4) of the nodes in the bind pose of the skins; the first joint of the largest skin keeps
    its position.

    Nodes without a bind matrix keep their transform relative to their parent.
    """
    bound: dict[int, FloatArray] = {}
    for skin in sorted(skins, key=lambda skin: -len(skin.joints)):
        first = min(skin.joints, key=nodes.order.index)
        base = bound.get(first, nodes.world[first]) @ skin.inverse_binds[skin.joints.index(first)]
        for joint, inverse in zip(skin.joints, skin.inverse_binds, strict=True):
            bound.setdefault(joint, base @ np.linalg.inv(inverse))
    world = nodes.world.copy()
    for node in nodes.order:
        if node in bound:
            world[node] = bound[node]
        elif nodes.parents[node] >= 0:
            world[node] = world[nodes.parents[node]] @ nodes.local[node]
    return world
