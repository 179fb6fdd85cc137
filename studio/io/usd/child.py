"""Child process that reads a USD file: ``python -m studio.io.usd.child IN.usd OUT.npz motion|figure|either``.

The library usd-core is written in C++ and files come from anywhere, so it runs in a process of its own, in which a
crash or an endless loop does no harm. It returns the same plain arrays as the child process that reads FBX.
"""

import json
import sys
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studio.io.scene.child_run import MOST_FRAME_VALUES, run_child
from studio.io.usd.child_meshes import meshes_of

FloatArray = NDArray[np.float64]

MOST_USD_JOINTS = 4096
_FACING = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
"""Turn of a body that faces +X, as the studio writes files with Z up, to -Y, as other kinds of files have it."""
_CLOCK = 240.0
"""Time codes a second above which they are a clock and no frames."""


def main(source: str, target: str, what: str) -> None:
    """Read the longest animation of a skeleton in ``source``, or its figure, and write it to ``target``.

    ``what`` is ``motion``, ``figure``, or ``either``: the figure if a mesh is bound to the skeleton, else the motion.
    """
    from pxr import Usd, UsdGeom, UsdSkel

    stage = Usd.Stage.Open(source)
    skeletons = [UsdSkel.Skeleton(prim) for prim in _prims(stage) if prim.IsA(UsdSkel.Skeleton)]
    if not skeletons:
        sys.exit("it has no skeleton. Rig its mesh first")
    cache = UsdSkel.Cache()
    animations = [_animation(cache, each) for each in skeletons]
    spans = [_span(stage, each) for each in animations]
    chosen = max(range(len(skeletons)), key=lambda k: (len(spans[k]), len(_joints(skeletons[k]))))
    skeleton, animation, moments = skeletons[chosen], animations[chosen], spans[chosen]
    paths = _joints(skeleton)
    if not 0 < len(paths) <= MOST_USD_JOINTS:
        sys.exit(f"its skeleton holds {len(paths)} joints, no number that a body has")
    if len(moments) * len(paths) * 10 > MOST_FRAME_VALUES:
        sys.exit(f"it says that it has {len(moments)} frames")
    about = {
        "names": _names(skeleton, paths),
        "parents": list(UsdSkel.Topology(paths).GetParentIndices()),
        "unit_metres": UsdGeom.GetStageMetersPerUnit(stage),
        "up_axis": str(UsdGeom.GetStageUpAxis(stage)),
        "frame_rate": _rate(stage),
        "moves": len(moments) > 0,
    }
    rest = _rest(skeleton, paths, about["parents"])
    meshes, arrays = meshes_of(_prims(stage), skeleton, paths) if what != "motion" else ([], {})
    if what == "figure" or any(len(arrays[f"{number} weights"]) for number in range(len(meshes))):
        joints = {"world": _world(rest, about["parents"]), "bind": _bind(skeleton, paths)}
        if np.allclose(*(each[0] for each in joints.values())):  # Blender's bind pose counts from the skeleton
            above = _columns(
                [UsdGeom.Xformable(skeleton.GetPrim()).ComputeLocalToWorldTransform(stage.GetStartTimeCode())]
            )
            spaces = [name for name in arrays if name.endswith(" to_world")]
            joints = {name: _moved(above[0], each) for name, each in joints.items()}
            arrays |= {name: _moved(above[0], arrays[name]) for name in spaces}
        arrays |= joints
        about |= {"meshes": meshes, "kind": "USD", "bones": [True] * len(paths)}
    else:
        arrays = _motion(skeleton, animation, moments or [stage.GetStartTimeCode()], rest, paths, about["up_axis"])
    content = np.frombuffer(json.dumps(about).encode(), dtype=np.uint8)
    np.savez(target, about=content, **arrays)  # type: ignore[arg-type]


def _prims(stage: Any) -> Any:
    from pxr import Usd

    return Usd.PrimRange.Stage(stage, Usd.TraverseInstanceProxies())


def _joints(skeleton: Any) -> list[str]:
    return [str(path) for path in skeleton.GetJointsAttr().Get() or ()]


def _names(skeleton: Any, paths: list[str]) -> list[str]:
    names = skeleton.GetJointNamesAttr().Get() or ()
    return [str(name) for name in names] if len(names) == len(paths) else [path.rpartition("/")[2] for path in paths]


def _animation(cache: Any, skeleton: Any) -> Any:
    """Query of the animation to which the skeleton or an ancestor is bound; None if there is none."""
    from pxr import UsdSkel

    source = UsdSkel.BindingAPI(skeleton.GetPrim()).GetInheritedAnimationSource()
    query = cache.GetAnimQuery(UsdSkel.Animation(source)) if source else None
    return query or None


def _rate(stage: Any) -> float:
    """Frame rate of a stage in fps: time codes per second, or the playback rate if they count ticks of a clock."""
    codes = stage.GetTimeCodesPerSecond()
    return float(stage.GetFramesPerSecond() if codes > _CLOCK else codes)


