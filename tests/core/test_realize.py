"""Normalising and realising: the capture comes back, on a body and by laws."""

import tracemalloc
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from studio.core.body.canonical import BodyLayout, BodyPart
from studio.core.body.humanoid import BodyMap
from studio.core.body.kinematics import joint_world
from studio.core.body.morphology import Morphology, Proportions
from studio.core.body.pose import PoseSequence
from studio.core.body.skeleton import Skeleton
from studio.core.captures.capture import Capture
from studio.core.errors import StudioError
from studio.core.kernels import channel_columns as channel
from studio.core.kernels.body.pose_from_channels import spine_sampling
from studio.core.kernels.limbs.limb import BONE_LINE_TOLERANCE
from studio.core.normalized.alignment import find_alignments
from studio.core.normalized.landmarks import find_landmarks
from studio.core.normalized.motion import NormalizedMotion
from studio.core.normalized.normalize import capture_contacts, normalize_capture, smoothed_heading
from studio.core.normalized.realize import girdle_of, realize_motion, restore_joint_poses
from studio.core.rotations import angle_between, from_matrix, inverse, normalized, to_matrix
from tests.builders import BODY_MAP, make_capture, make_morphology
from tests.core.motions import about, placed, random_rotations, scaled, swaying, times, walk
from tests.core.twins import body as body_twin
from tests.core.twins import realize as twin
from tests.core.twins.normalize import channels_of
from tests.core.twins.rotation import about_z

# Realising: channels on a body, against a twin and by laws.


seeds = st.integers(0, 2**32 - 1)
WALK = walk(30)[0]


def random_motion(seed: int, spine_count: int = 3, frames: int = 4) -> NormalizedMotion:
    """Any channels that mean something: unit quaternions, slack between 0 and 1."""
    random = np.random.default_rng(seed)
    channels = 0.3 * random.normal(size=(frames, channel.SPINE + 4 * (spine_count - 1)))
    for first, count in (
        (channel.PELVIS, 1), (channel.NECK, 1), (channel.HEAD, 1), (channel.CLAVICLE, 2), (channel.LIMB_FRAME, 4),
        (channel.HAND, 2), (channel.FOOT, 2), (channel.TOE, 2), (channel.SPINE, spine_count - 1),
    ):  # fmt: skip
        block = random.normal(size=(frames, count, 4))
        block /= np.linalg.norm(block, axis=-1, keepdims=True)
        channels[:, first : first + 4 * count] = block.reshape(frames, -1)
    channels[:, channel.LIMB_SLACK : channel.LIMB_SLACK + 4] = random.uniform(0.001, 0.8, size=(frames, 4))
    channels[:, channel.LIMB_BEND : channel.LIMB_BEND + 4] = random.choice([-1.0, 1.0], size=(frames, 4))
    places = np.concatenate([[0.0], np.sort(random.uniform(0.1, 0.9, size=spine_count - 2)), [1.0]])
    return NormalizedMotion("random", 60.0, channels, places)


@pytest.mark.parametrize("play", [False, True])
@given(seed=seeds, spine_count=st.integers(2, 6), own=st.integers(2, 7))
@settings(max_examples=15)
def test_the_kernel_agrees_with_its_twin(play: bool, seed: int, spine_count: int, own: int) -> None:
    motion, body = random_motion(seed, spine_count), make_morphology(spine_count=own)
    for result, expected in zip(realize_motion(motion, body, play=play), twin.realize(motion, body, play), strict=True):
        assert np.allclose(result, expected, atol=1e-8)


@given(seed=seeds, spine_count=st.integers(2, 6))
@settings(max_examples=15)
def test_bones_have_the_lengths_of_the_body(seed: int, spine_count: int) -> None:
    body = make_morphology(leg_scale=1.2, spine_count=spine_count)
    positions, rotations = realize_motion(random_motion(seed), body)
    lengths = body_twin.bone_lengths(body.layout, positions)
    hand, foot, toe = (np.linalg.norm(getattr(body, name), axis=1) for name in ("hand", "foot", "toe"))
    expected = [
        *np.linalg.norm(body.spine, axis=1), body.neck, body.head,
        *(x for s in (0, 1) for x in (body.clavicle[s], *body.arm[s], hand[s])),
        *(x for s in (0, 1) for x in (*body.leg[s], foot[s], toe[s])),
        *np.linalg.norm(body.collar_base, axis=1), *np.linalg.norm(body.hip_offset, axis=1),
    ]  # fmt: skip
    assert np.allclose(lengths, expected, atol=1e-9)
    assert np.allclose(np.swapaxes(rotations, -1, -2) @ rotations, np.eye(3), atol=1e-9)


