"""Character files that nobody vetted: each bad case by name, with the sentence it must produce."""

import gzip
import json
import re
import struct
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from studio.io.importing import load_character
from tests.io.character_files import HANIM, NAMES, PIXEL, Gltf, vrml, x3d
from tests.io.refused import refused


def gltf(change: Callable[[dict[str, Any]], object], vrm: int | None = None) -> bytes:
    """A figure whose JSON was changed."""
    made = Gltf(vrm)
    change(made.root)
    return made.glb()


def accessor(index: int, **values: Any) -> bytes:
    return gltf(lambda root: root["accessors"][index].update(values))


def numbers(index: int, kind: str, array: np.ndarray) -> bytes:
    """A figure with other numbers in an attribute."""
    made = Gltf()
    made.root["meshes"][0]["primitives"][0]["attributes"][index] = made.add(array, kind)
    return made.glb()


def skin_of(**values: Any) -> bytes:
    return gltf(lambda root: root["skins"][0].update(values))


def node(index: int, **values: Any) -> bytes:
    return gltf(lambda root: root["nodes"][index].update(values))


def buffer(uri: str) -> bytes:
    return gltf(lambda root: root.update(buffers=[{"byteLength": 9, "uri": uri}]))


def flat_bind() -> bytes:
    made = Gltf()
    made.root["skins"][0]["inverseBindMatrices"] = made.add(np.zeros((19, 16), "<f4"), "MAT4")
    return made.glb()


def picture_bomb() -> bytes:
    """A PNG of 60,000 x 60,000 pixels in 60 bytes."""
    header = struct.pack(">IIBBBBB", 60_000, 60_000, 8, 2, 0, 0, 0)
    chunk = b"IHDR" + header
    return PIXEL[:8] + struct.pack(">I", 13) + chunk + struct.pack(">I", zlib.crc32(chunk)) + PIXEL[33:]


def nested(depth: int) -> str:
    return "Group { children [ " * depth + "] }" * depth


def at_one_place(text: str) -> str:
    return re.sub(r"center [-\d.]+ [-\d.]+ [-\d.]+", "center 0 0.5 0", text)


