"""USD in: skeletons with their animation as captures, skinned meshes as characters, in text, crate and package."""

from pathlib import Path

import numpy as np
import pytest

from studio.cli.main import main
from studio.core.body.kinematics import joint_world
from studio.core.errors import StudioError
from studio.core.normalized.normalize import normalize_capture
from studio.core.solver.adapt import adapt
from studio.core.solver.request import AdaptRequest
from studio.io.export import Take, take_of_adapted, take_of_capture, take_of_standing, write_take
from studio.io.importing import load_capture, load_character
from studio.io.project.character_file import bundled_characters
from studio.io.registry import ReadCharacter, format_of
from tests.builders import make_capture

pytest.importorskip("pxr", reason="usd-core is not installed")

from pxr import Gf, Sdf, Usd, UsdGeom, UsdSkel, Vt

TENTH_OF_A_MILLIMETRE = 1e-4


def take_on(name: str) -> Take:
    character = bundled_characters()[name]
    request = AdaptRequest(normalize_capture(make_capture())[0], character.morphology)
    return take_of_adapted(name, adapt(request), character, request)


@pytest.mark.parametrize("suffix", [".usd", ".usda", ".usdc", ".usdz"])
def test_a_take_comes_back_joint_by_joint_and_axis_by_axis(tmp_path: Path, suffix: str) -> None:
    take, path = take_on("giant"), tmp_path / f"walk{suffix}"
    write_take(take, path)
    back = load_capture(path)
    assert back.skeleton.names == take.skeleton.names
    assert (back.frame_count, back.frame_rate) == (take.poses.frame_count, take.frame_rate)
    (places, turns), (expected, turned) = (joint_world(each.skeleton, each.poses) for each in (back, take.capture))
    assert np.abs(places - expected).max() < TENTH_OF_A_MILLIMETRE
    assert np.abs(turns - turned).max() < 1e-5
    assert back.body_map is not None
    assert (back.up_axis, back.unit) == ("Z", "m")


def test_a_file_whose_mesh_hangs_from_its_skeleton_is_a_character_of_the_same_measures(tmp_path: Path) -> None:
    child = bundled_characters()["child"]
    path = tmp_path / "child.usdz"
    write_take(take_of_standing(child), path)
    assert format_of(path, "character_reader").name == "USD"
    read = load_character(path)
    assert isinstance(read, ReadCharacter)
    assert read.character.build.leg == pytest.approx(child.morphology.leg, abs=1e-3)
    assert len(read.character.skin.vertices) == len(child.skin.vertices)
    apart = np.sort(read.character.skin.vertices, axis=0) - np.sort(child.skin.vertices, axis=0)
    assert np.abs(apart - apart.mean(axis=0)).max() < 2e-3
    assert set(read.character.skin.rig.names) >= {"Hips", "LeftForeArm", "RightToeBase"}


def test_a_skeleton_below_a_turned_node_stands_as_that_node_is_turned(tmp_path: Path) -> None:
    """As Blender writes it: rest pose, bind pose and meshes count from the skeleton, names say nothing."""
    path, turned = tmp_path / "woman.usda", tmp_path / "turned.usda"
    write_take(take_of_standing(bundled_characters()["adult_woman"]), path)
    stage = Usd.Stage.Open(str(path))
    space = Gf.Matrix4d().SetRotate(Gf.Rotation(Gf.Vec3d(1.0, 0.0, 0.0), -90.0))
    UsdGeom.Xformable(stage.GetDefaultPrim()).AddTransformOp(opSuffix="above").Set(space)
    back = space.GetInverse()
    for prim in stage.Traverse():
        if prim.IsA(UsdSkel.Skeleton):
            skeleton = UsdSkel.Skeleton(prim)
            rest, bind = skeleton.GetRestTransformsAttr(), skeleton.GetBindTransformsAttr()
            first, *others = rest.Get()
            paths = [str(each) for each in skeleton.GetJointsAttr().Get()]
            numbers = {
                name: f"Node_{k}" for k, name in enumerate({part: 0 for each in paths for part in each.split("/")})
            }
            plain = ["/".join(numbers[part] for part in each.split("/")) for each in paths]
            skeleton.GetJointsAttr().Set(Vt.TokenArray(plain))
            skeleton.GetJointNamesAttr().Clear()
            rest.Set(Vt.Matrix4dArray([first * back, *others]))
            bind.Set(Vt.Matrix4dArray([each * back for each in bind.Get()]))
        elif prim.IsA(UsdGeom.Mesh):
            bound = UsdSkel.BindingAPI(prim).CreateGeomBindTransformAttr()
            bound.Set((bound.Get() or Gf.Matrix4d(1.0)) * back)
    stage.Export(str(turned))
    whole, found = (load_character(each).character for each in (path, turned))
    assert found.build.stature == pytest.approx(whole.build.stature, abs=1e-4)
    assert found.skin.vertices == pytest.approx(whole.skin.vertices, abs=1e-4)
    assert found.skin.rig.rotations == pytest.approx(whole.skin.rig.rotations, abs=1e-4)


