"""Character files of every format give the same body; what is put right is told."""

import base64
import gzip
import json
import re
from pathlib import Path

import numpy as np
import pytest

from studio.core.errors import StudioError
from studio.core.mesh.appearance import Material
from studio.core.mesh.skin import bound_pose
from studio.io.export import take_of_standing, write_take
from studio.io.importing import ImportOptions, load_character
from studio.io.project.character_file import read_character, write_character
from studio.io.registry import ReadCharacter
from tests.io.character_files import PIXEL, PLACES, Gltf, vrml, x3d

FILES = {
    "plain.gltf": lambda: Gltf().gltf(),
    "plain.glb": lambda: Gltf().glb(),
    "version0.vrm": lambda: Gltf(vrm=0).glb(),
    "version1.vrm": lambda: Gltf(vrm=1).glb(),
    "skin.wrl": lambda: vrml().encode(),
    "skin.x3dv": lambda: vrml(header="\ufeff#X3D V3.0 utf8\r\nPROFILE Immersive\r\nCOMPONENT H-Anim:1").encode(),
    "segments.wrl": lambda: vrml(skinned=False).encode(),
    "packed.wrl": lambda: gzip.compress(vrml(more="PixelTexture { image 1 1 3 0xFF0000 }").encode()),
    "skin.x3d": lambda: x3d().encode(),
}


def read(tmp_path: Path, content: bytes, name: str = "hero.glb", **options: object) -> ReadCharacter:
    path = tmp_path / name
    path.write_bytes(content)
    return load_character(path, ImportOptions(**options))  # type: ignore[arg-type]


@pytest.mark.parametrize("name", FILES)
def test_every_format_gives_the_same_body(tmp_path: Path, name: str):
    found = read(tmp_path, FILES[name](), name)
    build = found.character.build
    assert build.leg == pytest.approx(np.array([[0.4, 0.42], [0.4, 0.42]]), abs=1e-6)
    assert build.arm == pytest.approx(np.array([[0.27, 0.25], [0.27, 0.25]]), abs=1e-6)
    assert build.layout.spine_count == 3
    assert build.ankle_height == pytest.approx([0.08, 0.08], abs=1e-6)
    assert found.repairs == ()
    positions, _ = bound_pose(found.character.skin, build)
    left_wrist = positions[build.layout.wrist_point(0)] - positions[0]
    assert left_wrist == pytest.approx([0.0, 0.7, 0.47], abs=1e-6)


@pytest.mark.parametrize("name", FILES)
def test_each_vertex_goes_with_the_segment_of_its_joint(tmp_path: Path, name: str):
    character = read(tmp_path, FILES[name](), name).character
    skin, build = character.skin, character.build
    positions, _ = bound_pose(skin, build)
    proximal = positions[list(build.layout.proximal_points())]
    near = np.linalg.norm(skin.vertices - proximal[skin.segments[:, 0]], axis=1)
    assert near.max() < 0.09
    assert (skin.weights[:, 0] == 1.0).all()


def test_a_figure_on_its_back_in_centimetres_stands_up_in_metres(tmp_path: Path):
    made = Gltf()
    lying = {"children": [0], "rotation": [-(0.5**0.5), 0.0, 0.0, 0.5**0.5], "scale": [100.0, 100.0, 100.0]}
    made.root["nodes"].append(lying)
    found = read(tmp_path, made.glb())
    assert found.character.build.leg[0] == pytest.approx([0.4, 0.42], abs=1e-6)
    assert [guess.value for guess in found.guesses if guess.subject == "unit"] == ["cm"]
    assert found.character.skin.vertices[:, 2].max() == pytest.approx(PLACES[:, 1].max() + 0.04, abs=1e-5)


def test_joints_without_names_are_found_by_the_shape_of_the_body(tmp_path: Path):
    made = Gltf()
    for node in made.root["nodes"]:
        node.pop("name", None)
    found = read(tmp_path, made.glb())
    assert found.joints["left_hand"] == "Node_7"
    assert found.joints["right_foot"] == "Node_17"
    assert found.joints["head"] == "Node_4"
    assert any("by shape" in guess.value for guess in found.guesses)


def test_the_user_says_what_the_file_does_not(tmp_path: Path):
    found = read(tmp_path, Gltf().glb(), body_map={"head": "neck"}, unit="0.5")
    assert found.joints["head"] == "neck"
    assert found.character.build.leg[0] == pytest.approx([0.2, 0.21], abs=1e-6)