@given(st.floats(0.3, 4.0))
@settings(max_examples=15)
def test_a_body_scaled_as_a_whole_moves_scaled_as_a_whole(factor: float) -> None:
    body = make_morphology()
    positions, rotations = realize_motion(WALK, body)
    larger, same = realize_motion(WALK, Proportions(stature=factor).applied_to(body))
    assert np.allclose(larger, factor * positions, atol=1e-12)
    assert np.allclose(same, rotations, atol=1e-12)


@given(seeds, st.integers(2, 12))
@settings(max_examples=15)
def test_however_many_vertebrae_wrists_keep_their_place_under_the_neck(seed: int, spine_count: int) -> None:
    motion = random_motion(seed)
    arms = {}
    for count in (3, spine_count):
        body = make_morphology(spine_count=count)
        positions, rotations = realize_motion(motion, body)
        neck, wrists = body.layout.neck_base, [body.layout.wrist_point(side) for side in (0, 1)]
        arms[count] = positions[:, wrists] - positions[:, [neck]], rotations[:, body.layout.segment_count - 16 :]
    for few, many in zip(arms[3], arms[spine_count], strict=True):
        assert np.allclose(few, many, atol=1e-12)


def test_the_pelvis_takes_the_pelvis_and_the_thorax_the_thorax() -> None:
    for spine_count in (2, 3, 5, 9):
        start, share = spine_sampling(np.array([0.0, 0.3, 0.8, 1.0]), make_morphology(spine_count=spine_count).packed)
        assert (start[0], share[0]) == (0, 0.0)
        assert (start[-1], share[-1]) == (3, 0.0)
        assert (np.diff(start + share) > 0.0).all()


def test_its_own_vertebrae_are_taken_as_they_are() -> None:
    spine = np.array([[0.0, 0.0, 0.1], [0.02, 0.0, 0.2], [0.0, 0.0, 0.15], [0.0, 0.0, 0.3]])
    places = np.cumsum([0.0, *np.linalg.norm(spine[:-1], axis=1)])
    start, share = spine_sampling(places / places[-1], replace(make_morphology(), spine=spine).packed)
    assert start.tolist() == [0, 1, 2, 3]
    assert not share.any()


def test_hips_and_head_stray_only_where_the_actor_is_played() -> None:
    still = WALK.channels.copy()
    still[:, channel.HIP_SHIFT : channel.HEAD_SHIFT + 3] = 0.0
    strayed = still + 0.0
    strayed[:, channel.HIP_SHIFT : channel.HEAD_SHIFT + 3] = 0.1
    body = make_morphology()
    rigid = realize_motion(replace(WALK, channels=still), body, play=True)[0]
    assert np.array_equal(realize_motion(replace(WALK, channels=strayed), body)[0], rigid)
    played = realize_motion(replace(WALK, channels=strayed), body, play=True)[0]
    moved = np.linalg.norm(played - rigid, axis=-1)[0]
    assert moved[body.layout.hip_point(0)] == pytest.approx(0.1 * body.leg_length * np.sqrt(3))
    assert moved[body.layout.head_joint] == pytest.approx(0.1 * body.neck * np.sqrt(3))
    assert moved[body.layout.neck_base] == 0.0


