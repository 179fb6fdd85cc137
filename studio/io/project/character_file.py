"""Character files: a JSON file with name, colour and build, and beside it the mesh as .npz."""

import hashlib
import json
import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from functools import lru_cache
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studio.core.body.growth import KeyedProportions
from studio.core.body.morphology import Morphology, Proportions
from studio.core.errors import StudioError
from studio.core.mannequin.tailoring import tailored_character
from studio.core.mesh.appearance import Appearance, Material
from studio.core.mesh.character import Character
from studio.core.mesh.hand_shapes import HandShapes
from studio.core.mesh.rig import Rig, RigFile
from studio.core.mesh.skin import Blending, SkinnedMesh
from studio.io.atomic_write import atomic_replacements
from studio.io.figure.textures import checked_picture
from studio.io.importing import ImportOptions
from studio.io.json_text import json_of
from studio.io.npy import arrays_of
from studio.io.project.value_json import MemberCodec, from_json, to_json
from studio.io.referenced_files import path_beside, read_bytes
from studio.io.registry import Progress, ReadCharacter
from studio.resources_folder import resources_folder

CHARACTER_FORMAT = "morpho-studio character"
CHARACTER_VERSION = 1
_LIMIT = 200_000_000
_DAMAGE = (KeyError, ValueError, TypeError, ArithmeticError)
"""Errors that arrays raise that are no mesh."""
_MEMBERS = ("vertices", "normals", "centres", "triangles", "segments", "weights")
_RIG = ("parents", "positions", "rotations", "segments", "joints", "weights")
_RIG_FILE = ("rotation", "position", "scales", "bones")
_LOOK = ("triangle_materials", "coordinates")


def is_character(head: bytes) -> bool:
    """True if a file that begins with ``head`` is a character file of the studio."""
    return CHARACTER_FORMAT.encode() in head


def load_character(path: Path, _options: ImportOptions, progress: Progress) -> ReadCharacter:
    """Character for the registry of formats; a file of the studio needs no guesses."""
    progress(0.0, f"Reading {path.name}")
    return ReadCharacter(read_character(path))


def save_character(path: Path, character: Character, progress: Progress) -> None:
    """Write a character for the registry of formats."""
    progress(0.0, f"Writing {path.name}")
    write_character(character, path)


def write_character(character: Character, path: Path) -> None:
    """Write ``path`` (.json) and the mesh beside it under the same name (.npz); both or none. Raises StudioError."""
    mesh = mesh_bytes(character.skin)
    mesh_path = path.with_suffix(".npz")
    record = {
        "format": CHARACTER_FORMAT,
        "version": CHARACTER_VERSION,
        "name": character.name,
        "colour": character.colour,
        "mesh": mesh_path.name,
        "sha256": hashlib.sha256(mesh).hexdigest(),
        "proportions": _proportions_record(character.proportions),
        "blending": character.blending.value,
        "grip": character.grip,
        "materials": _material_records(character.skin.appearance),
        "build": character.build.to_json(),
    }
    with atomic_replacements(mesh_path, path) as (mesh_part, part):
        mesh_part.write_bytes(mesh)
        part.write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8", newline="\n")


def read_character(path: Path) -> Character:
    """Character in a .json file. Raises StudioError, which names the file and the member that is wrong."""
    record = _read_record(path)
    mesh_path = path_beside(_member(record, "mesh", str, path), path, f"{path}, mesh")
    content = read_bytes(mesh_path, _LIMIT)
    if hashlib.sha256(content).hexdigest() != record.get("sha256"):
        raise StudioError(f"{mesh_path}: this is not the mesh that {path.name} was written with. Copy both again.")
    try:
        build = Morphology.from_json(_member(record, "build", dict, path))
        proportions = _proportions_of(record.get("proportions", {}))
        blending, grip = Blending(record.get("blending", Blending.LINEAR)), float(record.get("grip", 0.0))
    except (ValueError, TypeError, ArithmeticError, LookupError) as error:
        raise StudioError(f"{path}: the measures are damaged. {error}") from error
    skin = read_mesh(content, str(mesh_path), record.get("materials", []))
    if not skin.fits_body(build.layout.segment_count):
        raise StudioError(f"{mesh_path}: 'segments' names a segment that this body does not have.")
    name, colour = (_member(record, member, str, path) for member in ("name", "colour"))
    try:
        return Character(name, colour, build, skin, proportions, blending, grip)
    except ValueError as error:
        raise StudioError(f"{path}: {error}") from error