GLTF = {
    "empty": (b"", "is empty"),
    "not glTF at all": (b"PK\x03\x04 a zip", r"is a packed file \(ZIP\)"),
    "cut in its header": (Gltf().glb()[:15], "is cut off: it has 15 bytes"),
    "cut in its content": (Gltf().glb()[:-500], "is cut off: it should have"),
    "a part that ends behind the file": (
        b"glTF" + struct.pack("<IIII", 2, 30, 900, 0x4E4F534A) + b"{}        ",
        "byte 12: a part of 900 bytes ends after the file does",
    ),
    "without a JSON part": (b"glTF" + struct.pack("<IIII", 2, 24, 4, 0x004E4942) + b"abcd", "has no JSON part"),
    "of version 1": (b"glTF" + struct.pack("<II", 1, 20) + b"\0" * 8, "GLB of version 1"),
    "JSON of version 1": (gltf(lambda root: root.update(asset={"version": "1.0"})), "glTF of version 1.0"),
    "a list in place of a record": (b'[{"asset": 1}]', "its JSON is not a record"),
    "nested without end": (b'{"asset":' + b"[" * 100_000, "not readable as JSON"),
    "compressed meshes": (
        gltf(lambda root: root.update(extensionsRequired=["KHR_draco_mesh_compression"])),
        "needs KHR_draco_mesh_compression",
    ),
    "an accessor behind its bytes": (accessor(0, byteOffset=10_000_000), "end after its .* bytes"),
    "an accessor of a milliard entries": (accessor(0, count=10**9), "claims 1000000000 entries"),
    "an empty accessor of a milliard entries": (
        gltf(lambda root: root["accessors"].__setitem__(0, {"count": 10**9, "type": "VEC3", "componentType": 5126})),
        "claims 1000000000 entries",
    ),
    "a count below zero": (accessor(0, count=-1), "'count' should be a whole number of 0 or more"),
    "a count that is a text": (accessor(0, count="many"), "'count' should be a whole number"),
    "an unknown component type": (accessor(0, componentType=5130), "'componentType' should be one of"),
    "a place of two numbers": (accessor(0, type="VEC2"), "'type' should be VEC3"),
    "an index beyond all vertices": (
        numbers("JOINTS_0", "VEC4", np.full((152, 4), 900, "<u2")),
        "holds the index 900, and there are only 19",
    ),
    "an attribute of another length": (
        numbers("WEIGHTS_0", "VEC4", np.ones((3, 4), "<f4")),
        "WEIGHTS_0 has 3 entries for 152 vertices",
    ),
    "joints as fractions": (numbers("JOINTS_0", "VEC4", np.zeros((152, 4), "<f4")), "should hold whole numbers"),
    "a vertex that is no number": (
        numbers("POSITION", "VEC3", np.full((152, 3), np.nan, "<f4")),
        "a number that is out of range",
    ),
    "a buffer view behind its buffer": (
        gltf(lambda root: root["bufferViews"][0].update(byteLength=10**8)),
        "ends at byte 100000000 of a buffer",
    ),
    "a buffer view that is not there": (accessor(0, bufferView=99), "no bufferViews.99."),
    "a buffer longer than its bytes": (
        gltf(lambda root: root.update(buffers=[{"byteLength": 10**8}])),
        "should have 100000000 bytes",
    ),
    "a buffer from the net": (
        buffer("https://example.org/a.bin"),
        "'https://example.org/a.bin', which is not in its folder",
    ),
    "a buffer out of its folder": (buffer("../../etc/passwd"), "leads out of its folder"),
    "a buffer out of its folder, in disguise": (buffer("%2e%2e%5cpasswd"), "leads out of its folder"),
    "a buffer at an absolute place": (buffer("/etc/passwd"), "which is not in its folder"),
    "a buffer on another drive": (buffer("C:\\secret.bin"), "which is not in its folder"),
    "a buffer that is a device": (buffer("."), "leads out of its folder"),
    "a buffer that is missing": (buffer("gone.bin"), "gone.bin could not be read: there is no such file"),
    "damaged base64": (buffer("data:;base64,a*b"), "its base64 data are damaged"),
    "nodes in a ring": (
        gltf(lambda root: (root["nodes"][4].update(children=[0]), root["nodes"][0].update(name="x"))),
        "its parents form a ring",
    ),
    "a node that hangs from itself": (node(4, children=[4]), "has two parents or is its own"),
    "a node that hangs from two": (node(4, children=[7]), "has two parents or is its own"),
    "a child that is not there": (node(4, children=[400]), "'children' should be a list of numbers below 20"),
    "a rotation of zero": (node(4, rotation=[0, 0, 0, 0]), "'rotation' should be a rotation, and not zero"),
    "a place out of range": (
        node(4, translation=[1e300, 0, 0]),
        "'translation' should be 3 believable numbers",
    ),
    "a mesh that is not there": (node(19, mesh=7), "'mesh' names number 7, and there are only 1"),
    "a skin without joints": (skin_of(joints=[]), "it needs joints, and each of them once"),
    "a joint twice in a skin": (skin_of(joints=[0, 0]), "it needs joints, and each of them once"),
    "too few bind matrices": (
        gltf(lambda root: root["accessors"][5].update(count=3)),
        "has 19 joints and 3 bind matrices",
    ),
    "flat bind matrices": (flat_bind(), "an inverse bind matrix is singular"),
    "neither skin nor bones": (b'{"asset": {"version": "2.0"}}', "has no skeleton"),
    "a mesh that hangs from no bones": (
        gltf(
            lambda root: (
                root.update(skins=[], nodes=[{"mesh": 0, "name": "body"}, {"name": "Camera"}]),
                root["scenes"][0].update(nodes=[0, 1]) if "scenes" in root else None,
            )
        ),
        "has no skeleton .bones., so its mesh cannot move",
    ),
    "a missing leg": (node(11, children=[]), "shows no complete human body: no left leg"),
    "a missing arm": (node(8, children=[]), "shows no complete human body: .*no right arm"),
    "legs without length": (
        gltf(lambda root: [root["nodes"][k].update(translation=[0, 0, 0]) for k in (12, 13, 16, 17)], vrm=1),
        "a bone of the left leg .* has no length",
    ),
    "a VRM without hips": (
        gltf(lambda root: root["extensions"]["VRMC_vrm"]["humanoid"]["humanBones"].pop("hips"), vrm=1),
        "its humanoid has no hips",
    ),
    "a body without width": (
        gltf(lambda root: [root["nodes"][k].update(translation=[0, -0.05, 0]) for k in (11, 15)], vrm=1),
        "its body has no width or no height",
    ),
    "a VRM without a hand": (
        gltf(lambda root: root["extensions"]["VRMC_vrm"]["humanoid"]["humanBones"].pop("leftHand"), vrm=1),
        "its humanoid has no leftHand",
    ),
    "a VRM bone that is not there": (
        gltf(lambda root: root["extensions"]["VRM"]["humanoid"]["humanBones"][3].update(node=777), vrm=0),
        "'node' names number 777",
    ),
    "a VRM bone twice": (
        gltf(lambda root: root["extensions"]["VRMC_vrm"]["humanoid"]["humanBones"].update(leftHand={"node": 6}), vrm=1),
        "a bone of the left arm .* has no length",
    ),
    "a skeleton without a mesh": (gltf(lambda root: root["nodes"].pop()), "has a skeleton but no mesh"),
}