@given(st.floats(1.2, 5.0))
@settings(max_examples=10)
def test_wide_hips_go_over_the_feet_as_far_as_the_actors(wider: float) -> None:
    """Ahead of each other, and up: who turns on feet that stand keeps its legs, and its trunk turns as it is meant."""
    body = make_morphology()
    wide = replace(body, hip_offset=body.hip_offset * [1.0, wider, 1.0])
    turns = np.linspace(-1.0, 1.0, WALK.frame_count)[:, None] * [0.1, 0.0, 0.5, 0.0]
    channels, pelvis = WALK.channels.copy(), normalized(turns + np.array([0.0, 0.0, 0.0, 1.0]))
    channels[:, channel.YAW], channels[:, channel.PELVIS : channel.PELVIS + 4] = 0.0, pelvis
    channels[:, channel.FOOT : channel.FOOT + 8] = np.tile(inverse(pelvis), 2)
    motion = replace(WALK, channels=channels, girdle=girdle_of(body))
    poses = [realize_motion(motion, each) for each in (body, wide)]
    left, right = (body.layout.hip_point(side) for side in (0, 1))
    ways = [positions[:, left] - positions[:, right] for positions, _ in poses]
    assert np.ptp(ways[0][:, [0, 2]], axis=0).min() > 0.03
    assert np.allclose(ways[0][:, [0, 2]], ways[1][:, [0, 2]], atol=1e-9)
    for part in (1, body.layout.segment_of_part(BodyPart.LEFT_THIGH), body.layout.segment_of_part(BodyPart.RIGHT_FOOT)):
        assert np.allclose(poses[0][1][:, part], poses[1][1][:, part], atol=1e-12)
    again = realize_motion(replace(motion, girdle=girdle_of(wide)), wide)
    assert np.allclose(again[1], poses[0][1], atol=1e-12)


def test_hips_whose_feet_lie_on_their_sides_turn_as_they_are_meant() -> None:
    body = make_morphology()
    wide = replace(body, hip_offset=body.hip_offset * [1.0, 3.0, 1.0])
    channels, aside = WALK.channels.copy(), [np.sin(np.pi / 4.0), 0.0, 0.0, np.cos(np.pi / 4.0)]
    channels[:, channel.PELVIS : channel.PELVIS + 4] = aside
    channels[:, channel.FOOT : channel.FOOT + 8] = [0.0, 0.0, 0.0, 1.0] * 2
    motion = replace(WALK, channels=channels, girdle=girdle_of(body))
    assert np.allclose(realize_motion(motion, wide)[1], realize_motion(motion, body)[1], atol=1e-12)


@given(st.floats(0.35, 0.65), st.floats(0.15, 0.98))
def test_bones_that_share_their_limb_otherwise_lie_nearly_as_the_actors_however_it_is_folded(part: float, reach: float):
    """A knee that is drawn up is drawn up on a long thigh too; the limb's line gives way, not the posture."""
    body = make_morphology()
    body = replace(body, leg=np.full((2, 2), body.leg.mean()))
    other = replace(body, leg=2.0 * body.leg.mean() * np.array([[part, 1.0 - part]] * 2))
    channels = WALK.channels.copy()
    channels[:, channel.LIMB_SLACK + 2 : channel.LIMB_SLACK + 4] = 1.0 - reach
    motion = replace(WALK, channels=channels, girdle=girdle_of(body))
    (_, own), (_, others) = (realize_motion(motion, each) for each in (body, other))
    for bone in (BodyPart.LEFT_THIGH, BodyPart.LEFT_SHANK):
        ways = (rotations[:, body.layout.segment_of_part(bone), :, 2] for rotations in (own, others))
        assert (np.sum(np.prod(np.stack(list(ways)), axis=0), axis=1) > np.cos(3.2 * BONE_LINE_TOLERANCE)).all()
    again = realize_motion(replace(motion, girdle=girdle_of(other)), other)[0]
    hip, ankle = body.layout.hip_point(0), body.layout.ankle_point(0)
    ways = [positions[:, ankle] - positions[:, hip] for positions in (again, realize_motion(motion, body)[0])]
    assert np.allclose(*(way / np.linalg.norm(way, axis=1, keepdims=True) for way in ways), atol=1e-9)


def test_a_motion_cannot_be_changed_afterwards() -> None:
    with pytest.raises(ValueError, match="read-only"):
        WALK.channels[0, 0] = 1.0


# Normalising: the capture comes back, and nothing of the actor's measures or place stays in the motion.


POSITION, ANGLE = 1e-4, np.deg2rad(0.01)


