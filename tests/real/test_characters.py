"""The nine shared characters: read, measured, posed; their feet on the ground and their skin in one piece."""

from functools import lru_cache
from pathlib import Path

import numpy as np
import pytest

from studio.core.body.rest_pose import rest_pose
from studio.core.captures.contacts import contact_mask, ground_contacts
from studio.core.grounds.ground import Ground
from studio.core.mesh.skin import Blending, bound_pose, skin_vertices
from studio.core.quality.metrics import acceleration_ratio, contact_quality
from studio.core.quality.motion_quality import motion_quality
from studio.core.solver.adapt import adapt
from studio.core.solver.grounding.contact_settling import LEAST_LEG_REACH
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.core.solver.source import source_motion
from studio.io.export import take_of_adapted, write_take
from studio.io.importing import load_character
from studio.io.registry import ReadCharacter
from tests.captures import outside_files
from tests.real.taken import contacts_of, named, taken

FILES = outside_files("characters/*")
PATHS = tuple(param.values[0] for param in FILES)
HIPS_TO_SOLE = {
    "cesium_man": 0.63,
    "jin_hanim_loa4": 0.83,
    "joe_hanim_kick": 0.92,
    "kaykit_barbarian_stocky": 0.52,
    "openhrp_sample1_humanoid": 0.72,
    "vrm0_armature_transform": 1.2,
    "vrm1_debug_robot": 1.17,
}
"""Metres, read off the files' own joints."""


@lru_cache(maxsize=len(FILES))
def read(path: Path) -> ReadCharacter:
    return load_character(path)


@lru_cache(maxsize=2)
def kicking(path: Path) -> AdaptedMotion:
    capture, motion, _ = taken(named("accad_male2_G2_FrontKick"))
    return adapt(AdaptRequest(motion, read(path).character.morphology, contacts_of(capture)))


pytestmark = pytest.mark.captures


def test_there_are_nine():
    assert len(FILES) == 9


@pytest.mark.parametrize("path", FILES)
def test_it_is_read_with_legs_as_long_as_its_file_says(path: Path):
    build = read(path).character.build
    hips = build.leg.sum(axis=1) + build.ankle_height
    assert hips == pytest.approx([HIPS_TO_SOLE[path.stem]] * 2, abs=0.06)


@pytest.mark.parametrize("path", FILES)
def test_its_head_is_above_its_neck_though_the_file_has_none(path: Path):
    build = read(path).character.build
    positions, layout = rest_pose(build)[0], build.layout
    away = positions[layout.head_end] - positions[layout.neck_base]
    assert away[2] > 0.1
    assert np.linalg.norm(away[:2]) < 0.5 * away[2]


@pytest.mark.parametrize("path", FILES)
def test_its_skin_stands_on_the_ground_and_bound_it_is_as_it_was(path: Path):
    character = read(path).character
    assert character.skin.vertices[:, 2].min() == pytest.approx(0.0, abs=0.02)
    for blending in Blending:
        vertices, normals = skin_vertices(
            character.skin,
            character.build,
            character.build,
            *bound_pose(character.skin, character.build),
            blending=blending,
        )
        assert vertices == pytest.approx(character.skin.vertices, abs=1e-5)
        assert normals == pytest.approx(character.skin.normals, abs=1e-4)


@pytest.mark.parametrize("path", FILES)
def test_kicking_no_triangle_is_torn_and_no_foot_sinks_into_the_ground(path: Path):
    character, motion = read(path).character, kicking(path)
    skin = character.skin
    usual = _longest_edge(skin.vertices, skin.triangles)
    legs = skin.segments[:, 0] >= character.build.layout.spine_count + 10  # a stiff cape may
    for row in range(0, motion.frame_count, 10):
        vertices, _ = skin_vertices(
            skin, character.build, character.build, motion.positions[row], motion.rotations[row]
        )
        assert vertices[legs, 2].min() > -0.08
        assert _longest_edge(vertices, skin.triangles) < 2.5 * usual


def test_both_encodings_of_a_body_give_the_same_measures():
    for name in ("joe_hanim_kick", "jin_hanim_loa4"):
        one, other = (read(path).character.build for path in PATHS if path.stem == name)
        assert one.packed == pytest.approx(other.packed, abs=1e-6)


def test_textures_come_along_where_the_file_has_them():
    for name in ("cesium_man", "kaykit_barbarian_stocky"):
        [look] = {read(path).character.skin.appearance for path in PATHS if path.stem == name}
        assert look is not None
        assert any(material.texture is not None for material in look.materials)


def test_a_missing_texture_is_told():
    [path] = (path for path in PATHS if path.name == "jin_hanim_loa4.x3d")
    assert any("Jin.png" in repair for repair in read(path).repairs)


def _longest_edge(vertices: np.ndarray, triangles: np.ndarray) -> float:
    corners = vertices[triangles]
    return float(np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max())


@pytest.mark.parametrize("name", ["kaykit_barbarian_stocky.glb", "joe_hanim_kick.x3d"])
def test_written_with_its_motion_and_read_again_it_is_the_same_body(tmp_path: Path, name: str):
    [path] = (path for path in PATHS if path.name == name)
    character = read(path).character
    write_take(take_of_adapted("kick", kicking(path), character), tmp_path / "again.glb")
    again = load_character(tmp_path / "again.glb").character
    for measure in ("spine", "leg", "arm", "foot", "ankle_height", "hip_offset", "head"):
        assert getattr(again.build, measure) == pytest.approx(getattr(character.build, measure), abs=1e-4)
    assert len(again.skin.vertices) == len(character.skin.vertices)
    one, other = again.skin.appearance, character.skin.appearance
    assert one is not None
    assert other is not None
    for mine, theirs in zip(one.materials, other.materials, strict=True):
        assert mine.colour == theirs.colour
        assert (mine.texture is None) == (theirs.texture is None)
        assert mine.texture is None or np.array_equal(mine.texture, theirs.texture)