def test_weights_that_do_not_sum_to_one_are_made_to(tmp_path: Path):
    made = Gltf()
    shares = np.tile([7.0, 0.0, 0.0, 0.0], (len(PLACES) * 8, 1)).astype("<f4")
    made.root["meshes"][0]["primitives"][0]["attributes"]["WEIGHTS_0"] = made.add(shares, "VEC4")
    assert (read(tmp_path, made.glb()).character.skin.weights[:, 0] == 1.0).all()


def test_vertices_without_any_weight_are_told(tmp_path: Path):
    made = Gltf()
    shares = np.zeros((len(PLACES) * 8, 4), "<f4")
    shares[9:, 0] = 1.0
    made.root["meshes"][0]["primitives"][0]["attributes"]["WEIGHTS_0"] = made.add(shares, "VEC4")
    assert read(tmp_path, made.glb()).repairs == ("9 vertices had no weight; the first joint moves them.",)


def test_a_sparse_accessor_replaces_what_it_names(tmp_path: Path):
    made = Gltf()
    accessor = made.root["accessors"][0]
    places = made.add(np.array([[0]], "<u2"), "SCALAR")
    values = made.add(np.array([[0.0, 1.9, 0.0]], "<f4"), "VEC3")
    accessor["sparse"] = {
        "count": 1,
        "indices": {"bufferView": places, "componentType": 5123},
        "values": {"bufferView": values},
    }
    assert read(tmp_path, made.glb()).character.skin.vertices[0, 2] == pytest.approx(1.9, abs=1e-6)


def test_a_buffer_and_a_picture_beside_the_file_are_read(tmp_path: Path):
    made = Gltf()
    made.root["buffers"] = [{"byteLength": len(made.binary), "uri": "hero%20data.bin"}]
    made.root["images"] = [{"uri": "face.png"}]
    (tmp_path / "hero data.bin").write_bytes(made.binary)
    (tmp_path / "face.png").write_bytes(PIXEL)
    look = read(tmp_path, made.gltf(), "hero.gltf").character.skin.appearance
    assert look is not None
    [material] = look.materials
    assert isinstance(material, Material)
    assert material.texture is not None
    assert material.texture.tobytes() == PIXEL


def test_what_lies_in_a_drawn_hand_is_left_out_and_told(tmp_path: Path):
    made = Gltf()
    axe = {"POSITION": 0}
    made.root["meshes"].append({"primitives": [{"attributes": axe, "indices": 4}]})
    made.root["nodes"].append({"name": "axe", "mesh": 1})
    made.root["nodes"][7]["children"] = [len(made.root["nodes"]) - 1]
    found = read(tmp_path, made.glb())
    assert found.repairs == ("What it holds in its hands was left out: axe.",)
    assert len(found.character.skin.vertices) == 8 * len(PLACES)


def test_points_of_a_skin_that_no_joint_moves_go_with_the_nearest_and_are_told(tmp_path: Path):
    text = vrml().replace("skinCoordIndex [ 32 33 34 35 36 37 38 39 ]", "skinCoordIndex [ ]", 1)
    found = read(tmp_path, text.encode(), "hero.wrl")
    assert found.repairs == ("8 points of the skin had no joint; they go with the nearest one.",)
    assert found.character.build.head > 0.03


@pytest.mark.parametrize("name", ["plain.glb", "skin.x3d"])
def test_in_our_own_file_nothing_of_it_is_lost(tmp_path: Path, name: str):
    character = read(tmp_path, FILES[name](), name).character
    write_character(character, tmp_path / "own.json")
    again = read_character(tmp_path / "own.json")
    assert again.build == character.build
    assert np.array_equal(again.skin.stance, character.skin.stance)  # type: ignore[arg-type]
    one, other = again.skin.appearance, character.skin.appearance
    assert one is not None
    assert other is not None
    assert np.array_equal(one.coordinates, other.coordinates)
    assert [each.colour for each in one.materials] == [each.colour for each in other.materials]
    for mine, theirs in zip(one.materials, other.materials, strict=True):
        assert (mine.texture is None) == (theirs.texture is None)
        assert mine.texture is None or np.array_equal(mine.texture, theirs.texture)


def test_data_uris_are_read_as_base64(tmp_path: Path):
    made = Gltf()
    made.root["images"] = [{"uri": "data:image/png;base64," + base64.b64encode(b"no picture").decode()}]
    found = read(tmp_path, json.dumps(json.loads(made.gltf())).encode(), "hero.gltf")
    assert found.repairs == ("hero.gltf, images[0]: the image was left out, it is neither PNG nor JPEG.",)


