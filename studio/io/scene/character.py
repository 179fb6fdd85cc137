"""Interpretation of a scene as a character: its joints and its skin in the bind pose."""

import json
from pathlib import Path, PureWindowsPath
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from studio.core.errors import StudioError
from studio.core.mesh.appearance import Material
from studio.core.names import readable_name
from studio.io.figure.body import character_of
from studio.io.figure.figure import (
    MOST_VERTICES,
    Y_UP_AXES,
    Figure,
    FloatArray,
    IntArray,
    MeshPiece,
    rotations_of,
    scales_of,
)
from studio.io.figure.textures import checked_picture
from studio.io.gltf.materials import hex_colour
from studio.io.importing import ImportOptions
from studio.io.meshes.shapes import smooth_normals, unit
from studio.io.referenced_files import content_of, path_beside
from studio.io.registry import Progress, ReadCharacter
from studio.io.scene.scene_reader import Arrays

_AXES = {
    ("FBX", "Y"): Y_UP_AXES,
    ("FBX", "Z"): np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]),
    ("USD", "Y"): np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]]),
    ("USD", "Z"): np.eye(3),
}
"""Rotation of a file's axes to the studio's, as programs with Z up import it and what the studio writes of its kind."""
_PICTURE_FOLDERS = ("textures", "Textures", "tex", "images")
MOST_SCENE_INFLUENCES = 8
"""Maximum number of joints to which a vertex is bound."""
CHARACTER_ADVICE = "Export the character as GLB from the program that made it."


def character_in(arrays: Arrays, path: Path, options: ImportOptions, progress: Progress) -> ReadCharacter:
    """Character in the arrays read from ``path`` by the child process. Raises StudioError."""
    progress(0.5, f"Finding the body in {path.name}")
    try:
        about = json.loads(arrays["about"].tobytes())
        if not all(np.isfinite(array).all() for name, array in arrays.items() if name != "bind"):
            raise ValueError("some lie at places that are not numbers")
        figure = _figure(path, about, arrays)
    except (KeyError, IndexError, ValueError) as error:
        raise StudioError(f"{path.name}: its joints or its skin make no sense: {error}. {CHARACTER_ADVICE}") from error
    return character_of([figure], options)


def _figure(path: Path, about: dict[str, Any], arrays: Arrays) -> Figure:
    parents, shown = tuple(about["parents"]), _square(arrays["world"])
    world = _bound(parents, shown, arrays["bind"])
    repairs: list[str] = []
    pieces: list[MeshPiece] = []
    for number, mesh in enumerate(about["meshes"]):
        part = {name.partition(" ")[2]: array for name, array in arrays.items() if name.startswith(f"{number} ")}
        if mesh["carrier"] >= 0:
            carrier = mesh["carrier"]
            part["to_world"] = (world[carrier] @ np.linalg.inv(shown[carrier]) @ _square(part["to_world"]))[:3]
        elif not len(part["weights"]):
            repairs.append(f"{path.name}: {mesh['name']} hangs from no joint; it was left out.")
            continue
        pieces += _pieces(mesh, part, [_material(path, *told, part, repairs) for told in enumerate(mesh["materials"])])
    if sum(len(piece.vertices) for piece in pieces) > MOST_VERTICES:
        raise StudioError(
            f"{path.name} has more than {MOST_VERTICES:,} vertices. Export the figure alone, and coarser."
        )
    names = [name or f"joint{index}" for index, name in enumerate(about["names"])]
    unique = [name if name not in names[:index] else f"{name}_{index}" for index, name in enumerate(names)]
    return Figure(
        name=readable_name(path.stem),
        source=path.name,
        joint_names=tuple(unique),
        parents=parents,
        positions=world[:, :3, 3],
        rotations=rotations_of(world),
        pieces=tuple(pieces),
        up=about["up_axis"],
        metres=about["unit_metres"],
        moves=about["moves"],
        repairs=tuple(repairs),
        kind=about["kind"],
        to_studio=_AXES.get((about["kind"], about["up_axis"])),
        scales=scales_of(world),
        bones=np.array(about["bones"]),
    )


def _square(matrices: FloatArray) -> FloatArray:
    """Matrices (..., 4, 4) of matrices (..., 3, 4)."""
    last = np.broadcast_to([0.0, 0.0, 0.0, 1.0], (*matrices.shape[:-2], 1, 4))
    return np.concatenate([matrices, last], axis=-2)


def _bound(parents: tuple[int, ...], shown: FloatArray, bind: FloatArray) -> FloatArray:
    """World matrices (J, 4, 4) of the joints in the bind pose; one without a bind matrix keeps its transform relative
    to its parent.
    """
    world = shown.copy()
    for joint, parent in enumerate(parents):
        if np.isfinite(bind[joint]).all():
            world[joint, :3] = bind[joint]
        elif parent >= 0:
            world[joint] = world[parent] @ np.linalg.inv(shown[parent]) @ shown[joint]
    return world