@pytest.mark.parametrize("path", FILES)
@pytest.mark.parametrize("stem", ["pybvh_cmu_12_01_walk", "accad_female1_B03_Walk1", "accad_female1_C03_Run"])
def test_it_walks_and_runs_on_the_floor_without_a_jolt(stem: str, path: Path):
    """A foot as long as its leg is lifted over the floor in the middle of its swing, and sharper."""
    capture, motion, actor = taken(named(stem))
    contacts, body = contacts_of(capture), read(path).character.morphology
    adapted = adapt(AdaptRequest(motion, body, contacts), capture.first_frame)
    sole = body.heel_length[0] + body.foot[0, 0] + body.toe[0, 0]
    assert contact_quality(adapted, contacts, Ground()).slide < 1e-3
    assert acceleration_ratio(adapted, source_motion(motion, actor)) < (3.5 if sole > body.leg_length else 3.0)


WALKS = "bvhtoolbox_walk01", "accad_female1_B03_Walk1", "pybvh_cmu_12_01_walk"
WALKERS = "cesium_man", "joe_hanim_kick", "jin_hanim_loa4", "openhrp_sample1_humanoid", "kaykit_barbarian_stocky"


@pytest.mark.parametrize("path", [param for param in FILES if param.values[0].stem in WALKERS])
@pytest.mark.parametrize("stem", WALKS)
def test_it_walks_with_knees_as_straight_as_the_actors_and_arms_beside_its_body(stem: str, path: Path):
    """Bound for all ankles, feet and hips: twice what is asked of the bundled bodies."""
    capture, motion, actor = taken(named(stem))
    contacts, character, own = contacts_of(capture), read(path).character, actor.morphology
    request = AdaptRequest(motion, character.morphology, contacts, actor=own, clears=True, volume=character.volume)
    seen = motion_quality(adapt(request), source_motion(motion, actor), contacts, Ground(), capture.first_frame)
    assert np.degrees(seen.knee_mean) < 4.0
    assert np.degrees(seen.knee_most) < 12.0
    assert seen.drop < 0.01
    assert np.degrees(seen.posture) < 60.0
    assert max(seen.peaks["arms"], seen.peaks["clavicles"], seen.peaks["spine"]) < 2.0


@pytest.mark.parametrize("name", ["kaykit_barbarian_stocky", "vrm1_debug_robot"])
@pytest.mark.parametrize("stem", ["accad_male2_E11_BlockLeftHigh", "accad_male2_E4_CrossRight", "cmu_salsa_10"])
def test_wide_hips_that_turn_over_feet_that_stand_do_not_sit_down(stem: str, name: str):
    capture, motion, actor = taken(named(stem))
    [path] = (path for path in PATHS if path.stem == name)
    contacts, body = contacts_of(capture), read(path).character.morphology
    seen = motion_quality(
        adapt(AdaptRequest(motion, body, contacts, actor=actor.morphology)),
        source_motion(motion, actor), contacts, Ground(), capture.first_frame,
    )  # fmt: skip
    assert np.degrees(seen.knee_mean) < 4.0
    assert np.degrees(seen.knee_most) < 20.0
    assert seen.drop < 0.01
    assert seen.bob < 1.5


@pytest.mark.parametrize("path", [param for param in FILES if param.values[0].stem == "cesium_man"])
def test_legs_of_who_sits_low_on_high_ankles_do_not_fold_to_nothing(path: Path):
    """Half as far as flesh and the actor's own let them: folded further, a hip goes past its ankle, and legs whirl."""
    capture, motion, actor = taken(named("assimp_Boxing_Toes"))
    body = read(path).character.morphology
    adapted = adapt(AdaptRequest(motion, body, contacts_of(capture), actor=actor.morphology))
    source = source_motion(motion, actor)
    for side in range(2):
        stretches = []
        for found in (adapted, source):
            hip = found.morphology.layout.hip_point(side)
            away = np.linalg.norm(found.positions[:, hip + 2] - found.positions[:, hip], axis=1)
            stretches.append(away / found.morphology.leg[side].sum())
        own, actors = stretches
        assert (own > 0.5 * np.minimum(actors, LEAST_LEG_REACH)).all()


@pytest.mark.parametrize("path", FILES)
def test_who_turns_over_in_the_air_leaps_high_enough_for_its_head(path: Path):
    """Legs say how high; a toy's are a sixth of it."""
    capture, motion, actor = taken(named("mass_backflip"))
    body = read(path).character.morphology
    adapted = adapt(AdaptRequest(motion, body, contacts_of(capture), actor=actor.morphology))
    flying = ~contact_mask(
        [(each.first, each.last) for each in ground_contacts(contacts_of(capture))], motion.frame_count
    )
    assert adapted.positions[flying, : body.layout.head_end + 1, 2].min() > -0.02 * body.stature
    assert acceleration_ratio(adapted, source_motion(motion, actor)) < 3.0
