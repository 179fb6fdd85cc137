"""A stage in one file, and one performer a file: everybody stands where it stood, and those who meet still meet."""

import json
import subprocess
import sys
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from studio.cli.main import main
from studio.cli.render import stage_performances
from studio.core.body.canonical import BodyPart
from studio.core.body.kinematics import joint_world
from studio.core.constraints.base import BodyPoint
from studio.core.curves.keyed import KeyedNumber, KeyedPlace
from studio.core.mesh.triangle_mesh import TriangleMesh
from studio.core.rotations import to_matrix
from studio.core.stage.placement import Placement
from studio.core.stage.prop import InHand, Prop, PropShape
from studio.core.stage.prop_shapes import prop_surface
from studio.core.stage.saved_camera import CAMERA_ASPECT, VIEW_ANGLE, CameraPlacement, SavedCamera
from studio.io.export_options import ExportOptions
from studio.io.gltf.accessors import Accessors
from studio.io.gltf.container import read_gltf
from studio.io.importing import load_capture
from studio.io.project.project_file import new_document_id, write_project
from studio.io.takes.exported_stage import exported_stage, write_stage
from tests.engine.test_following import stage
from tests.io.blender import opened_in_blender
from tests.io.khronos import issues_of
from tests.patience import SECONDS

HUNDREDTH_OF_A_MILLIMETRE = 1e-5
HAND = BodyPoint(BodyPart.RIGHT_HAND, at_end=True)
WEDGE = TriangleMesh(
    np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0]]),
    np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]),
)


@pytest.fixture(scope="module")
def staged():
    """Three bodies: one reaches for another's wrist, one begins later; props that are keyed, in a hand, and at rest."""
    project = stage(characters=3, p0="p1")
    late = project.performers["p2"]
    clip = replace(late.clips[0], start=0.2)
    project = project.with_entity("performers", "p2", replace(late, clips=(clip,), position=(1.5, -2.0), heading=2.5))
    keyed = KeyedPlace((0.0, 0.4), ((0.0, 0.0, 0.3), (1.0, 0.5, 0.6)))
    props = {
        "ball": Prop("Ball", (0.2, 0.2, 0.2), keyed, KeyedNumber((0.0, 0.4), (0.0, 1.0)), PropShape.BALL),
        "stick": Prop("Stick", (0.05, 0.05, 1.0), shape=PropShape.STICK, held=InHand("p1", HAND)),
        "table": Prop("Ball", (0.8, 1.2, 0.7), (3.0, 0.0, 0.35), 0.5, PropShape.TABLE),
    }
    for key, prop in props.items():
        project = project.with_entity("props", key, prop)
    return project, stage_performances(project).performances


def gltf_places(path):
    """(F, 3) metres, studio's axes, of every node by its path of names."""
    file = read_gltf(path)
    accessors, root = Accessors(file), file.root.value
    nodes = root["nodes"]
    channels, samplers = root["animations"][0]["channels"], root["animations"][0]["samplers"]
    frames = accessors.numbers(samplers[0]["input"], 1).shape[0]
    moves = [np.tile(node.get("translation", [0.0, 0.0, 0.0]), (frames, 1)) for node in nodes]
    turns = [np.tile(node.get("rotation", [0.0, 0.0, 0.0, 1.0]), (frames, 1)) for node in nodes]
    for channel in channels:
        kind, node = channel["target"]["path"], channel["target"]["node"]
        chosen = turns if kind == "rotation" else moves
        chosen[node] = accessors.numbers(samplers[channel["sampler"]]["output"], chosen[node].shape[1])
    found = {}
    waiting = [
        (root_node, "", np.tile(np.eye(3), (frames, 1, 1)), np.zeros((frames, 3)))
        for root_node in root["scenes"][0]["nodes"]
    ]
    while waiting:
        place, above, axes, origin = waiting.pop()
        name = f"{above}/{nodes[place]['name']}"
        here = origin + np.einsum("fij,fj->fi", axes, moves[place])
        found[name] = here[:, [2, 0, 1]]
        turned = axes @ to_matrix(turns[place])
        waiting += [(child, name, turned, here) for child in nodes[place].get("children", [])]
    return found