def test_a_mesh_of_the_figure_that_hangs_from_no_joint_is_told(tmp_path: Path) -> None:
    path = tmp_path / "hero.usda"
    write_take(take_of_standing(bundled_characters()["child"]), path)
    stage = Usd.Stage.Open(str(path))
    axe = UsdGeom.Mesh.Define(stage, stage.GetDefaultPrim().GetPath().AppendChild("axe"))
    axe.CreatePointsAttr([(0, 0, 0), (1, 0, 0), (0, 1, 0)])
    axe.CreateFaceVertexCountsAttr([3])
    axe.CreateFaceVertexIndicesAttr([0, 1, 2])
    stage.Save()
    read = load_character(path)
    assert read.repairs == ("hero.usda: axe hangs from no joint; it was left out.",)
    assert len(read.character.skin.vertices) == len(bundled_characters()["child"].skin.vertices)


def written_elsewhere(path: Path, up: str, unit: float, codes: float) -> np.ndarray:
    """Write ``make_capture`` as other programs would: joints in the animation in another order, a moved and scaled
    prim above, time codes of their own. Returns places (F, J, 3) in metres and world axes."""
    capture = make_capture()
    to_file = np.eye(3) if up == "Z" else np.eye(3)[[1, 2, 0]]
    stage = Usd.Stage.CreateNew(str(path))
    UsdGeom.SetStageUpAxis(stage, up)
    UsdGeom.SetStageMetersPerUnit(stage, unit)
    stage.SetTimeCodesPerSecond(codes)
    stage.SetFramesPerSecond(60.0)
    root = UsdSkel.Root.Define(stage, "/actor")
    UsdGeom.Xformable(root).AddScaleOp().Set(Gf.Vec3f(10.0))
    skeleton = UsdSkel.Skeleton.Define(stage, "/actor/skeleton")
    names, paths = capture.skeleton.names, []
    for name, parent in zip(names, capture.skeleton.parents.tolist(), strict=True):
        paths.append(f"{paths[parent]}/{name}" if parent >= 0 else name)
    skeleton.CreateJointsAttr(paths)
    places = joint_world(capture.skeleton, capture.poses)[0]
    offsets = capture.skeleton.offsets @ to_file.T / unit / 10.0
    rest = np.tile(np.eye(4), (len(names), 1, 1))
    rest[:, 3, :3] = offsets
    skeleton.CreateRestTransformsAttr(Vt.Matrix4dArray.FromNumpy(rest))
    moving = [joint for joint in reversed(range(len(names))) if not capture.skeleton.end_sites[joint]]
    animation = UsdSkel.Animation.Define(stage, "/clips/walk")
    animation.CreateJointsAttr([paths[joint] for joint in moving])
    animation.CreateScalesAttr(Vt.Vec3hArray(len(moving), (1, 1, 1)))
    turns, moves = animation.CreateRotationsAttr(), animation.CreateTranslationsAttr()
    for frame in range(capture.frame_count):
        local = capture.poses.local_rotations[frame, moving]
        local = np.concatenate([local[:, :3] @ to_file.T, local[:, 3:]], axis=1).astype(np.float32)
        moved = (capture.poses.local_translations[frame, moving] @ to_file.T / unit / 10.0).astype(np.float32)
        turns.Set(Vt.QuatfArray.FromNumpy(local), frame * codes / 60.0)
        moves.Set(Vt.Vec3fArray.FromNumpy(moved), frame * codes / 60.0)
    UsdSkel.BindingAPI.Apply(root.GetPrim()).CreateAnimationSourceRel().SetTargets([Sdf.Path("/clips/walk")])
    stage.Save()
    return places


@pytest.mark.parametrize(("up", "unit", "codes"), [("Y", 0.01, 60.0), ("Z", 1.0, 60.0), ("Y", 1.0, 6000.0)])
def test_files_of_other_programs_are_read_in_metres_world_axes_and_frames(tmp_path, up, unit, codes) -> None:
    places = written_elsewhere(tmp_path / "walk.usda", up, unit, codes)
    back = load_capture(tmp_path / "walk.usda")
    assert back.frame_rate == 60.0
    read = joint_world(back.skeleton, back.poses)[0]
    assert read.shape == places.shape
    assert np.abs(read - places).max() < TENTH_OF_A_MILLIMETRE
    assert back.up_axis == up


@pytest.mark.parametrize(
    "content",
    [
        b"#usda 1.0\n(\n",
        b'#usda 1.0\ndef Xform "a" {}\n',
        b"PXR-USDC" + bytes(200),
        b"PK\x03\x04" + bytes(22) + b"\x05\0\0\0a.usd",
    ],
)
def test_damaged_files_and_those_without_a_skeleton_are_refused_with_what_to_do(tmp_path, content) -> None:
    (tmp_path / "walk.usd").write_bytes(content)
    with pytest.raises(StudioError, match=r"walk\.usd could not be read as USD: .*Export the animation"):
        load_capture(tmp_path / "walk.usd")


def test_the_command_line_converts_from_it(tmp_path: Path) -> None:
    write_take(take_of_capture(make_capture()), tmp_path / "walk.usdc")
    assert main(["convert", str(tmp_path / "walk.usdc"), str(tmp_path / "walk.bvh")]) == 0
    assert load_capture(tmp_path / "walk.bvh").body_map is not None


def test_without_the_package_it_says_what_to_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from studio.io.scene import scene_reader

    write_take(take_of_capture(make_capture()), tmp_path / "walk.usda")
    monkeypatch.setattr(scene_reader, "find_spec", lambda name: None)
    with pytest.raises(StudioError, match=r"pip install morpho-studio\[usd\]"):
        load_capture(tmp_path / "walk.usda")
