"""Writer of a take as glTF 2.0: joints, skin and animation in one .glb, or one .gltf with its buffer inside."""

import base64
import json
import struct
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studio import __version__
from studio.core.mesh.appearance import EMISSIVE_MAP, METALLIC_ROUGHNESS_MAP, NORMAL_MAP, OCCLUSION_MAP, Material
from studio.core.rigs.joint_skin import JointSkin
from studio.core.rotations import from_matrix
from studio.core.stage.saved_camera import CAMERA_ASPECT, CAMERA_FAR_METRES, CAMERA_NEAR_METRES, VIEW_ANGLE, SavedCamera
from studio.io.atomic_write import write_pieces
from studio.io.export import Take, plain_material, skin_of
from studio.io.gltf.buffers import ARRAY_BUFFER_TARGET, ELEMENT_BUFFER_TARGET, Buffers
from studio.io.registry import Progress
from studio.io.takes.exported_stage import ExportedProp, ExportedStage

FloatArray = NDArray[np.float64]

_WORLD_TO_FILE = [1, 2, 0]
"""Y up, facing +Z: file x is world Y (left), y is Z (up), z is X (forward)."""
_TRAVELS = 1e-7
_EVEN = 1e-6
"""Relative difference of a scale that is one."""
_PIECE = 3 << 18
"""Bytes that are written between two reports of progress: whole groups of three, as base64 takes them."""


def write_take(path: Path, take: Take, progress: Progress) -> None:
    """Write joints, animation and the character's skin, or a figure of bones if it has none.

    The file is in metres, Y up, with one key per frame, interpolated linearly. Raises StudioError if it cannot be
    written.
    """
    scene = GltfScene(take.name, take.frame_rate, take.poses.frame_count)
    scene.add_take(take, lambda share: progress(0.8 * share, f"Writing {path.name}"))
    write_scene(path, scene, progress)


def write_stage(path: Path, stage: ExportedStage, progress: Progress) -> None:
    """Write all performers and props of a stage with common frames, each performer below a node with its name.

    Units, axes and keys are those of ``write_take``. Raises StudioError if the file cannot be written.
    """
    scene = GltfScene(stage.name, stage.frame_rate, stage.frame_count)
    for number, take in enumerate(stage.takes):

        def reported(share: float, number: int = number) -> None:
            progress(0.8 * (number + share) / len(stage.takes), f"Writing {path.name}")

        scene.add_take(take, reported, group=True)
    for prop in stage.props:
        scene.add_prop(prop)
    for camera in stage.cameras:
        scene.add_camera(camera)
    write_scene(path, scene, progress)


def write_scene(path: Path, scene: "GltfScene", progress: Progress) -> None:
    """Write a finished scene, as text if the suffix is ``.gltf``. Raises StudioError if it cannot be written."""
    content = scene.buffers.content
    content.extend(bytes(-len(content) % 4))
    root = scene.document() | {"buffers": [{"byteLength": len(content)}]}
    parts = _gltf if path.suffix.lower() == ".gltf" else _glb
    write_pieces(path, _with_progress(parts(root, content), len(content), path.name, progress))
    progress(1.0, f"Wrote {path.name}")


def _with_progress(
    pieces: Iterable[bytes | memoryview], size: int, name: str, progress: Progress
) -> Iterator[bytes | memoryview]:
    """Pieces unchanged; progress towards about ``size`` bytes is reported after each."""
    done = 0
    for piece in pieces:
        progress(min(0.8 + 0.2 * done / size, 1.0), f"Writing {name}")
        yield piece
        done += len(piece)


_MAP_SLOTS = {
    NORMAL_MAP: "normalTexture",
    EMISSIVE_MAP: "emissiveTexture",
    OCCLUSION_MAP: "occlusionTexture",
    METALLIC_ROUGHNESS_MAP: "metallicRoughnessTexture",
}