READ_BY_UFBX = """
import sys, numpy as np, ufbx
from studio.io.fbx.objects import all_of, keep
import gc, os; gc.disable()
scene = keep(ufbx.load_file(sys.argv[1]))
stack = max(all_of(scene.anim_stacks), key=lambda each: each.time_end)
anim, settings = keep(stack.anim), keep(scene.settings)
count = round(stack.time_end * settings.frames_per_second) + 1
found = {}
waiting = [(child, "", ()) for child in all_of(keep(scene.root_node).children)]
while waiting:
    node, above, chain = waiting.pop()
    name, chain = above + "/" + node.name, (*chain, node)
    places = []
    for frame in range(count):
        point = np.zeros(3)
        for each in reversed(chain):
            local = ufbx.evaluate_transform(anim, each, frame / settings.frames_per_second)
            t, q = local.translation, local.rotation
            v, axis = point, np.array([q.x, q.y, q.z])
            twice = 2 * np.cross(axis, v)
            point = np.array([t.x, t.y, t.z]) + v + q.w * twice + np.cross(axis, twice)
        places.append(point)
    found[name] = np.array(places)[:, [2, 0, 1]] / 100.0
    waiting += [(child, name, chain) for child in all_of(node.children)]
np.savez(sys.argv[2], **found)
sys.stdout.flush(); os._exit(0)
"""


def fbx_places(path):
    target = path.with_suffix(".npz")
    subprocess.run([sys.executable, "-c", READ_BY_UFBX, str(path), str(target)], check=True, timeout=SECONDS)
    with np.load(target) as read:
        return {name: read[name] for name in read.files}


def usd_places(path):
    pxr = pytest.importorskip("pxr", reason="usd-core is not installed")
    from pxr import Usd, UsdGeom, UsdSkel

    assert pxr
    opened = Usd.Stage.Open(str(path))
    frames = range(int(opened.GetEndTimeCode()) + 1)
    found = {}
    for prim in opened.Traverse():
        if prim.IsA(UsdSkel.Root):
            cache = UsdSkel.Cache()
            cache.Populate(UsdSkel.Root(prim), Usd.PrimDefaultPredicate)
            [skeleton] = [UsdSkel.Skeleton(each) for each in Usd.PrimRange(prim) if each.IsA(UsdSkel.Skeleton)]
            query = cache.GetSkelQuery(skeleton)
            places = np.array([np.array(query.ComputeJointSkelTransforms(frame))[:, 3, :3] for frame in frames])
            joints = skeleton.GetJointsAttr().Get()
            found |= {f"/{prim.GetName()}/{joint}": places[:, at] for at, joint in enumerate(joints)}
        elif prim.IsA(UsdGeom.Xform):
            spots = [UsdGeom.XformCache(frame).GetLocalToWorldTransform(prim).ExtractTranslation() for frame in frames]
            found[f"/{prim.GetName()}"] = np.array(spots)
    return found


FBX_CAMERAS = """
import sys, os, json, gc, numpy as np, ufbx
from studio.io.fbx.objects import all_of, keep
gc.disable()
scene = keep(ufbx.load_file(sys.argv[1]))
found = {}
for camera in all_of(scene.cameras):
    [node] = all_of(camera.instances)
    place, turn = node.local_transform.translation, node.local_transform.rotation
    found[node.name] = {
        "parallel": camera.projection_mode == ufbx.ProjectionMode.ORTHOGRAPHIC,
        "angle": camera.field_of_view_deg.y,
        "width": camera.orthographic_size.x,
        "place": [place.x, place.y, place.z],
        "rotation": [turn.x, turn.y, turn.z, turn.w],
    }
print(json.dumps(found))
sys.stdout.flush(); os._exit(0)
"""


READERS = {".fbx": fbx_places, ".glb": gltf_places, ".usd": usd_places}


