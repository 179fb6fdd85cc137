"""Writer of a take as USD: a UsdSkel skeleton with its animation and skin, Z up and in metres as in the studio.

The package usd-core is an extra of the studio (``pip install morpho-studio[usd]``), imported only here.
"""

import shutil
import tempfile
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studio.core.body.skeleton import Skeleton
from studio.core.errors import StudioError
from studio.core.names import readable_name
from studio.core.rigs.joint_skin import JointSkin
from studio.core.rotations import to_matrix
from studio.core.stage.saved_camera import CAMERA_ASPECT, CAMERA_FAR_METRES, CAMERA_NEAR_METRES, VIEW_ANGLE, SavedCamera
from studio.io.atomic_write import atomic_replacements
from studio.io.export import Take, plain_material, skin_of
from studio.io.interrupts import deferred_interrupt
from studio.io.registry import Progress
from studio.io.takes.exported_stage import ExportedProp, ExportedStage
from studio.io.usd.materials import bind_materials, identifiers
from studio.io.zipped import write_zip

FloatArray = NDArray[np.float64]

USD_FOCAL_LENGTH = 50.0
"""Focal length of every camera; only its ratio to the aperture matters."""
PACKED_SUFFIX = ".usdz"
_TOLD, _SAVED = 64, 8192
"""Frames between two reports of progress, and those that go to the disk at once: USD holds Python's lock for them."""


def write_take(path: Path, take: Take, progress: Progress) -> None:
    """Write skeleton, animation and the character's skin, or a figure of bones if it has none.

    The file has one time sample per frame. Textures become pictures beside the file, named after it, or are packed into
    a ``.usdz``. Raises StudioError if the package is missing or the file cannot be written.
    """

    def fill(stage: Any) -> dict[str, bytes]:
        _set_up(stage, take.frame_rate, take.poses.frame_count)
        name = f"/{identifiers([take.name])[0]}"
        stage.SetDefaultPrim(stage.DefinePrim(name))
        return _put_take(
            stage, take, name, readable_name(path.stem), lambda share: progress(0.9 * share, f"Writing {path.name}")
        )

    _write(path, fill, progress)


def write_stage(path: Path, stage: ExportedStage, progress: Progress) -> None:
    """Write all performers and props of a stage with common frames at their positions, below one prim.

    Units, axes and textures are those of ``write_take``. Raises StudioError if the file cannot be written.
    """

    def fill(made: Any) -> dict[str, bytes]:
        from pxr import UsdGeom

        _set_up(made, stage.frame_rate, stage.frame_count)
        top, *names = identifiers([stage.name, *stage.names])
        made.SetDefaultPrim(UsdGeom.Xform.Define(made, f"/{top}").GetPrim())
        pictures: dict[str, bytes] = {}
        for number, (take, name) in enumerate(zip(stage.takes, names, strict=False)):

            def reported(share: float, number: int = number) -> None:
                progress(0.9 * (number + share) / len(stage.takes), f"Writing {path.name}")

            pictures |= _put_take(made, take, f"/{top}/{name}", f"{readable_name(path.stem)}_{name}", reported)
        for prop, name in zip(stage.props, names[len(stage.takes) :], strict=False):
            _put_prop(made, prop, f"/{top}/{name}")
        for camera, name in zip(stage.cameras, names[len(stage.takes) + len(stage.props) :], strict=True):
            _put_camera(made, camera, f"/{top}/{name}")
        return pictures

    _write(path, fill, progress)


def _write(path: Path, fill: Callable[[Any], dict[str, bytes]], progress: Progress) -> None:
    """Write the stage that ``fill`` sets up, with the pictures that it returns by name."""
    try:
        with deferred_interrupt():
            from pxr import Tf, Usd, UsdGeom, UsdShade, UsdSkel  # noqa: F401 - all that is imported on the way
    except ImportError as error:
        raise StudioError("USD needs the package usd-core. Install it with: pip install usd-core") from error
    try:
        with tempfile.TemporaryDirectory() as folder:
            layer = Path(folder) / "take.usdc"
            stage = Usd.Stage.CreateNew(str(layer))
            pictures = fill(stage)
            stage.Save()
            for name, content in pictures.items():
                (Path(folder) / name).write_bytes(content)
            progress(0.9, f"Writing {path.name}")
            written = _written(layer, stage, path.suffix.lower(), pictures, progress)
            beside = () if written.suffix == PACKED_SUFFIX else tuple(pictures)
            with atomic_replacements(path, *(path.with_name(name) for name in beside)) as parts:
                for part, name in zip(parts, (written.name, *beside), strict=True):
                    shutil.copyfile(Path(folder) / name, part)
    except Tf.ErrorException as error:
        raise StudioError(f"{path.name} could not be written as USD: {error}") from error
    progress(1.0, f"Wrote {path.name}")


