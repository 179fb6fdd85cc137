"""A take as glTF 2.0: joints, skin and animation in one .glb, or one .gltf with its buffer inside."""

import base64
import json
import struct
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studio import __version__
from studio.core.mesh.appearance import Material
from studio.core.mesh.joint_skin import JointSkin
from studio.io.export import Take, plain_material, skin_of
from studio.io.gltf.buffers import TRIANGLES, VERTICES, Buffers
from studio.io.registry import Progress
from studio.io.replacing import write_pieces

FloatArray = NDArray[np.float64]

_WORLD_TO_FILE = [1, 2, 0]
"""Y up, facing +Z: file x is world Y (left), y is Z (up), z is X (forward)."""
_TRAVELS = 1e-7
_PIECE = 3 << 18
"""Bytes that are written between two reports of progress: whole groups of three, as base64 takes them."""


def write_take(path: Path, take: Take, progress: Progress) -> None:
    """Write joints, animation and the character's skin, or a figure of bones where there is none.

    Metres, Y up; one key a frame, interpolated linearly. Raises StudioError when the file cannot be written.
    """
    buffers = Buffers()
    skin = skin_of(take)
    root = _document(take, skin, buffers, lambda share: progress(0.8 * share, f"Writing {path.name}"))
    buffers.content.extend(bytes(-len(buffers.content) % 4))
    root["buffers"] = [{"byteLength": len(buffers.content)}]
    parts = _glb if path.suffix.lower() == ".glb" else _gltf
    write_pieces(path, _told(parts(root, buffers.content), len(buffers.content), path.name, progress))
    progress(1.0, f"Wrote {path.name}")


def _told(
    pieces: Iterable[bytes | memoryview], size: int, name: str, progress: Progress
) -> Iterator[bytes | memoryview]:
    """The same pieces, telling how far they are on the way to about ``size`` bytes."""
    done = 0
    for piece in pieces:
        progress(min(0.8 + 0.2 * done / size, 1.0), f"Writing {name}")
        yield piece
        done += len(piece)


def _document(take: Take, skin: JointSkin, buffers: Buffers, progress: Any) -> dict[str, Any]:
    joints = take.skeleton.joint_count
    mesh: dict[str, Any] = {"name": take.name, "mesh": 0, "skin": 0}
    root: dict[str, Any] = {
        "asset": {"version": "2.0", "generator": f"Morpho Studio {__version__}"},
        "scene": 0,
        "scenes": [{"nodes": [0, joints]}],
        "nodes": [*_joint_nodes(take), mesh],
        "meshes": [{"name": take.name, "primitives": _primitives(skin, buffers)}],
        "skins": [{"joints": list(range(joints)), "inverseBindMatrices": _inverse_binds(skin, buffers), "skeleton": 0}],
        "animations": [_animation(take, buffers, progress)],
    }
    materials = skin.appearance.materials if skin.appearance else (plain_material(take),)
    root["materials"], images = _materials(materials, buffers)
    if images:
        root["images"] = images
        root["samplers"] = [{}]
        root["textures"] = [{"source": place, "sampler": 0} for place in range(len(images))]
    if not root["meshes"][0]["primitives"]:  # a single joint
        for key in ("meshes", "skins", "materials"):
            del root[key]
        root["nodes"].pop()
        root["scenes"][0]["nodes"].pop()
    return root | {"bufferViews": buffers.views, "accessors": buffers.accessors}


def _joint_nodes(take: Take) -> list[dict[str, Any]]:
    """The joints as they stand in the skeleton's zero pose."""
    offsets = take.skeleton.offsets[:, _WORLD_TO_FILE].astype(np.float32)
    nodes = []
    for name, offset, children in zip(take.skeleton.names, offsets.tolist(), take.skeleton.children, strict=True):
        node: dict[str, Any] = {"name": name, "translation": offset}
        nodes.append(node | {"children": list(children)} if children else node)
    return nodes