VRML = {
    "cut in a node": (vrml()[:3000], "is cut off: a brace or bracket is still open|expected"),
    "without its first line": (vrml(header=""), "does not begin with '#VRML V2.0'"),
    "a brace too many": (vrml() + "\n}", "a name was expected, not '}'"),
    "a text that is not closed": (vrml(more='WorldInfo { title "open }'), "line 8: a text is not closed"),
    "nested without end": (vrml(more=nested(3000)), "nested more than 120 deep"),
    "a number that is none": (vrml().replace("center 0.0", "center nan", 1), "expected"),
    "two numbers for a place": (
        vrml().replace("center 0.0 1.1 0.0", "center 0.0 1.1", 1),
        "'center' has 2 numbers, which is not a multiple of 3",
    ),
    "a number beyond belief": (vrml().replace("center 0.0", "center 1e300", 1), "a number that is out of range"),
    "without a humanoid": ("#VRML V2.0 utf8\nGroup { }", "shows no humanoid"),
    "a humanoid without joints": ("#VRML V2.0 utf8\nHAnimHumanoid { }", "its humanoid has no joints"),
    "an open PROTO": ("#VRML V2.0 utf8\nPROTO A [ ] { Group {", "the PROTO A is not closed"),
    "USE a thousand million times": (
        vrml().replace(
            "skeleton [",
            "skeleton [ DEF G0 Group { children Group {} } "
            + " ".join(f"DEF G{k + 1} Group {{ children [ {f'USE G{k} ' * 10}] }}" for k in range(9)),
        ),
        "USE shows more than 300,000 nodes",
    ),
    "a face that names no point": (vrml().replace("coordIndex [ 0", "coordIndex [ 9999"), "a face names point 9999"),
    "a skin point that is not there": (
        vrml().replace("skinCoordIndex [ 0 1", "skinCoordIndex [ 0 70000"),
        "joint 'humanoid_root' moves point 70000 of a skin of 152",
    ),
    "packed and damaged": (gzip.compress(vrml().encode())[:40] + b"x" * 40, "is packed with gzip and damaged"),
    "packed a thousandfold": (gzip.compress(bytes(61_000_000)), "would unpack to more than 60 MB"),
    "all joints at one place": (at_one_place(vrml()), "shows no complete human body"),
}