def expected_places(project, made, times):
    """(F, J, 3) on the stage of the joints of each performer, at times of the stage, between frames evenly."""
    found = {}
    for key, performance in made.items():
        timing, adapted = performance.composite.timing, performance.adapted
        rows = timing.frames_at(times) - adapted.first_frame
        low = np.floor(rows).astype(int)
        high, share = np.minimum(low + 1, adapted.frame_count - 1), (rows - low)[:, None, None]
        positions = adapted.positions[low] + share * (adapted.positions[high] - adapted.positions[low])
        found[key] = Placement.of(project.performers[key]).to_stage(positions)
    return found


@pytest.mark.parametrize("suffix", READERS)
def test_everybody_and_everything_is_where_it_stood_and_those_who_meet_meet(staged, tmp_path, suffix):
    project, made = staged
    path = tmp_path / f"play{suffix}"
    exported = exported_stage(project, made, ExportOptions(), path)
    assert exported.names == ["Body 0", "Body 1", "Body 2", "Ball", "Stick", "Ball 2"]
    write_stage(exported, path)
    found = READERS[suffix](path)
    times = np.arange(exported.frame_count) / exported.frame_rate
    assert times[-1] == pytest.approx(max(each.composite.timing.end for each in made.values()))
    expected = expected_places(project, made, times)
    hips = {}
    for take, (key, points) in zip(exported.takes, expected.items(), strict=True):
        name = take.name if suffix != ".usd" else take.name.replace(" ", "_")
        paths = {each.rpartition("/")[2]: places for each, places in found.items() if each.startswith(f"/{name}/")}
        world = joint_world(take.skeleton, take.poses)[0]
        for joint, joint_name in enumerate(take.skeleton.names):
            assert np.abs(paths[joint_name] - world[:, joint]).max() < HUNDREDTH_OF_A_MILLIMETRE
        assert np.abs(paths["Hips"] - points[:, 0]).max() < HUNDREDTH_OF_A_MILLIMETRE
        hips[key] = paths
    apart = hips["p0"]["RightHand"] - hips["p1"]["RightHand"]
    assert np.linalg.norm(apart, axis=1).max() < 2e-4
    assert all(np.linalg.norm(hips[a]["Hips"] - hips[b]["Hips"], axis=1).min() > 0.05 for a, b in pairwise(hips))
    for prop in exported.props:
        name = prop.name if suffix != ".usd" else prop.name.replace(" ", "_")
        assert np.abs(found[f"/{name}"] - prop.places).max() < HUNDREDTH_OF_A_MILLIMETRE
    assert np.abs(exported.props[0].places[[0, -1]] - [[0.0, 0.0, 0.3], [1.0, 0.5, 0.6]]).max() < 1e-9
    assert exported.props[2].is_still