def _assert_comes_back(capture: Capture) -> None:
    motion, actor = normalize_capture(capture)
    again = restore_joint_poses(motion, actor)
    before, after = joint_world(capture.skeleton, capture.poses), joint_world(capture.skeleton, again)
    assert np.linalg.norm(after[0] - before[0], axis=-1).max() < POSITION
    assert angle_between(from_matrix(before[1]), from_matrix(after[1])).max() < ANGLE


@given(seeds, st.floats(0.1, 1.5))
def test_a_capture_comes_back_from_its_normalised_motion(seed: int, amplitude: float) -> None:
    _assert_comes_back(swaying(seed, amplitude=amplitude))


def test_a_long_capture_comes_back_though_its_bones_are_measured_in_some_frames_only() -> None:
    _assert_comes_back(swaying(3, frames=12_000, amplitude=1.0))


@given(seeds, st.floats(0.1, 3.0))
@settings(max_examples=10)
def test_channels_are_those_of_whole_arrays(seed: int, amplitude: float) -> None:
    capture = swaying(seed, amplitude=amplitude)
    motion, actor = normalize_capture(capture)
    assert capture.body_map is not None
    marks = find_landmarks(capture, capture.body_map)
    rotations = marks.align_rotations(actor.alignments)
    expected = channels_of(actor.morphology, marks.points - actor.origin, rotations, capture.frame_rate)
    assert motion.channels == pytest.approx(expected, abs=1e-12)


@given(seeds)
@settings(max_examples=10)
def test_segments_turn_with_the_joints_that_move_them(seed: int) -> None:
    capture = swaying(seed)
    names = {part: joint for part, joint in BODY_MAP.items() if "clavicle" not in part}
    marks = find_landmarks(capture, BodyMap.from_json(capture.skeleton, names))
    alignments = find_alignments(marks)
    by_segment = [marks.rotations[:, segment] @ each for segment, each in enumerate(alignments)]
    assert marks.align_rotations(alignments) == pytest.approx(np.stack(by_segment, axis=1), abs=1e-14)


@given(seeds)
@settings(max_examples=10)
def test_a_body_without_clavicles_neck_or_toes_comes_back(seed: int) -> None:
    capture = swaying(seed)
    absent = ("neck", "head", "left_clavicle", "right_clavicle", "left_toe", "right_toe")
    names = {part: joint for part, joint in BODY_MAP.items() if part not in absent}
    _assert_comes_back(replace(capture, body_map=BodyMap.from_json(capture.skeleton, names)))


@given(seeds)
@settings(max_examples=10)
def test_joint_axes_that_lie_anyhow_come_back(seed: int) -> None:
    """Every joint's axes turned by a constant of its own: another skeleton, the same movement."""
    capture = swaying(seed)
    _assert_comes_back(_with_other_axes(capture, random_rotations(np.random.default_rng(seed), 26)))


def _with_other_axes(capture: Capture, axes: np.ndarray) -> Capture:
    skeleton, carriers = capture.skeleton, axes[np.maximum(capture.skeleton.parents, 0)]
    carriers[0] = np.eye(3)
    rotations = np.swapaxes(carriers, 1, 2) @ to_matrix(capture.poses.local_rotations) @ axes
    offsets = np.einsum("jba,jb->ja", carriers, skeleton.offsets)
    translations = np.einsum("jba,fjb->fja", carriers, capture.poses.local_translations)
    reference = np.swapaxes(carriers, 1, 2) @ to_matrix(capture.reference_rotations) @ axes
    return replace(
        capture,
        skeleton=Skeleton(skeleton.names, skeleton.parents, offsets, skeleton.end_sites),
        poses=PoseSequence(from_matrix(rotations), translations),
        reference_rotations=from_matrix(reference),
    )


@given(seeds)
@settings(max_examples=10)
def test_how_joint_axes_lie_does_not_change_the_motion(seed: int) -> None:
    capture = swaying(seed, hinged=True)
    other = _with_other_axes(capture, random_rotations(np.random.default_rng(seed), 26))
    assert _same_channels(normalize_capture(capture)[0].channels, normalize_capture(other)[0].channels)


