"""Characters: builds with proportions, skeletons for other programs, bodies made from joints."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from studio.core.body import body_shape
from studio.core.body.body_shape import body_by_shape, knees_bend_backwards, moving_body_by_shape
from studio.core.body.canonical import BodyPart
from studio.core.body.kinematics import joint_world, rest_poses
from studio.core.body.morphology import Proportions
from studio.core.body.rest_pose import rest_pose
from studio.core.body.skeleton import Skeleton
from studio.core.body.standing import standing_points
from studio.core.mannequin.tailoring import tailored_character
from studio.core.mesh.character import Character
from studio.core.mesh.skin import Blending, bound_pose, fit_skin, skin_vertices
from studio.core.normalized.normalize import normalize_capture
from studio.core.rigs.character_skeleton import (
    character_body_map,
    character_poses,
    character_skeleton,
    joint_points,
    t_pose_rotations,
)
from studio.core.rigs.embodiment import rolling_on_balls
from studio.core.rotations import IDENTITY_QUATERNION
from studio.core.solver.adapt import adapt
from studio.core.solver.request import AdaptRequest
from studio.io.figure.body_maps import find_body
from studio.io.project.character_file import bundled_characters
from tests.builders import make_capture, make_morphology
from tests.io.character_files import JOINTS, NAMES, PLACES

# A character is a build with proportions put upon it.


def test_a_character_without_sliders_moved_has_the_measures_of_its_build():
    for character in bundled_characters().values():
        assert character.morphology == character.build


def test_a_stature_slider_scales_the_character():
    child = bundled_characters()["child"]
    assert replace(child, proportions=Proportions(stature=1.5)).morphology.stature == pytest.approx(1.8)


def test_the_five_characters_are_told_apart_by_name_and_colour():
    characters = bundled_characters().values()
    assert [c.colour for c in characters] == ["#7FB4E6", "#E8A95B", "#8FCB8A", "#D98BB5", "#B9A6E8"]
    assert len({c.name for c in characters}) == 5


def test_builds_differ_clearly_in_proportion():
    bodies = {name: character.build for name, character in bundled_characters().items()}
    legs = {name: body.leg_length / body.stature for name, body in bodies.items()}
    arms = {name: body.arm[0].sum() / body.stature for name, body in bodies.items()}
    heads = {name: body.head / body.stature for name, body in bodies.items()}
    assert max(arms, key=arms.__getitem__) == "giant"
    assert max(heads, key=heads.__getitem__) == "child"
    assert max(legs, key=legs.__getitem__) == "tall_man"
    assert legs["stocky_man"] < legs["adult_woman"] - 0.03


# A character is an ordinary skeleton to other programs, and nothing is lost on the way.


BODIES = {name: character.morphology for name, character in bundled_characters().items()}
BODIES["five vertebrae"] = make_morphology(spine_count=5)


@pytest.fixture(params=BODIES)
def body(request):
    return BODIES[request.param]


def t_pose(body):
    skeleton = character_skeleton(body)
    poses = rest_poses(skeleton, np.tile(IDENTITY_QUATERNION, (skeleton.joint_count, 1)))
    return dict(zip(skeleton.names, joint_world(skeleton, poses)[0][0], strict=True))


def test_the_zero_pose_has_level_arms_straight_legs_and_flat_soles(body):
    places = t_pose(body)
    for side, name in enumerate(("Left", "Right")):
        shoulder, elbow, wrist = (places[f"{name}{bone}"] for bone in ("Arm", "ForeArm", "Hand"))
        outward = np.array([0.0, 1.0 - 2.0 * side, 0.0])
        assert elbow - shoulder == pytest.approx(body.arm[side, 0] * outward)
        assert wrist - elbow == pytest.approx(body.arm[side, 1] * outward)
        hip, ankle = places[f"{name}UpLeg"], places[f"{name}Foot"]
        assert hip - ankle == pytest.approx([0.0, 0.0, body.leg[side].sum()])
        assert ankle[2] == pytest.approx(body.ankle_height[side])
        assert places[f"{name}ToeBase"] - ankle == pytest.approx(body.foot[side])


def test_it_is_as_tall_as_the_body(body):
    assert t_pose(body)["HeadEnd"][2] == pytest.approx(body.stature)


def test_joints_stand_depth_first_with_the_names_other_programs_know(body):
    skeleton = character_skeleton(body)
    assert skeleton.names[:2] == ("Hips", "Spine")
    assert all(
        skeleton.descendants(joint) == tuple(range(joint + 1, joint + 1 + len(skeleton.descendants(joint))))
        for joint in range(skeleton.joint_count)
    )


def test_our_own_search_finds_the_body_that_was_meant(body):
    skeleton = character_skeleton(body)
    poses = rest_poses(skeleton, np.tile(IDENTITY_QUATERNION, (skeleton.joint_count, 1)))
    found = find_body(skeleton, joint_world(skeleton, poses)[0])
    assert found.body_map == character_body_map(body.layout)
    assert len(found.body_map.parts) == len(BodyPart) - 2


def test_an_adapted_motion_stands_in_its_joints_exactly(body):
    motion, _actor = normalize_capture(make_capture(frames=20))
    adapted = adapt(AdaptRequest(motion, body))
    positions, rotations = joint_world(character_skeleton(body), character_poses(adapted))
    points = list(joint_points(body.layout))
    assert np.abs(positions - adapted.positions[:, points]).max() < 1e-12
    canonical = rotations[:, :3] @ t_pose_rotations(body)[:3]
    assert canonical == pytest.approx(adapted.rotations[:, :3])


@given(leg=st.floats(0.5, 2.0), vertebrae=st.integers(2, 8), turn=st.floats(-3.0, 3.0))
def test_axes_of_the_t_pose_are_rotations_for_any_body(leg, vertebrae, turn):
    body = make_morphology(leg_scale=leg, spine_count=vertebrae)
    axes = t_pose_rotations(body)
    assert np.linalg.det(axes) == pytest.approx(np.ones(len(axes)))
    turned = Rotation.from_euler("z", turn).as_matrix() @ axes
    assert np.swapaxes(turned, 1, 2) @ turned == pytest.approx(np.tile(np.eye(3), (len(axes), 1, 1)))


# From joints to bodies: shapes without names, stances, tailored mannequins, and skins that bend by screws.


@pytest.fixture(scope="module")
def character() -> Character:
    return bundled_characters()["tall_man"]


def figure(turn: float = 0.0) -> tuple[Skeleton, np.ndarray]:
    """The stick figure without names, Z up, facing +X turned by ``turn`` degrees about Z."""
    points = PLACES[:, [2, 0, 1]] @ Rotation.from_euler("z", turn, degrees=True).as_matrix().T
    parents = np.array([NAMES.index(parent) if parent else -1 for _, parent, _ in JOINTS])
    offsets = points - points[np.maximum(parents, 0)]
    return Skeleton(tuple(map(str, range(len(NAMES)))), parents, offsets, np.zeros(len(NAMES), bool)), points


@pytest.mark.parametrize("turn", [0.0, 90.0, 200.0])
def test_a_body_without_names_is_found_whichever_way_it_looks(turn: float):
    found = body_by_shape(*figure(turn))
    assert found is not None
    assert [NAMES[joint] for joint in found.spine] == ["hips", "spine", "chest"]
    for part, name in (
        (BodyPart.LEFT_UPPER_ARM, "leftUpperArm"),
        (BodyPart.LEFT_HAND, "leftHand"),
        (BodyPart.RIGHT_FOREARM, "rightLowerArm"),
        (BodyPart.LEFT_THIGH, "leftUpperLeg"),
        (BodyPart.RIGHT_TOE, "rightToes"),
        (BodyPart.NECK, "neck"),
        (BodyPart.HEAD, "head"),
    ):
        assert NAMES[found[part]] == name


def test_limbs_that_end_before_their_hands_make_no_body():
    skeleton, points = figure()
    ends = np.array([name.endswith("Hand") for name in NAMES])
    nobody = np.zeros(len(NAMES), dtype=np.int64)
    assert moving_body_by_shape(skeleton, points, points[None], nobody) is not None
    assert moving_body_by_shape(replace(skeleton, end_sites=ends), points, points[None], nobody) is None


@pytest.mark.parametrize("joint", [1, 2, 3])
def test_a_joint_that_lies_on_the_one_before_divides_no_bone(joint: int):
    """A spoilt FBX file ended in a division by a length of zero."""
    points = np.arange(4.0)[:, None] * [0.0, 0.0, 0.3]
    points[joint] = points[joint - 1]
    assert not body_shape._divides_the_last_bone(points[None], [0, 1], [0, 1, 2, 3])


def test_sides_are_told_by_hips_where_the_feet_are_crossed():
    skeleton, points = figure()
    for one, other in (("leftFoot", "rightFoot"), ("leftToes", "rightToes")):
        points[[NAMES.index(one), NAMES.index(other)]] = points[[NAMES.index(other), NAMES.index(one)]]
    found = body_by_shape(skeleton, points)
    assert found is not None
    assert NAMES[found[BodyPart.LEFT_THIGH]] == "leftUpperLeg"
    assert NAMES[found[BodyPart.LEFT_HAND]] == "leftHand"


def test_sides_are_those_that_names_say_whichever_way_the_toes_point():
    skeleton, points = figure()
    points[[NAMES.index("leftToes"), NAMES.index("rightToes")], 0] *= -1.0
    sides = np.array([name.startswith("left") - name.startswith("right") for name in NAMES])
    found = body_by_shape(skeleton, points, sides)
    assert found is not None
    assert NAMES[found[BodyPart.LEFT_THIGH]] == "leftUpperLeg"
    assert NAMES[found[BodyPart.LEFT_HAND]] == "leftHand"


def test_knees_that_bend_backwards_tell_that_sides_are_exchanged():
    skeleton, points = figure()
    found = body_by_shape(skeleton, points)
    assert found is not None
    sitting = np.array(points)
    for side in ("left", "right"):
        for name, place in (("LowerLeg", (0.4, 0.0, 0.4)), ("Foot", (0.3, 0.0, 0.8))):
            sitting[NAMES.index(f"{side}{name}")] += place
    assert not knees_bend_backwards(found, sitting[None])
    assert knees_bend_backwards(found.with_sides_exchanged(), sitting[None])


def grown(*joints: tuple[str, str, tuple[float, float, float]]) -> tuple[Skeleton, np.ndarray, list[str]]:
    """The stick figure with more ``joints`` (name, parent, offset with Y up, facing Z), and all their names."""
    skeleton, points = figure()
    names = [*NAMES]
    for name, parent, (left, up, ahead) in joints:
        above = names.index(parent)
        names.append(name)
        points = np.vstack([points, points[above] + [ahead, left, up]])
        parents = np.append(skeleton.parents, above)
        skeleton = Skeleton(
            tuple(map(str, range(len(names)))),
            parents,
            points - points[np.maximum(parents, 0)],
            np.zeros(len(names), bool),
        )
    return skeleton, points, names


def test_fingers_that_differ_by_a_centimetre_leave_arms_a_pair():
    ends = [(f"{side}Tip", f"{side}Hand", (out, 0.0, 0.0)) for side, out in (("left", 0.03), ("right", -0.04))]
    skeleton, points, names = grown(*ends)
    found = body_by_shape(skeleton, points)
    assert found is not None
    assert names[found[BodyPart.LEFT_HAND]] == "leftHand"


def test_a_clavicle_as_long_as_a_forearm_is_no_upper_arm():
    skeleton, points, names = grown(
        ("leftTip", "leftHand", (0.1, 0.0, 0.0)), ("rightTip", "rightHand", (-0.1, 0.0, 0.0))
    )
    for side, out in (("left", 1.0), ("right", -1.0)):
        for name, place in (("UpperArm", 0.02), ("LowerArm", 0.22), ("Hand", 0.52), ("Tip", 0.715)):
            points[names.index(f"{side}{name}"), 1] = out * place
    found = body_by_shape(skeleton, points)
    assert found is not None
    assert names[found[BodyPart.LEFT_CLAVICLE]] == "leftUpperArm"
    assert names[found[BodyPart.LEFT_UPPER_ARM]] == "leftLowerArm"
    assert names[found[BodyPart.LEFT_HAND]] == "leftTip"


def test_a_hand_that_holds_a_bat_is_no_forearm():
    skeleton, points, names = grown(
        ("leftBat", "leftHand", (0.28, 0.0, 0.0)), ("rightBat", "rightHand", (-0.28, 0.0, 0.0))
    )
    found = body_by_shape(skeleton, points)
    assert found is not None
    assert names[found[BodyPart.LEFT_HAND]] == "leftHand"


def test_a_joint_of_the_heel_is_no_toe():
    heels = [(f"{side}Heel", f"{side}Foot", (0.0, -0.08, -0.06)) for side in ("left", "right")]
    skeleton, points, names = grown(*heels)
    found = body_by_shape(skeleton, points)
    assert found is not None
    assert [names[found[part]] for part in (BodyPart.LEFT_TOE, BodyPart.RIGHT_TOE)] == ["leftToes", "rightToes"]


def test_the_head_over_a_neck_of_two_joints_is_the_one_that_turns():
    """The joint at its tip turns with it; that of a stiff head is the one above the first of the neck."""
    skeleton, points, names = grown(("skull", "head", (0.0, 0.06, 0.0)), ("crown", "skull", (0.0, 0.15, 0.0)))
    tip = grown(
        ("skull", "head", (0.0, 0.06, 0.0)), ("crown", "skull", (0.0, 0.15, 0.0)), ("tip", "crown", (0, 0.02, 0))
    )
    nodding = np.array([points, points])
    nodding[1, names.index("crown")] += [0.1, 0.0, -0.03]
    sides = np.zeros(len(names), dtype=np.int64)
    found = moving_body_by_shape(skeleton, points, nodding, sides)
    assert found is not None
    assert names[found[BodyPart.HEAD]] == "skull"
    still = moving_body_by_shape(tip[0], tip[1], tip[1][None], np.zeros(len(tip[2]), dtype=np.int64))
    assert still is not None
    assert names[still[BodyPart.HEAD]] == "head"


def test_an_animal_on_four_legs_is_no_body():
    skeleton, points = figure()
    down = Rotation.from_euler("y", 80, degrees=True).as_matrix()
    trunk = [
        index for index, name in enumerate(NAMES) if "Leg" not in name and "Foot" not in name and "Toe" not in name
    ]
    points[trunk] = (points[trunk] - points[0]) @ down.T + points[0]
    assert body_by_shape(skeleton, points) is None


def test_a_body_without_arms_is_none():
    skeleton, points = figure()
    kept = [place for place, name in enumerate(NAMES) if "Arm" not in name and "Hand" not in name]
    parents = np.array([-1, *(kept.index(int(skeleton.parents[place])) for place in kept[1:])])
    armless = Skeleton(tuple(map(str, kept)), parents, skeleton.offsets[kept], np.zeros(len(kept), bool))
    assert body_by_shape(armless, points[kept]) is None


def test_the_points_of_a_stance_keep_every_bone_and_stand_on_the_ground(character: Character):
    body = character.build
    layout, stance = body.layout, t_pose_rotations(body)
    points = standing_points(body, stance)
    bones = np.linalg.norm(points[list(layout.distal_points())] - points[list(layout.proximal_points())], axis=1)
    rest, _ = rest_pose(body)
    usual = np.linalg.norm(rest[list(layout.distal_points())] - rest[list(layout.proximal_points())], axis=1)
    assert bones == pytest.approx(usual, abs=1e-9)
    assert min(points[layout.ankle_point(side), 2] - body.ankle_height[side] for side in (0, 1)) == pytest.approx(0.0)


def in_t_pose(character: Character) -> Character:
    """The same character, bound in a T-pose by plain linear blending."""
    body = character.build
    stance = t_pose_rotations(body)
    vertices, normals = skin_vertices(character.skin, body, body, standing_points(body, stance), stance)
    skin = replace(character.skin, vertices=vertices, normals=normals, centres=vertices, stance=stance)
    return replace(character, skin=skin)


@pytest.mark.parametrize("blending", Blending)
def test_bound_in_any_stance_a_skin_comes_back_to_it(character: Character, blending: Blending):
    bound = in_t_pose(character)
    pose = bound_pose(bound.skin, bound.build)
    vertices, normals = skin_vertices(bound.skin, bound.build, bound.build, *pose, blending=blending)
    assert vertices == pytest.approx(bound.skin.vertices, abs=1e-5)
    assert normals == pytest.approx(bound.skin.normals, abs=1e-4)


def test_a_skin_bound_in_a_t_pose_grows_with_its_body(character: Character):
    bound = in_t_pose(character)
    fitted = fit_skin(bound.skin, bound.build, Proportions(stature=1.3).applied_to(bound.build))
    assert fitted.vertices == pytest.approx(1.3 * bound.skin.vertices, abs=1e-5)


def test_the_dual_quaternion_kernel_equals_its_numpy_twin(character: Character):
    random = np.random.default_rng(5)
    skin, body = character.skin, character.build
    for _ in range(3):
        positions = random.normal(size=(body.layout.point_count, 3))
        rotations = Rotation.random(body.layout.segment_count, rng=random).as_matrix()
        found = skin_vertices(skin, body, body, positions, rotations, blending=Blending.DUAL_QUATERNIONS)
        expected = screws(character, positions, rotations)
        assert found[0] == pytest.approx(expected[0], abs=2e-4)
        assert found[1] == pytest.approx(expected[1], abs=2e-4)


def screws(character: Character, positions: np.ndarray, rotations: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Blended unit dual quaternions, in NumPy."""
    skin, body = character.skin, character.build
    rest_positions, rest_rotations = rest_pose(body)
    origins = list(body.layout.proximal_points())
    turns = Rotation.from_matrix(rotations @ rest_rotations.transpose(0, 2, 1))
    shifts = positions[origins] - turns.apply(rest_positions[origins])
    real = turns.as_quat()
    dual = 0.5 * product(np.pad(shifts, ((0, 0), (0, 1))), real)
    one, other = real[skin.segments], dual[skin.segments]
    signs = np.where(np.einsum("vwi,vi->vw", one, one[:, 0]) < 0, -1, 1) * skin.weights
    one, other = np.einsum("vw,vwi->vi", signs, one), np.einsum("vw,vwi->vi", signs, other)
    length = np.linalg.norm(one, axis=1, keepdims=True)
    one, other = one / length, other / length
    moves = 2 * product(other, one * [-1, -1, -1, 1])[:, :3]
    turned = Rotation.from_quat(one)
    return turned.apply(skin.vertices) + moves, turned.apply(skin.normals)