@pytest.mark.parametrize("parallel", [False, True])
def test_cameras_are_written_by_name_and_look_as_they_did(staged, tmp_path, parallel):
    project, made = staged
    placement = CameraPlacement((0.4, -0.3, 1.1), 3.0, 0.7, 0.3, parallel)
    for key in ("first", "second"):
        project = project.with_entity("cameras", key, SavedCamera("Low", placement))
    path = tmp_path / "stage.gltf"
    written = exported_stage(project, made, ExportOptions(), path)
    write_stage(written, path)
    assert issues_of(path)["numErrors"] == 0
    root = read_gltf(path).root.value
    nodes = {node["name"]: node for node in root["nodes"] if "camera" in node}
    assert list(nodes) == ["Low", "Low 2"]
    axes = to_matrix(np.array(nodes["Low"]["rotation"]))[[2, 0, 1]].T
    eye = np.array(nodes["Low"]["translation"])[[2, 0, 1]]
    assert eye - 3.0 * axes[2] == pytest.approx(placement.target, abs=1e-9)
    assert axes == pytest.approx(placement.axes, abs=1e-9)
    kind = root["cameras"][nodes["Low"]["camera"]]["type"]
    assert kind == ("orthographic" if parallel else "perspective")
    fbx = tmp_path / "stage.fbx"
    write_stage(written, fbx)
    done = subprocess.run([sys.executable, "-c", FBX_CAMERAS, str(fbx)], check=True, capture_output=True, timeout=300)
    cameras = json.loads(done.stdout)
    assert list(cameras) == ["Low", "Low 2"]
    low = cameras["Low"]
    assert np.array(low["place"])[[2, 0, 1]] / 100.0 == pytest.approx(placement.eye, abs=1e-5)
    forward, up, right = to_matrix(np.array(low["rotation"]))[[2, 0, 1]].T
    assert np.array([right, up, -forward]) == pytest.approx(placement.axes, abs=1e-6)
    assert low["parallel"] == parallel
    assert low["angle"] == pytest.approx(np.degrees(VIEW_ANGLE), abs=1e-4)
    if parallel:
        assert low["width"] == pytest.approx(200.0 * placement.half_height * CAMERA_ASPECT)
    pytest.importorskip("pxr", reason="usd-core is not installed")
    from pxr import Usd, UsdGeom

    usd = tmp_path / "stage.usda"
    write_stage(written, usd)
    opened = Usd.Stage.Open(str(usd))
    cameras = [UsdGeom.Camera(prim) for prim in opened.Traverse() if prim.IsA(UsdGeom.Camera)]
    assert [each.GetPrim().GetName() for each in cameras] == ["Low", "Low_2"]
    seen = cameras[0].GetCamera().frustum
    assert tuple(seen.ComputeLookAtPoint()) == pytest.approx(placement.eye - 5.0 * placement.axes[2], abs=1e-5)
    top, bottom = seen.window.GetMax()[1], seen.window.GetMin()[1]
    expected = placement.half_height if parallel else np.tan(VIEW_ANGLE / 2)
    assert (top, bottom) == pytest.approx((expected, -expected), rel=1e-5)


def test_the_stage_is_valid_gltf(staged, tmp_path):
    project, made = staged
    write_stage(exported_stage(project, made, ExportOptions(), tmp_path / "play.glb"), tmp_path / "play.glb")
    issues = issues_of(tmp_path / "play.glb")
    assert (issues["numErrors"], issues["numWarnings"]) == (0, 0), issues["messages"][:5]


@pytest.mark.parametrize("suffix", [".fbx", ".glb", ".usd"])
def test_blender_shows_the_stage_as_it_was(staged, tmp_path, suffix):
    project, made = staged
    placements = {f"Camera {parallel}": CameraPlacement((0.4, -0.3, 1.1), 3.0, 0.7, 0.3, parallel)
                  for parallel in (False, True)}  # fmt: skip
    for name, placement in placements.items():
        project = project.with_entity("cameras", name, SavedCamera(name, placement))
    path = tmp_path / f"play{suffix}"
    exported = exported_stage(project, made, ExportOptions(frame_rate=30.0), path)
    write_stage(exported, path)
    found = opened_in_blender(path, frames=exported.frame_count, rate=30.0)
    assert len(found["armatures"]) == 3
    worlds = [joint_world(take.skeleton, take.poses)[0] for take in exported.takes]
    for armature in found["armatures"].values():
        hips = armature["heads"][:, armature["bones"].index("Hips")]
        [take, world] = min(
            zip(exported.takes, worlds, strict=True), key=lambda each: np.abs(each[1][:, 0] - hips).max()
        )
        for index, name in enumerate(armature["bones"]):
            joint = take.skeleton.names.index(name)
            assert np.abs(armature["heads"][:, index] - world[:, joint]).max() < HUNDREDTH_OF_A_MILLIMETRE
    names = {name.replace("_", " "): record["places"] for name, record in found["objects"].items()}
    for prop in exported.props:
        assert np.abs(names[prop.name] - prop.places).max() < HUNDREDTH_OF_A_MILLIMETRE
    cameras = {name.replace("_", " "): camera for name, camera in found["cameras"].items()}
    for name, placement in placements.items():
        assert names[name][0] == pytest.approx(placement.eye, abs=HUNDREDTH_OF_A_MILLIMETRE)
        assert np.array(cameras[name]["axes"]) == pytest.approx(placement.axes, abs=1e-6)
        assert cameras[name]["parallel"] == placement.parallel
    assert cameras["Camera False"]["angle"] == pytest.approx(VIEW_ANGLE, abs=1e-4)


