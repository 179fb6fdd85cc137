"""USD of an adapted motion, opened again with usd-core: the same joints, and a skin that is carried by them."""

import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from studio.core.body.kinematics import joint_world
from studio.core.errors import StudioError
from studio.core.mesh.skin import skin_vertices
from studio.core.normalized.normalize import normalize_capture
from studio.core.rigs.character_skeleton import joint_points
from studio.core.rigs.joint_skin import character_skin
from studio.core.solver.adapt import adapt
from studio.core.solver.request import AdaptRequest
from studio.io.export import take_of_adapted, take_of_capture, write_take
from studio.io.importing import load_capture, load_character
from studio.io.project.character_file import bundled_characters
from tests.builders import make_capture

pytest.importorskip("pxr", reason="usd-core is not installed")

from pxr import Ar, Usd, UsdGeom, UsdShade, UsdSkel

TENTH_OF_A_MILLIMETRE = 1e-4


def take_on(character, capture):
    motion, _ = normalize_capture(capture)
    request = AdaptRequest(motion, character.morphology)
    return take_of_adapted(character.name, adapt(request, capture.first_frame), character, request)


def opened(path):
    """The stage, and the query that says where its joints are."""
    stage = Usd.Stage.Open(str(path))
    skeleton = next(UsdSkel.Skeleton(prim) for prim in stage.Traverse() if prim.IsA(UsdSkel.Skeleton))
    cache = UsdSkel.Cache()
    root = UsdSkel.Root(stage.GetDefaultPrim())
    cache.Populate(root, Usd.PrimDefaultPredicate)
    return stage, cache.GetSkelQuery(skeleton), cache, root


def joints_at(query, frame):
    """(J, 3) metres, Z up."""
    return np.array([matrix.ExtractTranslation() for matrix in query.ComputeJointSkelTransforms(frame)])


@pytest.mark.parametrize("suffix", [".usd", ".usda", ".usdc"])
def test_a_real_motion_comes_back_joint_by_joint(captures, tmp_path, suffix):
    character = bundled_characters()["child"]
    take = take_on(character, load_capture(captures / "bvh" / "strikes" / "accad_male2_E1_JabLeft.bvh"))
    write_take(take, tmp_path / f"jab{suffix}")
    stage, query, *_kept = opened(tmp_path / f"jab{suffix}")
    assert UsdGeom.GetStageUpAxis(stage) == "Z"
    assert UsdGeom.GetStageMetersPerUnit(stage) == 1.0
    assert (stage.GetTimeCodesPerSecond(), stage.GetEndTimeCode()) == (30.0, take.poses.frame_count - 1)
    assert tuple(query.GetSkeleton().GetJointNamesAttr().Get()) == take.skeleton.names
    expected = take.adapted.positions[:, list(joint_points(character.morphology.layout))]
    for frame in range(0, take.poses.frame_count, 10):
        assert np.linalg.norm(joints_at(query, frame) - expected[frame], axis=1).max() < TENTH_OF_A_MILLIMETRE


def test_the_skin_is_where_linear_blending_takes_it(tmp_path):
    character = bundled_characters()["giant"]
    take = take_on(character, make_capture())
    write_take(take, tmp_path / "out.usdc")
    _, query, cache, root = opened(tmp_path / "out.usdc")
    [binding] = cache.ComputeSkelBindings(root, Usd.PrimDefaultPredicate)
    [skinned] = binding.GetSkinningTargets()
    points = UsdGeom.Mesh(skinned.GetPrim()).GetPointsAttr().Get()
    assert skinned.ComputeSkinnedPoints(query.ComputeSkinningTransforms(9), points, 9)
    shown, _ = skin_vertices(
        replace(character.skin, centres=character.skin.vertices),
        character.build, character.morphology, take.adapted.positions[9], take.adapted.rotations[9],
    )  # fmt: skip
    assert np.linalg.norm(np.array(points) - shown, axis=1).max() < TENTH_OF_A_MILLIMETRE
    assert len(points) == len(character_skin(character).vertices)


def test_joints_with_names_that_usd_does_not_allow_keep_them_beside_their_paths(tmp_path):
    capture = make_capture()
    names = tuple(f"rig:{name}.L" for name in capture.skeleton.names)
    capture = replace(capture, skeleton=replace(capture.skeleton, names=names))
    write_take(take_of_capture(capture), tmp_path / "out.usda")
    kept = opened(tmp_path / "out.usda")
    assert tuple(kept[1].GetSkeleton().GetJointNamesAttr().Get()) == names
    expected = joint_world(capture.skeleton, capture.poses)[0]
    assert np.linalg.norm(joints_at(kept[1], 7) - expected[7], axis=1).max() < TENTH_OF_A_MILLIMETRE