def product(p: np.ndarray, q: np.ndarray) -> np.ndarray:
    vector = p[:, 3:] * q[:, :3] + q[:, 3:] * p[:, :3] + np.cross(p[:, :3], q[:, :3])
    scalar = p[:, 3] * q[:, 3] - np.einsum("ij,ij->i", p[:, :3], q[:, :3])
    return np.column_stack([vector, scalar])


def test_by_dual_quaternions_a_twisted_forearm_keeps_its_girth_where_linear_blending_wraps_it_up(character: Character):
    bound = in_t_pose(character)
    skin, body = bound.skin, bound.build
    positions, rotations = (part.copy() for part in bound_pose(skin, body))
    hand = body.layout.segment_of_part(BodyPart.LEFT_HAND)
    rotations[hand] = rotations[hand] @ Rotation.from_rotvec([0, 0, np.radians(170)]).as_matrix()
    shared = (np.abs(skin.weights[:, 0] - 0.5) < 0.1) & (skin.segments[:, :2] == hand).any(axis=1)
    assert shared.sum() > 10

    def girth(blending: Blending) -> float:
        vertices, _ = skin_vertices(skin, body, body, positions, rotations, blending=blending)
        axis, wrist = rotations[hand][:, 2], positions[body.layout.wrist_point(0)]
        across = vertices[shared] - wrist - np.outer((vertices[shared] - wrist) @ axis, axis)
        return float(np.linalg.norm(across, axis=1).mean())

    def at_rest() -> float:
        axis, wrist = bound_pose(skin, body)[1][hand][:, 2], positions[body.layout.wrist_point(0)]
        across = skin.vertices[shared] - wrist - np.outer((skin.vertices[shared] - wrist) @ axis, axis)
        return float(np.linalg.norm(across, axis=1).mean())

    assert girth(Blending.DUAL_QUATERNIONS) > 0.9 * at_rest()
    assert girth(Blending.LINEAR) < 0.6 * at_rest()


