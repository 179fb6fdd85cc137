"""Body maps of characters: chosen anew, a character is measured and bound anew by the joints of its own rig."""

import numpy as np
import pytest

from studio.core.errors import StudioError
from studio.core.mesh.rig import rig_body_map
from studio.core.mesh.skin import bound_pose
from studio.io.figure.body import remapped_character
from tests.io.character_files import Gltf
from tests.io.test_characters import read


def exchanged(**joints):
    sides = (("left", "right"), ("right", "left"))
    return {f"{side}_{part}": f"{other}{joint}" for side, other in sides for part, joint in joints.items()}


SWAPPED_ARMS = exchanged(upper_arm="UpperArm", forearm="LowerArm", hand="Hand")
SWAPPED_LEGS = exchanged(thigh="UpperLeg", shank="LowerLeg", foot="Foot", toe="Toes")


def names_of(character):
    skin = character.skin
    found = rig_body_map(skin.rig, character.build.layout.spine_count)
    return {part: skin.rig.names[joint] for part, joint in found.parts.items()} | {
        f"spine_{index}": skin.rig.names[joint] for index, joint in enumerate(found.spine) if index
    }


def assert_alike(first, second):
    for name in ("leg", "arm", "hand", "foot", "toe", "clavicle", "head", "ankle_height"):
        assert getattr(first.build, name) == pytest.approx(getattr(second.build, name), abs=1e-5), name
    assert first.skin.vertices == pytest.approx(second.skin.vertices, abs=1e-5)
    assert (first.skin.segments[:, 0] == second.skin.segments[:, 0]).all()
    assert first.skin.rig.positions == pytest.approx(second.skin.rig.positions, abs=1e-5)


def test_the_same_map_gives_the_same_body(tmp_path):
    found = read(tmp_path, Gltf().glb())
    assert names_of(found.character) == found.joints
    assert_alike(remapped_character(found.character, found.joints), found.character)


@pytest.mark.parametrize(
    "wrong", [SWAPPED_ARMS, SWAPPED_LEGS, SWAPPED_ARMS | SWAPPED_LEGS, {"head": "neck", "neck": ""}]
)
def test_a_wrong_map_is_mended(tmp_path, wrong):
    right = read(tmp_path, Gltf().glb())
    mistaken = remapped_character(
        right.character, {part: name for part, name in (right.joints | wrong).items() if name}
    )
    assert names_of(mistaken) != right.joints
    assert_alike(remapped_character(mistaken, right.joints), right.character)


def test_a_character_keeps_all_that_its_body_map_does_not_say(tmp_path):
    found = read(tmp_path, Gltf().glb())
    changed = remapped_character(found.character, found.joints | SWAPPED_ARMS)
    assert changed.name == found.character.name
    assert changed.colour == found.character.colour
    assert changed.skin.appearance is found.character.skin.appearance
    positions, _ = bound_pose(changed.skin, changed.build)
    assert np.isfinite(positions).all()


def test_a_map_that_makes_no_body_is_refused_in_a_sentence(tmp_path):
    found = read(tmp_path, Gltf().glb())
    with pytest.raises(StudioError, match="left hand"):
        remapped_character(found.character, {part: name for part, name in found.joints.items() if part != "left_hand"})
    with pytest.raises(StudioError, match="tail"):
        remapped_character(found.character, found.joints | {"head": "tail"})
    with pytest.raises(StudioError, match="leftLowerArm cannot play several parts"):
        remapped_character(found.character, found.joints | {"left_hand": "leftLowerArm"})