def _written(layer: Path, stage: Any, suffix: str, pictures: Iterable[str], progress: Progress) -> Path:
    """Path of the written layer, or of a file beside it: as text, or with its pictures in a package."""
    if suffix == PACKED_SUFFIX:
        package = layer.with_suffix(PACKED_SUFFIX)
        files = {name: layer.with_name(name).read_bytes() for name in (layer.name, *pictures)}
        write_zip(package, files, None, lambda share, text: progress(0.9 + 0.1 * share, text))
        return package
    if suffix == ".usda":
        text = layer.with_suffix(".usda")
        stage.GetRootLayer().Export(str(text))
        return text
    return layer


def _set_up(stage: Any, frame_rate: float, frame_count: int) -> None:
    """Set axes, unit and frames of the stage."""
    from pxr import UsdGeom

    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    stage.SetTimeCodesPerSecond(frame_rate)
    stage.SetFramesPerSecond(frame_rate)
    stage.SetStartTimeCode(0)
    stage.SetEndTimeCode(frame_count - 1)


def _put_take(stage: Any, take: Take, path: str, stem: str, progress: Any) -> dict[str, bytes]:
    """Put the take on the stage, and return the pictures of its textures by their names there."""
    from pxr import Sdf, UsdGeom, UsdSkel, Vt

    skin = skin_of(take)
    root = UsdSkel.Root.Define(stage, path)
    joints = _joint_paths(take.skeleton)
    skeleton = _skeleton(stage, root, take.skeleton, skin, joints, take.rest_rotations)
    _animation(stage, skeleton, take, skin, joints, progress)
    if not len(skin.triangles):
        return {}
    mesh = _mesh(stage, root, skeleton, skin)
    if not skin.appearance:
        return bind_materials(stage, mesh, (plain_material(take),), np.zeros(len(skin.triangles), dtype=np.int32), stem)
    look = skin.appearance
    coordinates = UsdGeom.PrimvarsAPI(mesh).CreatePrimvar(
        "st", Sdf.ValueTypeNames.TexCoord2fArray, UsdGeom.Tokens.vertex
    )
    coordinates.Set(Vt.Vec2fArray.FromNumpy(look.coordinates))
    mesh.CreateDoubleSidedAttr(any(material.two_sided for material in look.materials))
    return bind_materials(stage, mesh, look.materials, look.triangle_materials, stem)


def _put_prop(stage: Any, prop: ExportedProp, path: str) -> None:
    """Put a prop on the stage: a mesh that moves as a whole."""
    from pxr import Gf, UsdGeom

    root = UsdGeom.Xform.Define(stage, path)
    move, turn = root.AddTranslateOp(UsdGeom.XformOp.PrecisionDouble), root.AddOrientOp(UsdGeom.XformOp.PrecisionDouble)
    for frame in [None] if prop.is_still else range(len(prop.places)):
        x, y, z, w = prop.rotations[frame or 0].tolist()
        time = () if frame is None else (frame,)
        move.Set(Gf.Vec3d(*prop.places[frame or 0].tolist()), *time)
        turn.Set(Gf.Quatd(w, x, y, z), *time)
    mesh = UsdGeom.Mesh.Define(stage, root.GetPath().AppendChild(root.GetPrim().GetName()))
    _set_surface(mesh, prop.surface.vertices, prop.surface.normals, prop.surface.triangles)
    bind_materials(stage, mesh, (prop.material,), np.zeros(len(prop.surface.triangles), dtype=np.int32), "")


def _put_camera(stage: Any, camera: SavedCamera, path: str) -> None:
    """Put a camera on the stage; apertures are in tenths of a unit, as USD has them."""
    from pxr import Gf, UsdGeom

    placement, made = camera.placement, UsdGeom.Camera.Define(stage, path)
    matrix = np.eye(4)
    matrix[:3, :3], matrix[3, :3] = placement.axes, placement.eye  # USD's matrices act on rows
    made.AddTransformOp().Set(Gf.Matrix4d(matrix.tolist()))
    tall = 20.0 * placement.half_height if placement.parallel else 2.0 * USD_FOCAL_LENGTH * np.tan(VIEW_ANGLE / 2)
    made.CreateProjectionAttr(UsdGeom.Tokens.orthographic if placement.parallel else UsdGeom.Tokens.perspective)
    made.CreateFocalLengthAttr(USD_FOCAL_LENGTH)
    made.CreateVerticalApertureAttr(tall)
    made.CreateHorizontalApertureAttr(CAMERA_ASPECT * tall)
    made.CreateFocusDistanceAttr(placement.distance)
    made.CreateClippingRangeAttr(Gf.Vec2f(CAMERA_NEAR_METRES, CAMERA_FAR_METRES))