def _span(stage: Any, animation: Any) -> list[float]:
    """Time codes of the frames of an animation, empty without motion."""
    times = animation.GetJointTransformTimeSamples() if animation is not None else []
    if not times:
        return []
    step = stage.GetTimeCodesPerSecond() / _rate(stage)
    count = int((times[-1] - times[0]) / step + 1e-3) + 1
    return [times[0] + step * frame for frame in range(min(count, MOST_FRAME_VALUES))]


def _rest(skeleton: Any, paths: list[str], parents: list[int]) -> FloatArray:
    """Matrices (J, 4, 4) from joints to their parents at rest, acting on columns; the bind pose if the file has no rest
    pose.
    """
    rest = skeleton.GetRestTransformsAttr().Get() or ()
    if len(rest) == len(paths):
        return _columns(rest)
    world = _columns(skeleton.GetBindTransformsAttr().Get() or ())
    if len(world) != len(paths):
        sys.exit("its skeleton says neither how it rests nor how it was bound")
    return np.array(
        [
            matrix if parent < 0 else np.linalg.inv(world[parent]) @ matrix
            for matrix, parent in zip(world, parents, strict=True)
        ]
    )


def _bind(skeleton: Any, paths: list[str]) -> FloatArray:
    """World matrices (J, 3, 4) of the joints in the bind pose, NaN if unknown."""
    bind = skeleton.GetBindTransformsAttr().Get() or ()
    return _columns(bind)[:, :3] if len(bind) == len(paths) else np.full((len(paths), 3, 4), np.nan)


def _columns(matrices: Any) -> FloatArray:
    """Matrices (N, 4, 4) that act on columns, as in NumPy; those of USD act on rows."""
    return np.swapaxes(np.array(matrices, dtype=np.float64).reshape(-1, 4, 4), 1, 2)


def _world(rest: FloatArray, parents: list[int]) -> FloatArray:
    """World matrices (J, 3, 4) of the joints at rest."""
    world = rest.copy()
    for joint, parent in enumerate(parents):
        if parent >= 0:
            world[joint] = world[parent] @ rest[joint]
    return world[:, :3]


def _moved(above: FloatArray, transforms: FloatArray) -> FloatArray:
    """Transforms (..., 3, 4) relative to the world, below a node with the transform ``above`` (4, 4)."""
    moved = above[:3, :3] @ transforms
    moved[..., 3] += above[:3, 3]
    return moved


def _motion(
    skeleton: Any, animation: Any, moments: list[float], rest: FloatArray, paths: list[str], up: str
) -> dict[str, FloatArray]:
    """Arrays ``frames`` (F, J, 10) and ``rest`` (J, 10): position, rotation and scale of every joint in its parent."""
    from pxr import UsdGeom

    roots = [joint for joint, path in enumerate(paths) if "/" not in path]
    still = np.array([_parts(matrix) for matrix in rest])
    frames = np.tile(still, (len(moments), 1, 1))
    order = [str(path) for path in animation.GetJointOrder()] if animation is not None else []
    known = {path: place for place, path in enumerate(paths)}
    moving = [(place, known[path]) for place, path in enumerate(order) if path in known]
    rows, columns = [place for place, _ in moving], [joint for _, joint in moving]
    space = UsdGeom.Xformable(skeleton.GetPrim())
    facing = np.eye(4)
    if up == "Z":
        facing[:3, :3] = _FACING
    for frame, moment in enumerate(moments):
        if moving:
            places, turns, scales = animation.ComputeJointLocalTransformComponents(moment)
            frames[frame, columns, :3] = np.array(places, dtype=np.float64)[rows]
            frames[frame, columns, 3:7] = [[*turns[row].GetImaginary(), turns[row].GetReal()] for row in rows]
            frames[frame, columns, 7:] = np.array(scales, dtype=np.float64)[rows]
        above = facing @ _columns([space.ComputeLocalToWorldTransform(moment)])[0]
        for joint in roots:
            frames[frame, joint] = _parts(above @ _matrix(frames[frame, joint]))
    above = facing @ _columns([space.ComputeLocalToWorldTransform(moments[0])])[0]
    for joint in roots:
        still[joint] = _parts(above @ rest[joint])
    return {"frames": frames, "rest": still}


def _matrix(parts: FloatArray) -> FloatArray:
    """Matrix (4, 4) of a position, rotation and scale, given as ten numbers."""
    from pxr import Gf

    x, y, z, w = parts[3:7].tolist()
    made = np.eye(4)
    made[:3, :3] = np.array(Gf.Matrix3d(Gf.Quatd(w, x, y, z).GetNormalized())).T * parts[7:]
    made[:3, 3] = parts[:3]
    return made


def _parts(matrix: FloatArray) -> FloatArray:
    """Position, rotation (x, y, z, w) and scale of a matrix (4, 4), as ten numbers."""
    from pxr import Gf

    scale = np.linalg.norm(matrix[:3, :3], axis=0)
    turn = matrix[:3, :3] / np.where(scale > 0.0, scale, 1.0)
    if np.linalg.det(turn) < 0.0:
        turn, scale = -turn, -scale
    quaternion = Gf.Matrix3d(*turn.T.ravel().tolist()).ExtractRotation().GetQuat()
    return np.array([*matrix[:3, 3], *quaternion.GetImaginary(), quaternion.GetReal(), *scale])


if __name__ == "__main__":
    run_child(main)