class GltfScene:
    """glTF document under construction: nodes, meshes, skins, materials, and one animation of all of them."""

    def __init__(self, name: str, frame_rate: float, frame_count: int) -> None:
        self.buffers = Buffers()
        self.extensions: dict[str, Any] = {}
        """Records of extensions by name, written at the root."""
        self._name = name
        self._seconds = np.arange(frame_count) / frame_rate
        self._times: int | None = None
        self._roots: list[int] = []
        self._images: dict[bytes, int] = {}
        self._lists: dict[str, list[dict[str, Any]]] = {
            name: [] for name in ("nodes", "meshes", "skins", "materials", "images", "samplers", "channels", "cameras")
        }

    def document(self) -> dict[str, Any]:
        """JSON document without the buffer."""
        lists = {name: records for name, records in self._lists.items() if records}
        animation = {"name": self._name, "samplers": lists.pop("samplers"), "channels": lists.pop("channels")}
        root: dict[str, Any] = {
            "asset": {"version": "2.0", "generator": f"Morpho Studio {__version__}"},
            "scene": 0,
            "scenes": [{"nodes": self._roots}],
            **lists,
            "animations": [animation],
        }
        if self.extensions:
            root |= {"extensionsUsed": list(self.extensions), "extensions": self.extensions}
        if images := lists.get("images"):
            root["samplers"] = [{}]
            root["textures"] = [{"source": index, "sampler": 0} for index in range(len(images))]
        return root | {"bufferViews": self.buffers.views, "accessors": self.buffers.accessors}

    def add_take(self, take: Take, progress: Any, *, group: bool = False) -> None:
        """Add joints, skin and animation; if ``group``, the joints are below a node with the take's name."""
        skin = skin_of(take)
        joints = self._add_joints(take, skin)
        top = self._add("nodes", {"name": take.name, "children": joints[:1]}) if group else joints[0]
        self._roots.append(top)
        if len(skin.triangles):
            materials = skin.appearance.materials if skin.appearance else (plain_material(take),)
            mesh = {"name": take.name, "primitives": _primitives(skin, self.buffers, self._add_materials(materials))}
            bones = _bones(skin)
            bound = {
                "joints": [joints[bone] for bone in bones],
                "inverseBindMatrices": _inverse_binds(skin, self.buffers),
                "skeleton": joints[bones[0]],
            }
            shown = {"name": take.name, "mesh": self._add("meshes", mesh), "skin": self._add("skins", bound)}
            self._roots.append(self._add("nodes", shown))
        self._animate_joints(take, skin, joints, progress)

    def add_motion(self, take: Take, progress: Any) -> None:
        """Add joints and animation without a mesh."""
        skin = skin_of(take)
        joints = self._add_joints(take, skin)
        self._roots.append(joints[0])
        self._animate_joints(take, skin, joints, progress)

    def add_prop(self, prop: ExportedProp) -> None:
        """Add a mesh that moves as a whole."""
        surface, first = prop.surface, self._add_materials((prop.material,))
        primitive = {
            "attributes": {
                "POSITION": self.buffers.add(
                    surface.vertices[:, _WORLD_TO_FILE], "f4", ARRAY_BUFFER_TARGET, bounds=True
                ),
                "NORMAL": self.buffers.add(_unit(surface.normals[:, _WORLD_TO_FILE]), "f4", ARRAY_BUFFER_TARGET),
            },
            "indices": self.buffers.add(surface.triangles.ravel(), "u4", ELEMENT_BUFFER_TARGET),
            "material": first,
        }
        mesh = self._add("meshes", {"name": prop.name, "primitives": [primitive]})
        places = prop.places[:, _WORLD_TO_FILE].astype(np.float32)
        turns = _unit(prop.rotations[:, [*_WORLD_TO_FILE, 3]])
        begun = {"translation": places[0].tolist(), "rotation": turns[0].tolist()}
        node = self._add("nodes", {"name": prop.name, "mesh": mesh, **begun})
        self._roots.append(node)
        if not prop.is_still:
            self._animate(node, "rotation", turns)
            self._animate(node, "translation", places)

    def add_camera(self, camera: SavedCamera) -> None:
        """Add a node with a camera, which looks along -Z of its own axes, as in the studio."""
        placement = camera.placement
        if placement.parallel:
            tall = placement.half_height
            lens: dict[str, Any] = {
                "xmag": CAMERA_ASPECT * tall,
                "ymag": tall,
                "znear": CAMERA_NEAR_METRES,
                "zfar": CAMERA_FAR_METRES,
            }
            record = {"name": camera.name, "type": "orthographic", "orthographic": lens}
        else:
            lens = {"yfov": VIEW_ANGLE, "aspectRatio": CAMERA_ASPECT, "znear": CAMERA_NEAR_METRES}
            record = {"name": camera.name, "type": "perspective", "perspective": lens}
        node = {
            "name": camera.name,
            "camera": self._add("cameras", record),
            "translation": placement.eye[_WORLD_TO_FILE].tolist(),
            "rotation": from_matrix(placement.axes.T[_WORLD_TO_FILE]).tolist(),
        }
        self._roots.append(self._add("nodes", node))

    def _add(self, kind: str, record: dict[str, Any]) -> int:
        self._lists[kind].append(record)
        return len(self._lists[kind]) - 1

    def _animate(self, node: int, path: str, values: NDArray[Any]) -> None:
        if self._times is None:
            self._times = self.buffers.add(self._seconds, "f4", bounds=True)
        sampler = {"input": self._times, "interpolation": "LINEAR", "output": self.buffers.add(values, "f4")}
        self._add("channels", {"sampler": self._add("samplers", sampler), "target": {"node": node, "path": path}})

    def _add_joints(self, take: Take, skin: JointSkin) -> list[int]:
        first = len(self._lists["nodes"])
        for node, children in zip(_joint_nodes(take, skin), take.skeleton.children, strict=True):
            self._add("nodes", node | {"children": [first + child for child in children]} if children else node)
        return list(range(first, first + take.skeleton.joint_count))

    def _animate_joints(self, take: Take, skin: JointSkin, joints: list[int], progress: Any) -> None:
        """Add a key at every frame for every bone that rotates, and for every joint that moves."""
        skeleton, poses = take.skeleton, take.poses
        travels = np.abs(poses.local_translations - skeleton.offsets).max(axis=(0, 2)) > _TRAVELS
        bones, units = set(_bones(skin)), skin.local_scales(skeleton.parents)[1]
        for joint, node in enumerate(joints):
            progress(joint / skeleton.joint_count)
            if joint in bones and (not skeleton.end_sites[joint] or joint == 0):
                self._animate(node, "rotation", _unit(poses.local_rotations[:, joint][:, [*_WORLD_TO_FILE, 3]]))
            if travels[joint] or (joint in bones and joint == 0):
                places = poses.local_translations[:, joint][:, _WORLD_TO_FILE] / units[joint]
                self._animate(node, "translation", places)

    def _add_materials(self, materials: tuple[Material, ...]) -> int:
        """Add materials, and return the index of the first."""
        first = len(self._lists["materials"])
        for material in materials:
            surface: dict[str, Any] = {
                "baseColorFactor": [*material.linear_colour, 1.0],
                "metallicFactor": material.metallic,
                "roughnessFactor": material.roughness,
            }
            if material.texture is not None:
                surface["baseColorTexture"] = {"index": self._image(material.texture.tobytes())}
            record: dict[str, Any] = {"name": material.name, "pbrMetallicRoughness": surface}
            for name, picture in material.maps.items():
                if name in _MAP_SLOTS:
                    holder = surface if name == METALLIC_ROUGHNESS_MAP else record
                    holder[_MAP_SLOTS[name]] = {"index": self._image(picture.tobytes())}
            if any(material.emission):
                record["emissiveFactor"] = list(material.emission)
            if material.two_sided:
                record["doubleSided"] = True
            if material.cut_out:
                record["alphaMode"] = "MASK"
            self._add("materials", record)
        return first

    def _image(self, content: bytes) -> int:
        """Index of a picture, which is added only once."""
        if content not in self._images:
            kind = "image/png" if content.startswith(b"\x89PNG") else "image/jpeg"
            image = {"bufferView": self.buffers.add_bytes(content), "mimeType": kind}
            self._images[content] = self._add("images", image)
        return self._images[content]


