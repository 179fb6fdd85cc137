"""Written files read back as other programs read them, to be compared with what was written."""

import csv
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from studio.core.body.kinematics import joint_world
from studio.core.body.pose import PoseSequence
from studio.core.body.skeleton import Skeleton
from studio.io.c3d.reader import read_c3d
from studio.io.gltf.accessors import Accessors
from studio.io.gltf.container import read_gltf
from studio.io.importing import ImportOptions, load_capture
from studio.io.up_axis import FILE_AXES

FloatArray = NDArray[np.float64]
Places = Mapping[str, FloatArray]
"""By the name of each joint where it is, (F, 3) metres, Z up."""


def places_in(path: Path) -> Places:
    """Places of the joints in a written file."""
    return _READERS[path.suffix](path)


def gltf_motion(path: Path) -> tuple[Skeleton, PoseSequence]:
    """The joints and the animation of a glTF file that the studio wrote, Y up."""
    file = read_gltf(path)
    accessors, root = Accessors(file), file.root.value
    nodes = [node for node in root["nodes"] if "mesh" not in node]
    parents = np.full(len(nodes), -1)
    for joint, node in enumerate(nodes):
        parents[node.get("children", [])] = joint
    offsets = np.array([node["translation"] for node in nodes])
    samplers, channels = root["animations"][0]["samplers"], root["animations"][0]["channels"]
    frames = accessors.numbers(samplers[0]["input"], 1).shape[0]
    rotations = np.tile([0.0, 0.0, 0.0, 1.0], (frames, len(nodes), 1))
    translations = np.tile(offsets, (frames, 1, 1))
    for channel in channels:
        target, output = channel["target"], samplers[channel["sampler"]]["output"]
        array = rotations if target["path"] == "rotation" else translations
        array[:, target["node"]] = accessors.numbers(output, array.shape[2])
    names = tuple(node["name"] for node in nodes)
    return Skeleton(names, parents, offsets, np.zeros(len(nodes), bool)), PoseSequence(rotations, translations)


def _of_gltf(path: Path) -> Places:
    skeleton, poses = gltf_motion(path)
    return _named(skeleton.names, joint_world(skeleton, poses)[0][..., [2, 0, 1]])


def _of_capture(path: Path) -> Places:
    centimetres = ImportOptions(unit="cm", up_axis="Y")
    units = {".bvh": centimetres, ".fbx": centimetres, ".s4d": ImportOptions()}
    capture = load_capture(path, units[path.suffix])
    return _named(capture.skeleton.names, joint_world(capture.skeleton, capture.poses)[0])


def _of_usd(path: Path) -> Places:
    from pxr import Usd, UsdSkel

    stage = Usd.Stage.Open(str(path))
    skeleton = next(UsdSkel.Skeleton(prim) for prim in stage.Traverse() if prim.IsA(UsdSkel.Skeleton))
    cache = UsdSkel.Cache()
    cache.Populate(UsdSkel.Root(stage.GetDefaultPrim()), Usd.PrimDefaultPredicate)
    query = cache.GetSkelQuery(skeleton)
    frames = range(int(stage.GetEndTimeCode()) + 1)
    matrices = np.array([np.array(query.ComputeJointSkelTransforms(frame)) for frame in frames])
    return _named(tuple(skeleton.GetJointNamesAttr().Get()), matrices[:, :, 3, :3])


def _of_csv(path: Path) -> Places:
    with open(path, newline="") as file:
        titles, *rows = csv.reader(file)
    numbers = np.array([[float(word or "nan") for word in row] for row in rows])
    return {title[:-2]: numbers[:, column : column + 3] for column, title in enumerate(titles) if title.endswith(".x")}


def _of_c3d(path: Path) -> Places:
    trial = read_c3d(path).trial
    points = trial.points @ FILE_AXES["Z"].T / 1000.0
    return {label: points[:, index] for index, label in enumerate(trial.labels)}


def _of_npz(path: Path) -> Places:
    with np.load(path, allow_pickle=False) as file:
        return _named(tuple(file["joints"]), file["positions"])


def _named(names: tuple[str, ...], positions: FloatArray) -> Places:
    return {str(name): positions[:, joint] for joint, name in enumerate(names)}


_READERS: Mapping[str, Callable[[Path], Places]] = {
    ".bvh": _of_capture,
    ".fbx": _of_capture,
    ".s4d": _of_capture,
    ".glb": _of_gltf,
    ".gltf": _of_gltf,
    ".vrma": _of_gltf,
    **dict.fromkeys((".usd", ".usda", ".usdc", ".usdz"), _of_usd),
    ".c3d": _of_c3d,
    ".csv": _of_csv,
    ".npz": _of_npz,
}