def low_articulation(joints: dict[str, tuple[str, tuple[float, float, float]]], name: str) -> str:
    """A joint of VRML with all below it; each has a box at its centre."""
    x, y, z = joints[name][1]
    below = " ".join(low_articulation(joints, child) for child, (parent, _) in joints.items() if parent == name)
    box = f"Transform {{ translation {x} {y} {z} children Shape {{ geometry Box {{ size 0.1 0.1 0.1 }} }} }}"
    segment = f"HAnimSegment {{ children {box} }}"
    return f'HAnimJoint {{ name "{name}" center {x} {y} {z} children [ {segment} {below} ] }}'


def test_a_body_whose_feet_point_backwards_by_its_names_is_told(tmp_path: Path):
    exchanged = re.sub(rb'"name": "(left|right)', lambda m: b'"name": "' + {b"left": b"right", b"right": b"left"}[m[1]],
                       Gltf().gltf())  # fmt: skip
    for content, expected in ((Gltf().gltf(), []), (exchanged, ["as the joints are named"])):
        found = read(tmp_path, content, "hero.gltf")
        assert [guess.value for guess in found.guesses if guess.subject == "sides"] == expected


def test_joints_of_a_humanoid_in_xml_need_no_container_field(tmp_path: Path):
    found = read(tmp_path, x3d().replace(" containerField='skeleton'", "").encode(), "hero.x3d")
    plain = read(tmp_path, x3d().encode(), "hero.x3d")
    assert found.joints == plain.joints
    assert found.character.morphology == plain.character.morphology


def test_level_one_of_articulation_is_enough(tmp_path: Path):
    """Shoulders and skull hang from one vertebra; feet have one joint before the toes."""
    joints = {"HumanoidRoot": ("", (0.0, 0.95, 0.0)), "sacroiliac": ("HumanoidRoot", (0.0, 0.92, 0.0))}
    joints |= {"vl5": ("HumanoidRoot", (0.0, 1.05, 0.0)), "skullbase": ("vl5", (0.0, 1.55, 0.0))}
    for side, sign in (("l", 1.0), ("r", -1.0)):
        for joint, parent, place in (
            ("hip", "sacroiliac", (0.1, 0.9, 0.0)),
            ("knee", "hip", (0.1, 0.5, 0.0)),
            ("ankle", "knee", (0.1, 0.1, 0.0)),
            ("midtarsal", "ankle", (0.1, 0.05, 0.1)),
            ("shoulder", "vl5", (0.18, 1.42, 0.0)),
            ("elbow", "shoulder", (0.18, 1.15, 0.0)),
            ("wrist", "elbow", (0.18, 0.9, 0.0)),
        ):
            above = parent if parent in joints else f"{side}_{parent}"
            joints[f"{side}_{joint}"] = (above, (sign * place[0], *place[1:]))
    text = f"#VRML V2.0 utf8\nHAnimHumanoid {{ skeleton {low_articulation(joints, 'HumanoidRoot')} }}"
    found = read(tmp_path, text.encode(), "hero.wrl")
    build = found.character.build
    assert build.layout.spine_count == 2
    assert build.leg[0] == pytest.approx([0.4, 0.4], abs=1e-6)
    assert found.joints["left_toe"] == "l_midtarsal"
    assert found.joints["head"] == "skullbase"
    assert build.ankle_height == pytest.approx([0.1, 0.1], abs=1e-6)


def test_a_foot_without_toes_gets_its_length_from_the_mesh(tmp_path: Path):
    low = Gltf(vrm=1)
    for place in (13, 17):
        low.root["nodes"][place].pop("children")
    for side in ("left", "right"):
        low.root["extensions"]["VRMC_vrm"]["humanoid"]["humanBones"].pop(f"{side}Toes")
    assert read(tmp_path, low.glb()).character.build.foot[0, 0] > 0.02


def test_proto_instances_of_the_xml_encoding_are_read(tmp_path: Path):
    text = x3d().replace("<HAnimJoint USE", "<Group USE")
    for field in ("name", "center", "skinCoordIndex", "skinCoordWeight"):
        assert f" {field}='" in text
    text = re.sub(r"<HAnimJoint DEF='\w+' name='(\w+)' center='([^']*)'([^>]*)>", _instance, text)
    text = text.replace("</HAnimJoint>", "</fieldValue></ProtoInstance>")
    declared = "<ProtoDeclare name='Joint'><ProtoBody><Group/></ProtoBody></ProtoDeclare>"
    found = read(tmp_path, text.replace("<Scene>", f"<Scene>{declared}").encode(), "hero.x3d")
    assert found.character.build.leg[0] == pytest.approx([0.4, 0.42], abs=1e-6)
    assert found.repairs == ()