def _proportions_record(proportions: Proportions | KeyedProportions) -> dict[str, Any]:
    if isinstance(proportions, KeyedProportions):
        record = to_json(proportions, _NO_ARRAYS)
        return {name: record[name] for name in ("times", "values", "tangents", "before", "after") if name in record}
    return asdict(proportions)


def _proportions_of(record: dict[str, Any]) -> Proportions | KeyedProportions:
    """Factors, or ``times`` in seconds and as many ``values``, each of them factors. Raises ValueError or TypeError."""
    if "times" in record:
        keyed: KeyedProportions = from_json(record, KeyedProportions, _NO_ARRAYS)
        return keyed
    return Proportions(**record)


def _no_array(_array: object) -> Any:
    raise ValueError("an array is not expected here.")


_NO_ARRAYS = MemberCodec(_no_array, _no_array)


@lru_cache(maxsize=1)
def bundled_characters() -> Mapping[str, Character]:
    """Bundled characters by file name without suffix, in the order of their index."""
    folder = resources_folder() / "characters"
    order = json.loads((folder / "index.json").read_text(encoding="utf-8"))
    return {name: read_character(folder / f"{name}.json") for name in order}


def actor_character(name: str, body: Morphology, colour: str = "#7FB4E6") -> Character:
    """Character with the measures of an actor, in the skin of an average bundled body."""
    return tailored_character(name, colour, body, [bundled_characters()[pattern] for pattern in ("tall_man", "child")])


def mesh_bytes(mesh: SkinnedMesh) -> bytes:
    """Bytes of an .npz file with a skinned mesh; the same mesh always gives the same bytes."""
    arrays = {name: getattr(mesh, name) for name in _MEMBERS}
    if mesh.stance is not None:
        arrays["stance"] = mesh.stance
    if mesh.hands is not None:
        arrays |= {"hand_vertices": mesh.hands.vertices, "hand_normals": mesh.hands.normals}
    if mesh.rig is not None:
        arrays |= {f"rig_{name}": getattr(mesh.rig, name) for name in _RIG}
        arrays["rig_names"] = np.frombuffer(json.dumps(mesh.rig.names).encode(), dtype=np.uint8)
        if (file := mesh.rig.file) is not None:
            arrays |= {f"rig_file_{name}": getattr(file, name) for name in _RIG_FILE}
            arrays["rig_file_format"] = np.frombuffer(json.dumps(file.format).encode(), dtype=np.uint8)
    if mesh.appearance is not None:
        arrays |= {name: getattr(mesh.appearance, name) for name in _LOOK}
        arrays |= {f"texture_{index}": picture for index, picture in enumerate(_pictures(mesh.appearance))}
    for name in ("triangles", "segments"):
        arrays[name] = arrays[name].astype(np.min_scalar_type(int(arrays[name].max())))
    buffer = BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, array in arrays.items():
            entry = BytesIO()
            np.lib.format.write_array(entry, np.ascontiguousarray(array), allow_pickle=False)
            archive.writestr(zipfile.ZipInfo(f"{name}.npy"), entry.getvalue(), zipfile.ZIP_DEFLATED)
    return buffer.getvalue()