def _same_channels(first: np.ndarray, second: np.ndarray, tolerance: float = 1e-7) -> bool:
    """Alike but for the sign of a quaternion and for whole turns of an angle."""
    turns = [channel.YAW, *range(channel.LIMB_TWIST, channel.LIMB_TWIST + 8)]
    apart = np.abs(first - second)
    apart[:, turns] = np.abs(np.angle(np.exp(1j * (first[:, turns] - second[:, turns]))))
    for start in (*channel.QUATERNION_COLUMNS, *range(channel.SPINE, first.shape[1], 4)):
        block = slice(start, start + 4)
        apart[:, block] = np.minimum(apart[:, block], np.abs(first[:, block] + second[:, block]))
    return bool(apart.max() < tolerance)


@given(seeds, st.floats(0.3, 5.0), st.floats(0.0, 1.0))
@settings(max_examples=15)
def test_an_actor_of_any_size_gives_the_same_motion(seed: int, factor: float, lift: float) -> None:
    capture = swaying(seed, lift=lift)
    larger = scaled(capture, factor)
    # Contacts are told in metres: a foot that a dwarf moves slowly, a giant moves fast.
    assume(not any(capture_contacts(capture).values()) and not any(capture_contacts(larger).values()))
    motion, actor = normalize_capture(capture)
    again, giant = normalize_capture(larger)
    assert _same_channels(motion.channels, again.channels, 1e-6)
    assert np.allclose(giant.morphology.packed, times(factor, actor.morphology), rtol=1e-9)
    assert np.allclose(again.spine_places, motion.spine_places)


@given(seeds, st.floats(-3.0, 3.0), st.floats(-50, 50), st.floats(-50, 50))
@settings(max_examples=15)
def test_where_the_actor_stands_and_looks_changes_the_root_alone(seed: int, yaw: float, x: float, y: float) -> None:
    capture = swaying(seed)
    motion, actor = normalize_capture(capture)
    moved, other = normalize_capture(placed(capture, yaw, (x, y)))
    expected = motion.channels.copy()
    expected[:, channel.YAW] += yaw
    expected[:, channel.HIPS : channel.HIPS + 3] = motion.channels[:, channel.HIPS : channel.HIPS + 3] @ about_z(yaw).T
    assert _same_channels(moved.channels, expected, 1e-6)
    assert np.allclose(other.morphology.packed, actor.morphology.packed, atol=1e-9)


@given(seeds)
@settings(max_examples=10)
def test_a_motion_realised_on_another_body_is_still_the_same_motion(seed: int) -> None:
    """But for where over the ground it begins, and clavicles with the arms in them: these rest as they lie on average.

    With hinged limbs, for an actor's hinges are read off its movement.
    """
    motion, first = normalize_capture(swaying(seed, hinged=True))
    body = replace(
        make_morphology(leg_scale=1.2),
        spine=1.3 * first.morphology.spine,
        arm=[[0.35, 0.22], [0.35, 0.22]],
        clavicle=[0.1, 0.1],
        ankle_height=np.full(2, 0.09 * make_morphology(leg_scale=1.2).leg_length),
        clavicle_rest=[[0.0, 1.0, 0.0], [0.0, -1.0, 0.0]],
    )
    recorded = _captured(motion, body)
    assume(
        not any(capture_contacts(recorded).values()) and not any(capture_contacts(swaying(seed, hinged=True)).values())
    )
    again, actor = normalize_capture(recorded)
    begins_at_the_origin = [
        channels - np.eye(1, channels.shape[1], channel.HIPS) * channels[0, 0]
        - np.eye(1, channels.shape[1], channel.HIPS + 1) * channels[0, 1]
        for channels in (again.channels, motion.channels)
    ]  # fmt: skip
    for channels in begins_at_the_origin:
        channels[:, channel.CLAVICLE : channel.LIMB_FRAME + 8] = 0.0
    assert _same_channels(*begins_at_the_origin, 1e-6)
    assert np.allclose(actor.morphology.leg, body.leg)
    assert np.allclose(actor.morphology.arm, body.arm)