def _instance(found: re.Match[str]) -> str:
    name, centre, rest = found.groups()
    container = "containerField='skeleton'" if "skeleton" in rest else ""
    values = dict(re.findall(r"(\w+)='([^']*)'", rest)) | {"name": name, "center": centre}
    fields = "".join(
        f"<fieldValue name='{key}' value='{value}'/>" for key, value in values.items() if key != "containerField"
    )
    return f"<ProtoInstance name='Joint' {container}>{fields}<fieldValue name='children'>"


@pytest.mark.parametrize(
    ("limit", "module", "name", "words"),
    [
        ("MOST_HANIM_NODES", "studio.io.hanim.vrml", "skin.wrl", "more than 5 nodes"),
        ("_MOST_WORDS", "studio.io.hanim.vrml", "skin.wrl", "more than 5 words"),
        ("MOST_HANIM_NODES", "studio.io.hanim.x3d", "skin.x3d", "more than"),
        ("MOST_FIGURE_JOINTS", "studio.io.hanim.humanoid", "skin.x3d", "more than 5 joints"),
        ("MOST_VERTICES", "studio.io.hanim.humanoid", "skin.x3d", "more than 5 "),
        ("MOST_GLTF_NODES", "studio.io.gltf.nodes", "plain.glb", "the studio takes 5"),
        ("MOST_FIGURE_JOINTS", "studio.io.gltf.figure", "plain.glb", "more than 5 joints"),
        ("MOST_VERTICES", "studio.io.gltf.meshes", "plain.glb", "more than 5 vertices"),
        ("_MOST_RECORDS", "studio.io.gltf.container", "plain.glb", "more than 5 records"),
    ],
)
def test_what_would_take_all_memory_is_refused(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, limit: str, module: str, name: str, words: str
):
    monkeypatch.setattr(f"{module}.{limit}", 5)
    with pytest.raises(StudioError, match=words):
        read(tmp_path, FILES[name](), name)


def test_a_texture_may_be_moved_and_may_cut_holes(tmp_path: Path):
    made = Gltf()
    coordinates = np.tile([[0.25, 0.5]], (len(PLACES) * 8, 1)).astype("<f4")
    primitive = made.root["meshes"][0]["primitives"][0]
    primitive["attributes"]["TEXCOORD_1"] = made.add(coordinates, "VEC2")
    moved = {"offset": [0.1, 0.2], "rotation": np.pi / 2, "scale": [2.0, 1.0], "texCoord": 1}
    slot = {"index": 0, "extensions": {"KHR_texture_transform": moved}}
    made.root["materials"] = [{"alphaMode": "MASK", "pbrMetallicRoughness": {"baseColorTexture": slot}}]
    look = read(tmp_path, made.glb()).character.skin.appearance
    assert look is not None
    assert look.materials[0].cut_out
    # Scaled to (0.5, 0.5), turned to (0.5, -0.5), moved to (0.6, -0.3); upwards from the lower left 1.3.
    assert look.coordinates[0] == pytest.approx([0.6, 1.3], abs=1e-6)


@pytest.mark.parametrize("suffix", [".glb", ".fbx", ".usdz"])
def test_materials_go_out_as_they_came_and_a_picture_once(tmp_path: Path, suffix: str):
    made = Gltf()
    slot = {"baseColorTexture": {"index": 0}}
    made.root["images"] *= 2
    made.root["textures"] = [{"source": 0}, {"source": 1}]
    other = {"baseColorTexture": {"index": 1}}
    made.root["materials"] = [
        {"name": "skin", "pbrMetallicRoughness": slot},
        {"name": "lashes", "pbrMetallicRoughness": other, "alphaMode": "MASK", "doubleSided": True},
        {"name": "skin", "pbrMetallicRoughness": other},
    ]
    [primitive] = made.root["meshes"][0]["primitives"]
    made.root["meshes"][0]["primitives"] = [primitive | {"material": material} for material in range(3)]
    character = read(tmp_path, made.glb()).character
    look = character.skin.appearance
    assert look is not None
    assert [each.name for each in look.materials] == ["skin", "lashes"]
    path = tmp_path / f"out{suffix}"
    write_take(take_of_standing(character), path)
    assert path.read_bytes().count(PIXEL) == 1
    back = load_character(path).character.skin.appearance
    assert back is not None
    for mine, theirs in zip(back.materials, look.materials, strict=True):
        assert mine.name == theirs.name
        assert mine.texture is not None
        assert mine.texture.tobytes() == PIXEL
        if suffix == ".glb":
            assert (mine.two_sided, mine.cut_out) == (theirs.two_sided, theirs.cut_out)