def test_a_range_of_the_stage_at_another_rate_holds_who_does_not_play(staged, tmp_path):
    project, made = staged
    exported = exported_stage(project, made, ExportOptions(begin=0.1, end=0.3, frame_rate=100.0), tmp_path / "a.glb")
    assert (exported.frame_count, exported.frame_rate) == (21, 100.0)
    late = joint_world(exported.takes[2].skeleton, exported.takes[2].poses)[0]
    assert np.abs(np.diff(late[:11], axis=0)).max() == 0.0
    assert np.abs(np.diff(late[10:], axis=0)).max() > 0.0
    with pytest.raises(Exception, match="before the range begins"):
        exported_stage(project, made, ExportOptions(begin=9.0), tmp_path / "a.glb")


@pytest.mark.parametrize("shape", PropShape)
def test_props_are_closed_and_seen_from_outside(shape):
    prop = Prop("Thing", (0.4, 0.6, 0.8), shape=shape, mesh=WEDGE if shape is PropShape.MESH else None)
    surface = prop_surface(prop)
    assert np.abs(np.ptp(surface.vertices, axis=0) - prop.size).max() < 0.01
    corners = surface.vertices[surface.triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert (np.linalg.norm(normals, axis=1) > 0.0).all()
    assert np.einsum("ti,tki->tk", normals, surface.normals[surface.triangles]).min() > 0.0
    assert np.einsum("ti,ti->", normals, corners.mean(axis=1)) > 0.0


@pytest.mark.parametrize("suffix", ["bvh", "fbx"])
def test_performers_one_by_one_stand_where_they_stood_or_at_their_origin(staged, tmp_path, capsys, suffix):
    project, made = staged
    write_project(tmp_path / "play.studio", project, new_document_id())
    command = ["adapt", "--stage", str(tmp_path / "play.studio"), "--format", suffix, "--json"]
    for more in ([], ["--at-origin"]):
        out = tmp_path / f"out{len(more)}"
        assert main([*command, "--out", str(out), *more]) == 0
        report = json.loads(capsys.readouterr().out)
        for record, (key, performance) in zip(report["performers"], made.items(), strict=True):
            performer = project.performers[key]
            assert record["place"]["position"] == list(performer.position)
            assert record["place"]["heading_deg"] == pytest.approx(np.degrees(performer.heading))
            back = load_capture(out / f"{performer.name.lower()}.{suffix}")
            hips = joint_world(back.skeleton, back.poses)[0][:, back.skeleton.index("Hips")]
            place = Placement() if more else Placement.of(performer)
            expected = place.to_stage(performance.adapted_on_stage.positions[:, 0])
            assert np.abs(hips - expected)[:, :2].max() < HUNDREDTH_OF_A_MILLIMETRE


def test_a_stage_in_one_file_is_made_on_the_command_line(staged, tmp_path, capsys):
    project, _made = staged
    write_project(tmp_path / "play.studio", project, new_document_id())
    command = [
        "adapt",
        "--stage",
        str(tmp_path / "play.studio"),
        "--out",
        str(tmp_path / "out"),
        "--one-file",
        "--json",
    ]
    assert main([*command, "--format", "bvh"]) == 1
    assert "is not a file format for a whole stage: choose .fbx" in capsys.readouterr().out
    assert main([*command, "--format", "glb"]) == 0
    report = json.loads(capsys.readouterr().out)
    assert {each["file"] for each in report["performers"]} == {str(tmp_path / "out" / "play.glb")}
    assert len(gltf_places(tmp_path / "out" / "play.glb")) > 60
    assert main(["adapt", "walk.bvh", "--out", str(tmp_path / "o"), "--one-file"]) == 1
    assert "name a project or a scene with --stage" in capsys.readouterr().err