def surfaces(stage):
    """Bound materials: the triangles it covers, its surface, and the shader that gives its colour, if any."""
    for prim in stage.Traverse():
        if prim.IsA(UsdGeom.Subset):
            material, _ = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial()
            surface = UsdShade.Shader(material.ComputeSurfaceSource()[0])
            source = surface.GetInput("diffuseColor").GetConnectedSources()[0]
            texture = UsdShade.Shader(source[0].source.GetPrim()) if source else None
            yield list(UsdGeom.Subset(prim).GetIndicesAttr().Get()), surface, texture


@pytest.mark.parametrize("suffix", [".usda", ".usdc", ".usdz"])
def test_materials_come_along_with_their_textures_and_where_on_the_skin_they_lie(captures, tmp_path, suffix):
    character = load_character(captures / "characters" / "kaykit_barbarian_stocky.glb").character
    look = character.skin.appearance
    write_take(take_on(character, make_capture()), tmp_path / f"out{suffix}")
    stage = Usd.Stage.Open(str(tmp_path / f"out{suffix}"))
    [mesh] = [UsdGeom.Mesh(prim) for prim in stage.Traverse() if prim.IsA(UsdGeom.Mesh)]
    places = UsdGeom.PrimvarsAPI(mesh).GetPrimvar("st")
    assert places.GetInterpolation() == "vertex"
    assert np.array_equal(np.array(places.Get()), look.coordinates)
    found = list(surfaces(stage))
    assert len(found) == len(look.materials)
    for index, ((triangles, surface, texture), material) in enumerate(zip(found, look.materials, strict=True)):
        assert triangles == np.flatnonzero(look.triangle_materials == index).tolist()
        if material.texture is None:
            assert np.allclose(surface.GetInput("diffuseColor").Get(), material.linear_colour)
            continue
        asset = texture.GetInput("file").Get()
        with Ar.GetResolver().OpenAsset(Ar.ResolvedPath(asset.resolvedPath)) as content:
            assert bytes(content.GetBuffer()) == material.texture.tobytes()
        assert np.allclose(texture.GetInput("scale").Get(), (*material.linear_colour, 1.0))
        reader = texture.GetInput("st").GetConnectedSources()[0][0].source
        assert UsdShade.Shader(reader.GetPrim()).GetInput("varname").Get() == "st"
    assert any(material.texture is not None for material in look.materials)
    validation = pytest.importorskip("pxr.UsdValidation")
    validators = validation.ValidationRegistry().GetOrLoadAllValidators()
    assert [error.GetMessage() for error in validation.ValidationContext(validators).Validate(stage)] == []


def test_pictures_lie_beside_the_file_under_its_name_or_are_not_there(captures, tmp_path):
    character = load_character(captures / "characters" / "kaykit_barbarian_stocky.glb").character
    take = take_on(character, make_capture())
    write_take(take, tmp_path / "packed.usdz")
    assert [each.name for each in tmp_path.iterdir()] == ["packed.usdz"]
    write_take(take, tmp_path / "out.usd")
    written = {each.name for each in tmp_path.iterdir()}
    assert {each.split("_")[0] for each in written} == {"packed.usdz", "out.usd", "out"}

    def stop(share, _text):
        if share >= 0.9:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        write_take(take, tmp_path / "next.usd", stop)
    assert {each.name for each in tmp_path.iterdir()} == written


@pytest.mark.parametrize("module", ["pxr.Sdf", "pxr.Vt", "pxr.UsdSkel"])
def test_ctrl_c_while_usd_is_loaded_ends_the_export_and_nothing_is_written(tmp_path, module):
    """Its modules swallowed it: the export went on, or ended in an error of a module that was half loaded."""
    script = f"""
import os, signal, sys
from pathlib import Path
from studio.io.export import write_capture
from tests.builders import make_capture
class Presser:
    def find_spec(self, name, *_):
        if name == {module!r}:
            os.kill(os.getpid(), signal.SIGINT)
sys.meta_path.insert(0, Presser())
try:
    write_capture(make_capture(frames=4), Path({str(tmp_path / "walk.usda")!r}))
except KeyboardInterrupt:
    print("stopped")
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert (done.stdout, done.stderr) == ("stopped\n", "")
    assert list(tmp_path.iterdir()) == []


def test_without_usd_core_a_sentence_says_what_to_install(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "pxr", None)
    with pytest.raises(StudioError, match="pip install usd-core"):
        write_take(take_of_capture(make_capture()), tmp_path / "out.usd")
    assert list(tmp_path.iterdir()) == []
