"""Containers of glTF 2.0: a JSON file with its buffers in data URIs or beside it, or one binary GLB."""

import struct
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from studio.core.errors import StudioError
from studio.io.json_record import Record
from studio.io.json_text import json_of
from studio.io.referenced_files import content_of, read_bytes

GLB_MAGIC = b"glTF"
_MOST_RECORDS = 1_000_000
_JSON, _BINARY = 0x4E4F534A, 0x004E4942
_READ = frozenset({
    "VRM", "VRMC_vrm", "VRMC_vrm_animation", "VRMC_materials_mtoon", "VRMC_springBone", "VRMC_node_constraint",
    "KHR_materials_unlit", "KHR_texture_transform", "KHR_mesh_quantization", "KHR_materials_emissive_strength",
    "KHR_materials_specular",
})  # fmt: skip
"""Extensions a file may require: those that are read, and those that only make it look finer."""


@dataclass(frozen=True)
class GltfFile:
    """JSON of a glTF file and the bytes of its buffers."""

    path: Path
    root: Record
    buffers: tuple[bytes, ...]

    @property
    def size(self) -> int:
        """Number of bytes in all buffers."""
        return sum(map(len, self.buffers))


def is_gltf(head: bytes) -> bool:
    """True if a file that begins with ``head`` is a glTF file."""
    return head[:4] == GLB_MAGIC or (head.lstrip(b"\xef\xbb\xbf \t\r\n")[:1] == b"{" and b'"asset"' in head)


def read_gltf(path: Path) -> GltfFile:
    """Content of a .gltf, .glb or .vrm file. Raises StudioError, which describes the damage."""
    content = read_bytes(path)
    text, binary = _chunks(content, path.name) if content[:4] == GLB_MAGIC else (content, None)
    root = Record(_parsed(text, path.name), path.name)
    version = root.inner("asset").text("version", "?")
    if not version.startswith("2."):
        raise StudioError(f"{path.name} is glTF of version {version}; the studio reads version 2. Export it as 2.0.")
    required = root.value.get("extensionsRequired", [])
    unknown = [str(name) for name in required if name not in _READ] if isinstance(required, list) else []
    if unknown:
        raise StudioError(
            f"{path.name} needs {', '.join(unknown[:4])}, which the studio does not read. Export it without compression"
            " and such extensions."
        )
    return GltfFile(path, root, tuple(_buffers(path, root, binary)))


def _chunks(content: bytes, name: str) -> tuple[bytes, bytes | None]:
    """JSON and binary chunk of a GLB."""
    if len(content) < 20:
        raise StudioError(f"{name} is cut off: it has {len(content)} bytes and no content. Copy it again.")
    version, length = struct.unpack_from("<II", content, 4)
    if version != 2:
        raise StudioError(f"{name} is a GLB of version {version}; the studio reads version 2. Export it as 2.0.")
    if length > len(content):
        raise StudioError(f"{name} is cut off: it should have {length} bytes and has {len(content)}. Copy it again.")
    found: dict[int, bytes] = {}
    at = 12
    while at + 8 <= length:
        size, kind = struct.unpack_from("<II", content, at)
        if at + 8 + size > length:
            raise StudioError(f"{name}, byte {at}: a part of {size} bytes ends after the file does. Export it again.")
        found.setdefault(kind, content[at + 8 : at + 8 + size])
        at += 8 + size
    if _JSON not in found:
        raise StudioError(f"{name} has no JSON part. Export it again.")
    return found[_JSON], found.get(_BINARY)


def _parsed(text: bytes, name: str) -> dict[str, Any]:
    if text.count(b"{") + text.count(b"[") > _MOST_RECORDS:
        raise StudioError(f"{name} holds more than {_MOST_RECORDS:,} records. Simplify the file.")
    try:
        record = json_of(text.removeprefix(b"\xef\xbb\xbf"))
    except ValueError as error:
        raise StudioError(f"{name} is not readable as JSON: {error}. Export it again.") from error
    if not isinstance(record, dict):
        raise StudioError(f"{name} holds no glTF: its JSON is not a record. Export it again.")
    return record


def _buffers(path: Path, root: Record, binary: bytes | None) -> list[bytes]:
    buffers: list[bytes] = []
    for index, record in enumerate(root.records("buffers")):
        length = record.whole("byteLength", 0)
        if "uri" in record:
            content = content_of(record.text("uri"), path, record.where)
        elif index == 0 and binary is not None:
            content = binary
        else:
            raise StudioError(f"{record.where}: its bytes are missing. Export the file again.")
        if len(content) < length:
            raise StudioError(f"{record.where}: it should have {length} bytes and has {len(content)}. Copy it again.")
        buffers.append(content[:length])
    return buffers