def _bones(skin: JointSkin) -> list[int]:
    """Joints of the skin, without nodes that only carry bones."""
    return list(range(len(skin.bind_positions))) if skin.bones is None else np.flatnonzero(skin.bones).tolist()


def _joint_nodes(take: Take, skin: JointSkin) -> list[dict[str, Any]]:
    """Nodes of the joints in the skeleton's zero pose."""
    scales, units = skin.local_scales(take.skeleton.parents)
    offsets = (take.skeleton.offsets[:, _WORLD_TO_FILE] / units[:, None]).astype(np.float32)
    nodes: list[dict[str, Any]] = [
        {"name": name, "translation": offset}
        for name, offset in zip(take.skeleton.names, offsets.tolist(), strict=True)
    ]
    if take.rest_rotations is not None:
        turns = _unit(take.rest_rotations[:, [*_WORLD_TO_FILE, 3]]).astype(np.float32)
        nodes = [node | {"rotation": turn} for node, turn in zip(nodes, turns.tolist(), strict=True)]
    scaled = ~np.isclose(scales, 1.0, rtol=_EVEN, atol=0.0)
    return [
        node | {"scale": [scale] * 3} if is_scaled else node
        for node, scale, is_scaled in zip(nodes, scales.tolist(), scaled.tolist(), strict=True)
    ]


