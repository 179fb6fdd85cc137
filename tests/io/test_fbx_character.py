"""FBX characters: the body and the skin that the file has, as they were bound."""

from pathlib import Path

import numpy as np
import pytest

from studio.core.body.canonical import BodyPart
from studio.core.errors import StudioError
from studio.core.rigs.embodiment import measured_body
from studio.io.importing import load_capture, load_character, read_file
from studio.io.registry import ReadCapture, ReadCharacter
from tests.io.character_files import PIXEL
from tests.io.fbx_skin import CLOTH, skinned_fbx
from tests.io.fbx_text import fbx_text


def written(folder: Path, text: str) -> Path:
    path = folder / "hero.fbx"
    path.write_text(text)
    return path


@pytest.mark.parametrize("raised", [0.0, 30.0])
def test_it_has_the_measures_of_its_joints_and_the_skin_hangs_from_them(tmp_path: Path, raised: float) -> None:
    read = load_character(written(tmp_path, skinned_fbx(raised)))
    capture = load_capture(tmp_path / "hero.fbx")
    assert capture.body_map is not None
    expected, _ = measured_body(capture.skeleton, capture.body_map)
    build, skin = read.character.build, read.character.skin
    assert build.leg == pytest.approx(expected.leg, rel=1e-4)
    assert build.arm == pytest.approx(expected.arm, rel=1e-4)
    assert read.moves
    for part in (BodyPart.LEFT_THIGH, BodyPart.RIGHT_FOREARM, BodyPart.HEAD):
        of_part = skin.vertices[skin.segments[:, 0] == build.layout.segment_of_part(part)]
        assert len(of_part) >= 8
    sides = skin.vertices[skin.segments[:, 0] == build.layout.segment_of_part(BodyPart.LEFT_THIGH), 1]
    assert sides.min() > 0.0
    one, two, three = np.swapaxes(skin.vertices[skin.triangles].astype(float), 0, 1)
    assert np.einsum("tk,tk->t", one, np.cross(two, three)).sum() > 0.0  # turned outwards
    assert np.einsum("tk,tk->t", np.cross(two - one, three - one), skin.normals[skin.triangles[:, 0]]).min() > 0.0
    assert skin.appearance is not None
    assert skin.appearance.materials[0].colour == "#CC331A"


def test_points_that_hang_from_nothing_go_with_the_nearest_that_do(tmp_path: Path) -> None:
    character = load_character(written(tmp_path, skinned_fbx(bare=True))).character
    weights = character.skin.weights
    assert weights.sum(axis=1) == pytest.approx(np.ones(len(weights)), abs=1e-5)


def test_a_file_with_a_skin_is_a_character_and_one_without_is_a_motion(tmp_path: Path) -> None:
    path = written(tmp_path, skinned_fbx())
    assert isinstance(read_file(path), ReadCharacter)
    path = written(tmp_path, fbx_text())
    assert isinstance(read_file(path), ReadCapture)
    with pytest.raises(StudioError, match="a skeleton but no mesh: it is a motion"):
        load_character(path)


def test_a_motion_whose_joint_is_called_as_a_skin_is_in_the_file_stays_a_motion(tmp_path: Path) -> None:
    text = fbx_text().replace("Model::Chest", "Model::Cluster")
    assert "Model::Cluster" in text
    read = read_file(written(tmp_path, text))
    assert isinstance(read, ReadCapture)
    assert "Cluster" in read.capture.skeleton.names


PICTURE = 520
"""Number of the object of a texture."""


@pytest.mark.parametrize("place", ["skin.png", "art/skin.png", "hero.fbm/skin.png", "textures/skin.png"])
def test_a_picture_is_found_where_programs_put_it(tmp_path: Path, place: str) -> None:
    textured = f"""Texture: {PICTURE}, "Texture::skin", "" {{ Type: "TextureVideoClip"
Version: 202
FileName: "D:\\\\jobs\\\\hero\\\\art\\\\skin.png"
RelativeFilename: "art\\\\skin.png" }}
}}
Connections: {{
C: "OP",{PICTURE},{CLOTH}, "DiffuseColor"
"""
    (tmp_path / place).parent.mkdir(exist_ok=True)
    (tmp_path / place).write_bytes(PIXEL)
    text = skinned_fbx().replace("}\nConnections: {\n", textured.replace("\\\\", "\\"), 1)
    read = load_character(written(tmp_path, text))
    look = read.character.skin.appearance
    assert look is not None
    assert look.materials[0].texture is not None, read.repairs
    assert look.materials[0].texture.tobytes() == PIXEL