@pytest.mark.parametrize("count", [2, 3, 4, 7, 19])
def test_a_tailored_mannequin_has_the_measures_asked_for_and_a_whole_trunk(character: Character, count: int):
    spine = np.tile(character.build.spine.sum(axis=0) / count, (count, 1))
    body = Proportions(stature=0.9, thighs=1.1, upper_arms=0.95).applied_to(replace(character.build, spine=spine))
    made = tailored_character("Actor", "#112233", body, bundled_characters().values())
    assert made.morphology == body
    heights = made.skin.vertices[:, 2]
    assert heights.max() - heights.min() == pytest.approx(body.stature, rel=0.03)
    trunk = made.skin.segments[:, 0] < count
    middles = [heights[made.skin.segments[:, 0] == segment] for segment in np.unique(made.skin.segments[trunk, 0])]
    assert len(middles) >= min(count, 3)
    assert (np.diff([middle.mean() for middle in middles]) > 0.0).all()


@pytest.mark.parametrize("ankle", [0.05, 0.08, 0.125])
def test_the_soles_of_a_tailored_mannequin_are_on_the_ground_however_high_its_ankles_are(ankle: float):
    """Captured ankles are often markers' heights."""
    pattern = bundled_characters()["tall_man"].build
    foot = pattern.foot.copy()
    foot[:, 2] = -0.6 * ankle
    body = replace(pattern, foot=foot, ankle_height=np.full(2, ankle), toe_height=np.full(2, 0.4 * ankle))
    made = tailored_character("Actor", "#112233", body, bundled_characters().values())
    feet = made.skin.segments[:, 0] >= body.layout.spine_count + 12
    assert made.skin.vertices[feet, 2].min() == pytest.approx(0.0, abs=0.006)