def _primitives(skin: JointSkin, buffers: Buffers, first: int) -> list[dict[str, Any]]:
    """One primitive for each material, numbered from ``first``, all over the same vertices."""
    count, look = len(skin.vertices), skin.appearance
    space = _mesh_space(skin)
    points = (skin.vertices[:, _WORLD_TO_FILE] - space[:3, 3]) @ np.linalg.inv(space[:3, :3]).T
    attributes = {
        "POSITION": buffers.add(points, "f4", ARRAY_BUFFER_TARGET, bounds=True),
        "NORMAL": buffers.add(_unit(skin.normals[:, _WORLD_TO_FILE] @ space[:3, :3]), "f4", ARRAY_BUFFER_TARGET),
    }
    place = np.zeros(len(skin.bind_positions), np.int64)
    place[_bones(skin)] = np.arange(len(_bones(skin)))
    joints = np.where(skin.weights > 0.0, place[skin.joints], 0)
    for start in range(0, skin.joints.shape[1], 4):
        gap = ((0, 0), (0, max(start + 4 - skin.joints.shape[1], 0)))
        for name, values, kind in (("JOINTS", joints, "u2"), ("WEIGHTS", skin.weights, "f4")):
            part = np.pad(values[:, start : start + 4], gap)
            attributes[f"{name}_{start // 4}"] = buffers.add(part, kind, ARRAY_BUFFER_TARGET)
    if look and any(material.pictures for material in look.materials):
        places = look.coordinates * [1.0, -1.0] + [0.0, 1.0]  # glTF counts downwards
        attributes["TEXCOORD_0"] = buffers.add(places, "f4", ARRAY_BUFFER_TARGET)
    kind = "u2" if count < 65535 else "u4"
    materials = look.triangle_materials if look else np.zeros(len(skin.triangles), dtype=np.int32)
    return [
        {
            "attributes": attributes,
            "indices": buffers.add(skin.triangles[materials == material].ravel(), kind, ELEMENT_BUFFER_TARGET),
            "material": first + int(material),
        }
        for material in np.unique(materials)
    ]


def _inverse_binds(skin: JointSkin, buffers: Buffers) -> int:
    """Inverse bind matrices, (J, 4, 4) mesh to bone, stored by columns as in glTF."""
    matrices = np.linalg.inv(_bind_matrices(skin)[_bones(skin)]) @ _mesh_space(skin)
    return buffers.add(np.swapaxes(matrices, 1, 2) + 0.0, "f4")


def _bind_matrices(skin: JointSkin) -> FloatArray:
    """Matrices (J, 4, 4) from the joints to the file's world."""
    matrices = np.tile(np.eye(4), (len(skin.bind_positions), 1, 1))
    matrices[:, :3, :3] = skin.bind_rotations[:, _WORLD_TO_FILE][:, :, _WORLD_TO_FILE]
    if skin.bind_scales is not None:
        matrices[:, :3, :3] *= skin.bind_scales[:, None, None]
    matrices[:, :3, 3] = skin.bind_positions[:, _WORLD_TO_FILE]
    return matrices


def _mesh_space(skin: JointSkin) -> FloatArray:
    """Axes (4, 4) of the mesh in the file's world; Blender takes them for those of the node that carries
    the skeleton.
    """
    carrier = skin.carrier()
    return np.eye(4) if carrier is None else np.asarray(_bind_matrices(skin)[carrier])


def _unit(vectors: FloatArray) -> FloatArray:
    """Vectors scaled to unit length; zero vectors become up vectors."""
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    up = np.zeros_like(vectors)
    up[:, 1] = 1.0
    return np.where(lengths > 1e-9, vectors / np.where(lengths > 1e-9, lengths, 1.0), up)


def _glb(root: dict[str, Any], binary: bytearray) -> Iterator[bytes | memoryview]:
    text = _json(root)
    text += b" " * (-len(text) % 4)
    yield struct.pack("<4sII", b"glTF", 2, 12 + 8 + len(text) + 8 + len(binary))
    yield struct.pack("<I4s", len(text), b"JSON") + text
    yield struct.pack("<I4s", len(binary), b"BIN\0")
    yield from _pieces(binary)


def _gltf(root: dict[str, Any], binary: bytearray) -> Iterator[bytes]:
    """Text with the binary data inside as a data URI."""
    root["buffers"][0]["uri"] = "data:application/octet-stream;base64,"
    # No name can hold what is sought: quotes within a name are escaped.
    before, begin, after = _json(root).partition(b'"uri":"data:application/octet-stream;base64,')
    yield before + begin
    yield from map(base64.b64encode, _pieces(binary))
    yield after


def _pieces(binary: bytearray) -> Iterator[memoryview]:
    return (memoryview(binary)[first : first + _PIECE] for first in range(0, len(binary), _PIECE))


def _json(root: dict[str, Any]) -> bytes:
    return json.dumps(root, separators=(",", ":"), ensure_ascii=False, allow_nan=False).encode()