def read_mesh(content: bytes, source: str, materials: Sequence[Any] = ()) -> SkinnedMesh:
    """Skinned mesh in the bytes of an .npz file (see ``mesh_bytes``); ``materials`` are their records in the JSON file.

    Raises StudioError, which names ``source`` and the damaged member.
    """
    try:
        file = arrays_of(content, _LIMIT)
        look = _appearance(file, materials) if len(materials) else None
        hands = HandShapes(file["hand_vertices"], file["hand_normals"]) if "hand_vertices" in file else None
        members = {name: file[name] for name in _MEMBERS}
        return SkinnedMesh(**members, stance=file.get("stance"), appearance=look, hands=hands, rig=_rig(file))
    except _DAMAGE as error:
        raise StudioError(f"{source}: the mesh is damaged. {error}") from error


def _rig(file: Mapping[str, Any]) -> Rig | None:
    if "rig_names" not in file:
        return None
    names, origin = json_of(file["rig_names"].astype(np.uint8).tobytes()), None
    if "rig_file_format" in file:
        name_of_format = str(json_of(file["rig_file_format"].astype(np.uint8).tobytes()))
        origin = RigFile(name_of_format, **{name: file[f"rig_file_{name}"] for name in _RIG_FILE})
    return Rig(tuple(map(str, names)), **{name: file[f"rig_{name}"] for name in _RIG}, file=origin)


def _pictures(look: Appearance) -> list[NDArray[np.uint8]]:
    """Pictures of an appearance, each once."""
    return list({id(picture): picture for each in look.materials for picture in each.pictures}.values())


def _material_records(look: Appearance | None) -> list[dict[str, Any]]:
    if look is None:
        return []
    places = {id(picture): index for index, picture in enumerate(_pictures(look))}
    return [
        {
            "name": each.name,
            "colour": each.colour,
            "texture": None if each.texture is None else places[id(each.texture)],
            "two_sided": each.two_sided,
            "cut_out": each.cut_out,
            "metallic": each.metallic,
            "roughness": each.roughness,
            "emission": list(each.emission),
            "maps": {name: places[id(picture)] for name, picture in each.maps.items()},
        }
        for each in look.materials
    ]


def _appearance(file: Mapping[str, Any], records: Sequence[Any]) -> Appearance:
    pictures: dict[int, NDArray[np.uint8]] = {}
    materials = []

    def picture(index: int) -> NDArray[np.uint8]:
        if index not in pictures:
            pictures[index] = checked_picture(file[f"texture_{int(index)}"].astype(np.uint8).tobytes())
        return pictures[index]

    for record in records:
        red, green, blue = map(float, record.get("emission", (0.0, 0.0, 0.0)))
        materials.append(
            Material(
                str(record["name"]),
                str(record["colour"]),
                None if record["texture"] is None else picture(record["texture"]),
                bool(record["two_sided"]),
                bool(record.get("cut_out", False)),
                float(record.get("metallic", 0.0)),
                float(record.get("roughness", 1.0)),
                (red, green, blue),
                {str(name): picture(place) for name, place in dict(record.get("maps", {})).items()},
            )
        )
    return Appearance(tuple(materials), *(file[name] for name in _LOOK))


def _read_record(path: Path) -> dict[str, Any]:
    try:
        record = json_of(read_bytes(path))
    except ValueError as error:
        raise StudioError(f"{path}: not a character file. {error}") from error
    if not isinstance(record, dict) or record.get("format") != CHARACTER_FORMAT:
        raise StudioError(f"{path}: not a character file: its 'format' is not '{CHARACTER_FORMAT}'.")
    if record.get("version") != CHARACTER_VERSION:
        raise StudioError(f"{path}: version {record.get('version')} is not known here. Install a newer Morpho Studio.")
    return record


def _member(record: dict[str, Any], name: str, kind: type, path: Path) -> Any:
    value = record.get(name)
    if not isinstance(value, kind):
        raise StudioError(f"{path}: '{name}' is missing or of the wrong kind.")
    return value