def test_a_foot_bends_at_its_ball_though_its_toe_joint_lies_under_the_ankle(character: Character) -> None:
    body, (vertices, stance) = character.build, (character.skin.vertices.astype(float), rest_pose(character.build)[1])
    shares = np.zeros((len(vertices), body.layout.segment_count))
    np.put_along_axis(shares, character.skin.segments, character.skin.weights, axis=1)
    near, tip = replace(body, foot=body.foot * [0.1, 1.0, 1.0]), body.foot[:, 0] + body.toe[:, 0]
    near = replace(near, toe=body.toe + [[1.0, 0.0, 0.0]] * 2 * (0.9 * body.foot[:, :1]))
    points = rest_pose(near)[0]
    mended, moved = rolling_on_balls(near, stance, points, vertices, shares)
    assert mended.foot[:, 0] == pytest.approx(body.foot[:, 0], rel=0.1)
    assert mended.foot[:, 0] + mended.toe[:, 0] == pytest.approx(tip)
    for side in range(2):
        foot, ankle = body.layout.segment_of_part(BodyPart.LEFT_FOOT) + 4 * side, points[body.layout.ankle_point(side)]
        ahead, both = vertices[:, 0] - ankle[0], moved[:, foot : foot + 2]
        assert both.sum(axis=1) == pytest.approx(shares[:, foot : foot + 2].sum(axis=1))
        assert not both[ahead < 0.7 * mended.foot[side, 0], 1].any()
        assert not both[ahead > 1.4 * mended.foot[side, 0], 0].any()
    kept, same = rolling_on_balls(body, stance, points, vertices, shares)
    assert kept == body
    assert np.array_equal(same, shares)
