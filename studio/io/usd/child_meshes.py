"""Meshes of a USD file as plain arrays, read in the child process of ``child``."""

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

MOST_USD_CORNERS = 4_000_000


def meshes_of(
    prims: Iterable[Any], skeleton: Any, paths: list[str]
) -> tuple[list[dict[str, Any]], dict[str, NDArray[Any]]]:
    """Record of each mesh that is bound to the joints at ``paths`` of ``skeleton``, and arrays of the meshes by number
    and name.

    ``to_world`` (3, 4) puts vertices into the world as they were bound. A mesh of the same figure that is bound to no
    joint has a record without weights.
    """
    from pxr import UsdGeom, UsdSkel

    told: list[dict[str, Any]] = []
    arrays: dict[str, NDArray[Any]] = {}
    figure = UsdSkel.Root.Find(skeleton.GetPrim())
    for prim in prims:
        mesh, binding = UsdGeom.Mesh(prim), UsdSkel.BindingAPI(prim)
        is_bound = bool(mesh) and binding.GetInheritedSkeleton().GetPath() == skeleton.GetPath()
        corners = (
            np.array(mesh.GetFaceVertexIndicesAttr().Get() or (), dtype=np.int64) if mesh else np.empty(0, np.int64)
        )
        if not 0 < len(corners) <= MOST_USD_CORNERS:
            continue
        weights = _weights(mesh, binding, paths) if is_bound else np.empty((0, 3))
        number = len(told)
        if not len(weights):
            if figure and prim.GetPath().HasPrefix(figure.GetPath()):
                arrays[f"{number} weights"] = weights
                told.append({"name": prim.GetName(), "carrier": -1, "materials": []})
            continue
        materials, of_faces = _materials(mesh, arrays, number)
        bound = binding.GetGeomBindTransformAttr().Get()
        to_world = np.eye(4) if bound is None else np.array(bound, dtype=np.float64).T
        parts = {"to_world": to_world[:3], "weights": weights, **_corners(mesh, corners, of_faces)}
        arrays |= {f"{number} {name}": array for name, array in parts.items()}
        told.append({"name": prim.GetName(), "carrier": -1, "materials": materials})
    return told, arrays


def _weights(mesh: Any, binding: Any, paths: list[str]) -> FloatArray:
    """Table (W, 3) of vertex, joint and weight; empty for a mesh that is bound to no joint."""
    indices, weights = binding.GetJointIndicesPrimvar(), binding.GetJointWeightsPrimvar()
    joints, shares = indices.ComputeFlattened(), weights.ComputeFlattened()
    wide = indices.GetElementSize()
    if not joints or not shares or len(joints) != len(shares) or wide < 1:
        return np.empty((0, 3))
    own = [str(path) for path in binding.GetJointsAttr().Get() or paths]
    place = np.array([paths.index(path) if path in paths else -1 for path in own])
    count = len(mesh.GetPointsAttr().Get() or ())
    joint, share = (np.array(values).reshape(-1, wide) for values in (joints, shares))
    if len(joint) == 1:  # all of it hangs from the same joints
        joint, share = (np.repeat(values, count, axis=0) for values in (joint, share))
    vertex = np.repeat(np.arange(len(joint)), wide)
    kept = (joint.ravel() >= 0) & (joint.ravel() < len(place)) & (vertex < count)
    rows = np.column_stack([vertex[kept], place[joint.ravel()[kept]], share.ravel()[kept]]).astype(np.float64)
    return rows[rows[:, 1] >= 0.0]