def _pieces(mesh: dict[str, Any], part: Arrays, materials: list[Material]) -> list[MeshPiece]:
    """One piece for each material, with a vertex for each combination of point, normal and texture coordinates."""
    to_world, joints, weights = part["to_world"], *_shares(mesh["carrier"], part)
    corners, triangles = part["corners"].astype(np.int64), _triangles(part["faces"].astype(np.int64))
    found = []
    for kind in np.unique(triangles[:, 3]).tolist():
        chosen = corners[triangles[triangles[:, 3] == kind, :3]].reshape(-1, 3)
        rows, index = np.unique(chosen, axis=0, return_inverse=True)
        points, turned, places = (
            values[rows[:, column]] if len(values) else np.zeros((len(rows), values.shape[1]))
            for column, values in enumerate((part["vertices"], part["normals"], part["coordinates"]))
        )
        stood = points @ to_world[:, :3].T + to_world[:, 3]
        shown = index.reshape(-1, 3)[:, :: -1 if np.linalg.det(to_world[:, :3]) < 0.0 else 1]
        normals = unit(turned @ np.linalg.inv(to_world[:, :3])) if turned.any() else smooth_normals(stood, shown)
        found.append(
            MeshPiece(
                stood,
                normals,
                places,
                shown,
                joints[rows[:, 0]],
                weights[rows[:, 0]],
                materials[kind] if kind < len(materials) else None,
                rigid=mesh["carrier"] >= 0,
                name=mesh["name"],
            )
        )
    return found


def _triangles(faces: IntArray) -> IntArray:
    """Corners and material (T, 4) of the faces (F, 3), triangulated as fans from their first corner."""
    fans = [np.empty((0, 4), np.int64)]
    for step in range(1, int(faces[:, 1].max(initial=0)) - 1):
        first, _, kind = faces[faces[:, 1] > step + 1].T
        fans.append(np.column_stack([first, first + step, first + step + 1, kind]))
    return np.concatenate(fans)


def _shares(carrier: int, part: Arrays) -> tuple[IntArray, FloatArray]:
    """Joints and weights (V, n) of the vertices; a vertex without weights takes those of the nearest one with some."""
    count = len(part["vertices"])
    if carrier >= 0:
        return np.full((count, 1), carrier), np.ones((count, 1))
    vertex, joint, weight = part["weights"][part["weights"][:, 2] > 0.0].T
    order = np.lexsort((-weight, vertex))
    vertex, joint, weight = vertex[order].astype(np.int64), joint[order].astype(np.int64), weight[order]
    place = np.arange(len(vertex)) - np.searchsorted(vertex, vertex)
    joints, weights = np.zeros((count, MOST_SCENE_INFLUENCES), np.int64), np.zeros((count, MOST_SCENE_INFLUENCES))
    kept = place < MOST_SCENE_INFLUENCES
    joints[vertex[kept], place[kept]], weights[vertex[kept], place[kept]] = joint[kept], weight[kept]
    bare = weights[:, 0] == 0.0
    if bare.any() and not bare.all():
        _, near = cKDTree(part["vertices"][~bare]).query(part["vertices"][bare])
        joints[bare], weights[bare] = joints[~bare][near], weights[~bare][near]
    return joints, weights / np.maximum(weights.sum(axis=1, keepdims=True), 1e-9)


def _picture_beside(path: Path, named: str) -> bytes:
    """Content of a picture that the file at ``path`` names, in the folder of the file or a usual folder for pictures.

    It is looked for at its own relative path, then by its name alone. Raises StudioError.
    """
    name = PureWindowsPath(named).name
    places = (f"{folder}/{name}" for folder in (f"{path.stem}.fbm", *_PICTURE_FOLDERS))
    below = "" if PureWindowsPath(named).anchor else named
    for place in (below, name, *places):
        try:
            if place and path_beside(place, path, path.name).is_file():
                return content_of(place, path, path.name)
        except StudioError:  # it leads out of the folder: the name alone is tried
            continue
    return content_of(name, path, path.name)


def _material(path: Path, index: int, told: dict[str, Any], part: Arrays, repairs: list[str]) -> Material:
    def picture_of(role: str, named: str) -> NDArray[np.uint8] | None:
        picture, name = part.get(f"{index} {role}"), PureWindowsPath(named).name
        if picture is None and not name:
            return None
        try:
            return checked_picture(_picture_beside(path, named) if picture is None else picture.tobytes())
        except (StudioError, ValueError) as error:
            shown = "; the plain colour is shown" if role == "picture" else ""
            repairs.append(f"{path.name}: the image '{name}' was left out{shown}. {error}")
        return None

    texture = picture_of("picture", told["picture"])
    maps = {name: picture_of(name, named) for name, named in told.get("maps", {}).items()}
    red, green, blue = told.get("emission", (0.0, 0.0, 0.0))
    return Material(
        told["name"],
        hex_colour(np.ones(3) if texture is not None else np.array(told["colour"])),
        texture,
        emission=(red, green, blue),
        maps={name: picture for name, picture in maps.items() if picture is not None},
    )