def _primitives(skin: JointSkin, buffers: Buffers) -> list[dict[str, Any]]:
    """One for each material, all over the same vertices."""
    if not len(skin.triangles):
        return []
    count, look = len(skin.vertices), skin.appearance
    attributes = {
        "POSITION": buffers.add(skin.vertices[:, _WORLD_TO_FILE], "f4", VERTICES, bounds=True),
        "NORMAL": buffers.add(_unit(skin.normals[:, _WORLD_TO_FILE]), "f4", VERTICES),
        "JOINTS_0": buffers.add(skin.joints, "u2", VERTICES),
        "WEIGHTS_0": buffers.add(skin.weights, "f4", VERTICES),
    }
    if look and any(material.texture is not None for material in look.materials):
        places = look.coordinates * [1.0, -1.0] + [0.0, 1.0]  # glTF counts downwards
        attributes["TEXCOORD_0"] = buffers.add(places, "f4", VERTICES)
    kind = "u2" if count < 65535 else "u4"
    materials = look.triangle_materials if look else np.zeros(len(skin.triangles), dtype=np.int32)
    return [
        {
            "attributes": attributes,
            "indices": buffers.add(skin.triangles[materials == material].ravel(), kind, TRIANGLES),
            "material": int(material),
        }
        for material in np.unique(materials)
    ]


def _inverse_binds(skin: JointSkin, buffers: Buffers) -> int:
    """World to joint at the moment of binding, (J, 4, 4), stored by columns as glTF has matrices."""
    turned = np.swapaxes(skin.bind_rotations[:, _WORLD_TO_FILE][:, :, _WORLD_TO_FILE], 1, 2)
    matrices = np.tile(np.eye(4), (len(turned), 1, 1))
    matrices[:, :3, :3] = turned
    matrices[:, :3, 3] = -np.einsum("jik,jk->ji", turned, skin.bind_positions[:, _WORLD_TO_FILE])
    return buffers.add(np.swapaxes(matrices, 1, 2) + 0.0, "f4")


def _animation(take: Take, buffers: Buffers, progress: Any) -> dict[str, Any]:
    """A key a frame for every joint that turns, and for every one that travels."""
    skeleton, poses = take.skeleton, take.poses
    times = buffers.add(np.arange(poses.frame_count) / take.frame_rate, "f4", bounds=True)
    samplers: list[dict[str, Any]] = []
    channels: list[dict[str, Any]] = []

    def animate(joint: int, path: str, values: FloatArray) -> None:
        channels.append({"sampler": len(samplers), "target": {"node": joint, "path": path}})
        samplers.append({"input": times, "interpolation": "LINEAR", "output": buffers.add(values, "f4")})

    travels = np.abs(poses.local_translations - skeleton.offsets).max(axis=(0, 2)) > _TRAVELS
    for joint in range(skeleton.joint_count):
        progress(joint / skeleton.joint_count)
        if not skeleton.end_sites[joint] or joint == 0:
            animate(joint, "rotation", _unit(poses.local_rotations[:, joint][:, [*_WORLD_TO_FILE, 3]]))
        if travels[joint] or joint == 0:
            animate(joint, "translation", poses.local_translations[:, joint][:, _WORLD_TO_FILE])
    return {"name": take.name, "samplers": samplers, "channels": channels}


def _materials(materials: tuple[Material, ...], buffers: Buffers) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
    """The materials, and the pictures that they show."""
    records: list[dict[str, Any]] = []
    images: list[dict[str, Any]] = []
    for material in materials:
        surface: dict[str, Any] = {"baseColorFactor": [*material.linear_colour, 1.0], "metallicFactor": 0.0}
        if material.texture is not None:
            content = material.texture.tobytes()
            surface["baseColorTexture"] = {"index": len(images)}
            kind = "image/png" if content.startswith(b"\x89PNG") else "image/jpeg"
            images.append({"bufferView": buffers.add_bytes(content), "mimeType": kind})
        record: dict[str, Any] = {"name": material.name, "pbrMetallicRoughness": surface}
        records.append(record | {"doubleSided": True} if material.two_sided else record)
    return records, images


def _unit(vectors: FloatArray) -> FloatArray:
    """Vectors of length 1; those without a length point up."""
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
    """Text, in which the binary side stands as text."""
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