def _joint_paths(skeleton: Skeleton) -> list[str]:
    """Paths ``Hips``, ``Hips/Spine`` ..., with the names of parents before those of their children."""
    paths: list[str] = []
    for name, parent in zip(identifiers(list(skeleton.names)), skeleton.parents.tolist(), strict=True):
        paths.append(f"{paths[parent]}/{name}" if parent >= 0 else name)
    return paths


def _skeleton(
    stage: Any, root: Any, skeleton: Skeleton, skin: JointSkin, joints: list[str], turns: FloatArray | None
) -> Any:
    """Skeleton with its rest transforms (the zero pose, in the parents' axes) and bind transforms (of the skin, in the
    world).
    """
    from pxr import UsdSkel, Vt

    made = UsdSkel.Skeleton.Define(stage, root.GetPath().AppendChild("Skeleton"))
    rest = np.tile(np.eye(4), (skeleton.joint_count, 1, 1))
    scales, units = skin.local_scales(skeleton.parents)
    rest[:, 3, :3] = skeleton.offsets / units[:, None]  # USD's matrices act on rows
    if turns is not None:
        rest[:, :3, :3] = np.swapaxes(to_matrix(turns), 1, 2)
    rest[:, :3, :3] *= scales[:, None, None]
    bind = np.tile(np.eye(4), (skeleton.joint_count, 1, 1))
    bind[:, :3, :3] = np.swapaxes(skin.bind_rotations, 1, 2)
    if skin.bind_scales is not None:
        bind[:, :3, :3] *= skin.bind_scales[:, None, None]
    bind[:, 3, :3] = skin.bind_positions
    made.CreateJointsAttr(Vt.TokenArray(joints))
    made.CreateJointNamesAttr(Vt.TokenArray(list(skeleton.names)))
    made.CreateRestTransformsAttr(Vt.Matrix4dArray.FromNumpy(rest))
    made.CreateBindTransformsAttr(Vt.Matrix4dArray.FromNumpy(bind))
    return made


def _animation(stage: Any, skeleton: Any, take: Take, skin: JointSkin, joints: list[str], progress: Any) -> None:
    from pxr import UsdSkel, Vt

    made = UsdSkel.Animation.Define(stage, skeleton.GetPath().AppendChild("Animation"))
    made.CreateJointsAttr(Vt.TokenArray(joints))
    scales, units = skin.local_scales(take.skeleton.parents)
    made.CreateScalesAttr(Vt.Vec3hArray([(scale, scale, scale) for scale in scales.tolist()]))
    translations, rotations = made.CreateTranslationsAttr(), made.CreateRotationsAttr()
    places = (take.poses.local_translations / units[:, None]).astype(np.float32)
    turns = take.poses.local_rotations.astype(np.float32)
    for frame in range(take.poses.frame_count):
        if frame % _TOLD == 0:
            progress(frame / take.poses.frame_count)
        if frame % _SAVED == 0:
            stage.Save()
        translations.Set(Vt.Vec3fArray.FromNumpy(places[frame]), frame)
        rotations.Set(Vt.QuatfArray.FromNumpy(turns[frame]), frame)
    UsdSkel.BindingAPI.Apply(skeleton.GetPrim()).CreateAnimationSourceRel().SetTargets([made.GetPath()])


def _mesh(stage: Any, root: Any, skeleton: Any, skin: JointSkin) -> Any:
    from pxr import UsdGeom, UsdSkel, Vt

    mesh = UsdGeom.Mesh.Define(stage, root.GetPath().AppendChild("Skin"))
    _set_surface(mesh, skin.vertices, skin.normals, skin.triangles)
    binding = UsdSkel.BindingAPI.Apply(mesh.GetPrim())
    binding.CreateSkeletonRel().SetTargets([skeleton.GetPath()])
    count = skin.joints.shape[1]
    binding.CreateJointIndicesPrimvar(False, count).Set(Vt.IntArray.FromNumpy(skin.joints.ravel()))
    binding.CreateJointWeightsPrimvar(False, count).Set(Vt.FloatArray.FromNumpy(skin.weights.astype("f4").ravel()))
    return mesh


def _set_surface(mesh: Any, vertices: FloatArray, normals: FloatArray, triangles: NDArray[Any]) -> None:
    """Set points, faces and normals of a mesh."""
    from pxr import UsdGeom, Vt

    points = vertices.astype(np.float32)
    mesh.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(points))
    mesh.CreateFaceVertexCountsAttr(Vt.IntArray(len(triangles), 3))
    mesh.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(triangles.astype(np.int32).ravel()))
    mesh.CreateNormalsAttr(Vt.Vec3fArray.FromNumpy(normals.astype(np.float32)))
    mesh.SetNormalsInterpolation(UsdGeom.Tokens.vertex)
    mesh.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)
    mesh.CreateExtentAttr(Vt.Vec3fArray.FromNumpy(np.stack([points.min(0), points.max(0)])))