def _captured(motion: NormalizedMotion, body: Morphology) -> Capture:
    """A recording of ``motion`` on ``body``: a skeleton with the canonical segments as its joints."""
    layout = body.layout
    positions, rotations = realize_motion(motion, body)
    parents, origins = np.array(layout.parent_segments()), list(layout.proximal_points())
    names = [layout.part_of_segment(segment).value for segment in range(layout.segment_count)]
    ends = {s: layout.distal_points()[s] for s in range(layout.segment_count) if s not in parents}
    points = [*origins, *ends.values()]
    parents = np.append(parents, list(ends))
    local = np.tile(np.eye(3), (motion.frame_count, len(points), 1, 1))
    translations = positions[:, points]
    for joint in range(1, len(points)):
        carrier = rotations[:, parents[joint]]
        apart = positions[:, points[joint]] - positions[:, origins[parents[joint]]]
        translations[:, joint] = np.einsum("fji,fj->fi", carrier, apart)
        if joint < layout.segment_count:
            local[:, joint] = np.swapaxes(carrier, 1, 2) @ rotations[:, joint]
    local[:, 0] = rotations[:, 0]
    joint_names = (*names, *(f"{names[segment]} end" for segment in ends))
    skeleton = Skeleton(joint_names, parents, translations[0], np.arange(len(points)) >= layout.segment_count)
    parts = {name: name for name in names if name not in ("abdomen", "thorax")}
    spine = {f"spine_{k}": names[k] for k in range(1, layout.spine_count)}
    return replace(
        make_capture("again"),
        skeleton=skeleton,
        poses=PoseSequence(from_matrix(local), translations),
        body_map=BodyMap.from_json(skeleton, parts | spine),
        reference_rotations=_standing_straight(layout.segment_count, len(points), parents, names),
    )


def _standing_straight(segments: int, joints: int, parents: np.ndarray, names: list[str]) -> np.ndarray:
    """Local rotations (J, 4) of a T-pose in canonical axes: arms along y, legs along -z."""
    world = np.tile(np.eye(3), (joints, 1, 1))
    for segment, name in enumerate(names):
        side, _, bone = name.partition("_")
        if bone in ("clavicle", "upper_arm", "forearm", "hand"):
            y = np.array([0.0, 1.0 if side == "left" else -1.0, 0.0])
            x = np.array([1.0, 0, 0]) if bone == "clavicle" else np.array([0.0, 0.0, -1.0])
            world[segment] = np.stack([x, np.cross(y, x), y], axis=1)
        elif bone in ("thigh", "shank"):
            world[segment] = np.stack([[0, 1, 0], [1, 0, 0], [0, 0, -1]], axis=1)
    for joint in range(segments, joints):
        world[joint] = world[parents[joint]]
    local = world.copy()
    local[1:] = np.swapaxes(world[parents[1:]], 1, 2) @ world[1:]
    return from_matrix(local)


def test_the_motion_begins_over_the_origin_of_its_space() -> None:
    capture = replace(placed(swaying(), 1.0, (7.0, -3.0)), first_frame=5)
    motion, actor = normalize_capture(capture)
    root = realize_motion(motion, actor.morphology, play=True)[0][5, 0]
    assert np.allclose(root[:2], 0.0, atol=1e-9)


@given(st.floats(-10, 10), seeds)
def test_the_heading_follows_the_pelvis_through_whole_turns(speed: float, seed: int) -> None:
    times = np.arange(90) / 60.0
    pelvis = to_matrix(about((0, 0, 1), speed * times))
    smooth = smoothed_heading(pelvis, 60.0)
    assert np.allclose(np.diff(smooth)[40:50], speed / 60.0, atol=1e-3 * abs(speed))
    assert np.abs(np.angle(np.exp(1j * (smooth - speed * times)))[40:50]).max() < 0.02 * abs(speed) + 1e-9


def test_a_capture_without_a_body_map_is_refused_in_words() -> None:
    capture = make_capture("crate", body_map=None)
    with pytest.raises(StudioError, match="'crate' has no body map: choose which joint"):
        normalize_capture(capture)
    assert capture_contacts(capture) == {point: [] for point in capture_contacts(capture)}


def test_a_long_capture_holds_the_rotations_of_its_segments_once_while_it_is_normalised() -> None:
    capture = swaying(3, frames=8_000)
    tracemalloc.start()
    motion, _ = normalize_capture(capture)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    layout, frames = BodyLayout(motion.spine_places.size), capture.frame_count
    points, rotations = 24 * layout.point_count * frames, 72 * layout.segment_count * frames
    assert peak < rotations + 2 * points + motion.channels.nbytes