BILLION = '<!DOCTYPE lolz [<!ENTITY a "ha"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;&a;&a;">]>'
X3D = {
    "a thousand million laughs": (x3d(before=BILLION, inside="&b;"), "line 2: it declares the entity 'a'"),
    "an entity from a file": (
        x3d(before='<!DOCTYPE X3D [<!ENTITY secret SYSTEM "file:///etc/passwd">]>', inside="&secret;"),
        "it declares the entity 'secret'",
    ),
    "cut in an element": (x3d()[:2500], "line 19: unclosed token"),
    "elements crossed over": (x3d().replace("</Scene>", "</Shape>"), "mismatched tag"),
    "an unknown encoding": (x3d().replace("UTF-8", "klingon"), "encoding"),
    "nested without end": (x3d(inside="<Group>" * 5000 + "</Group>" * 5000), "nested more than 120 deep"),
    "a word among its numbers": (x3d().replace("center='0 0.95 0'", "center='0 high 0'"), "'high' is among its"),
    "numbers in another language": (x3d().replace("center='0 0.95 0'", "center='0 0,95 0'"), "'center' has 4 numbers"),
    "without a humanoid": (x3d(root="Group"), "shows no humanoid"),
    "no text at all": ("<X3D", "line 1"),
}


CASES = {
    f"{suffix}: {case}": (suffix, *told)
    for suffix, table in ((".glb", GLTF), (".wrl", VRML), (".x3d", X3D))
    for case, told in table.items()
}


@pytest.mark.parametrize("case", CASES)
def test_a_bad_character_is_refused_in_a_sentence(tmp_path: Path, case: str):
    suffix, content, words = CASES[case]
    path = (tmp_path / "hero").with_suffix(suffix)
    assert refused(load_character, path, content, words).endswith(".")


PICTURES = {
    "a picture of 60,000 pixels a side": (picture_bomb(), "it declares more pixels than are supported"),
    "a picture cut off": (PIXEL[:40], "it is damaged|neither PNG nor JPEG"),
    "a picture that is a text": (b"GIF89a and more", "neither PNG nor JPEG"),
}


@pytest.mark.parametrize("case", PICTURES)
def test_a_bad_picture_is_left_out_and_told(tmp_path: Path, case: str):
    content, words = PICTURES[case]
    made = Gltf()
    made.root["images"] = [{"uri": "face.png"}]
    (tmp_path / "face.png").write_bytes(content)
    (tmp_path / "hero.glb").write_bytes(made.glb())
    read = load_character(tmp_path / "hero.glb")
    [repair] = read.repairs
    assert re.search(words, repair), repair


def test_a_picture_out_of_its_folder_is_left_out_and_told(tmp_path: Path):
    made = Gltf()
    made.root["images"] = [{"uri": "../face.png"}]
    (tmp_path / "face.png").write_bytes(PIXEL)
    inner = tmp_path / "inner"
    inner.mkdir()
    (inner / "hero.glb").write_bytes(made.glb())
    [repair] = load_character(inner / "hero.glb").repairs
    assert "leads out of its folder" in repair


def test_a_link_out_of_the_folder_is_not_followed(tmp_path: Path):
    made = Gltf()
    made.root["buffers"] = [{"byteLength": 9, "uri": "link.bin"}]
    inner = tmp_path / "inner"
    inner.mkdir()
    (tmp_path / "secret").write_bytes(b"123456789")
    (inner / "link.bin").symlink_to(tmp_path / "secret")
    refused(load_character, inner / "hero.glb", made.glb(), "leads out of its folder")


def test_every_part_is_there_to_be_missed():
    """The cases above replace what they mean to: a case whose file is whole would be read."""
    assert set(HANIM) == set(NAMES)
    assert json.loads(Gltf().gltf())["skins"][0]["joints"] == list(range(19))
    assert len(GLTF) + len(VRML) + len(X3D) + len(PICTURES) > 70