def _corners(mesh: Any, corners: NDArray[np.int64], of_faces: NDArray[np.int64]) -> dict[str, FloatArray]:
    """Values of vertices, normals and texture coordinates, and the index of each for every corner of the faces."""
    from pxr import UsdGeom

    sizes = np.array(mesh.GetFaceVertexCountsAttr().Get(), dtype=np.int64)
    begins = np.concatenate([[0], np.cumsum(sizes)[:-1]])
    api = UsdGeom.PrimvarsAPI(mesh)
    shown = api.GetPrimvar("normals")
    normals = shown.ComputeFlattened() if shown.HasValue() else mesh.GetNormalsAttr().Get()
    how = shown.GetInterpolation() if shown.HasValue() else mesh.GetNormalsInterpolation()
    texture = next((each for name in ("st", "UVMap", "st0") if (each := api.GetPrimvar(name)).HasValue()), None)
    places = texture.ComputeFlattened() if texture else None
    columns, found = [corners], {"vertices": np.array(mesh.GetPointsAttr().Get(), dtype=np.float64)}
    for name, wide, values, interpolation in (
        ("normals", 3, normals, how),
        ("coordinates", 2, places, texture.GetInterpolation() if texture else ""),
    ):
        array = np.array(values if values is not None else (), dtype=np.float64).reshape(-1, wide)
        index = {
            UsdGeom.Tokens.faceVarying: np.arange(len(corners)),
            UsdGeom.Tokens.uniform: np.repeat(np.arange(len(sizes)), sizes),
            UsdGeom.Tokens.constant: np.zeros_like(corners),
        }.get(interpolation, corners)
        if len(index) != len(corners) or index.max(initial=0) >= len(array):
            array, index = np.empty((0, wide)), np.zeros_like(corners)
        found[name] = array
        columns.append(index)
    found["corners"] = np.column_stack(columns).astype(np.float64)
    if mesh.GetOrientationAttr().Get() == UsdGeom.Tokens.leftHanded:
        for begin, size in zip(begins.tolist(), sizes.tolist(), strict=True):
            found["corners"][begin : begin + size] = found["corners"][begin : begin + size][::-1]
    found["faces"] = np.column_stack([begins, sizes, of_faces]).astype(np.float64)
    return found


def _materials(
    mesh: Any, arrays: dict[str, NDArray[Any]], number: int
) -> tuple[list[dict[str, Any]], NDArray[np.int64]]:
    """Records of the materials of a mesh, and the index (F,) of each face's material among them."""
    from pxr import UsdShade

    api = UsdShade.MaterialBindingAPI(mesh.GetPrim())
    of_faces = np.zeros(len(mesh.GetFaceVertexCountsAttr().Get()), dtype=np.int64)
    materials = [_material(api.ComputeBoundMaterial()[0], arrays, f"{number} 0")]
    for subset in api.GetMaterialBindSubsets():
        faces = np.array(subset.GetIndicesAttr().Get() or (), dtype=np.int64)
        of_faces[faces[(faces >= 0) & (faces < len(of_faces))]] = len(materials)
        bound = UsdShade.MaterialBindingAPI(subset.GetPrim()).ComputeBoundMaterial()[0]
        materials.append(_material(bound, arrays, f"{number} {len(materials)}"))
    return materials, of_faces


def _material(material: Any, arrays: dict[str, NDArray[Any]], key: str) -> dict[str, Any]:
    """Record of a material: name, colour and picture, which is inside the package or named by the file."""
    told: dict[str, Any] = {"name": "", "colour": [0.8, 0.8, 0.8], "picture": ""}
    if not material:
        return told
    told["name"] = material.GetPrim().GetName()
    surface = material.ComputeSurfaceSource()[0]
    diffuse = surface.GetInput("diffuseColor") if surface else None
    if not diffuse:
        return told
    if diffuse.HasConnectedSource():
        texture = diffuse.GetConnectedSources()[0][0].source
        named = texture.GetInput("file").Get() if texture.GetInput("file") else None
        if named is not None:
            told["picture"] = named.path
            _keep_packed(named.resolvedPath, arrays, key)
    elif (colour := diffuse.Get()) is not None:
        told["colour"] = _shown(np.array(colour, dtype=np.float64)).tolist()
    return told


def _keep_packed(path: str, arrays: dict[str, NDArray[Any]], key: str) -> None:
    """Keep the content of a picture inside a package; pictures beside the file are read by the parent process."""
    from pxr import Ar

    if Ar.IsPackageRelativePath(path):
        asset = Ar.GetResolver().OpenAsset(Ar.ResolvedPath(path))
        if asset:
            with asset:
                arrays[f"{key} picture"] = np.frombuffer(bytes(asset.GetBuffer()), np.uint8)


def _shown(linear: FloatArray) -> FloatArray:
    """sRGB colour of a linear one."""
    linear = np.clip(linear, 0.0, 1.0)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1.0 / 2.4) - 0.055)
