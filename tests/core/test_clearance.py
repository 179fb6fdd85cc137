"""Arms stay out of their own body: laws of the steps, and what they make of bodies of every width."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from studio.core.body.canonical import BodyPart
from studio.core.body.morphology import Morphology
from studio.core.body.rest_pose import rest_pose
from studio.core.body.standing import standing_points
from studio.core.constraints.base import BodyPoint, Chain, Constraint
from studio.core.constraints.clear import ClearConstraint
from studio.core.constraints.position import PositionConstraint
from studio.core.curves.activation import ActivationCurve
from studio.core.kernels.limits import arm_clearance as kernel
from studio.core.kernels.limits.self_collision import make_clearance_scratch
from studio.core.kernels.records import CAPSULE, ActorClearance, CapsuleArrays, Pose
from studio.core.mesh.skin import fit_skin, skin_vertices
from studio.core.mesh.volume import BodyVolume, fitted_volume, usual_volume
from studio.core.rigs.character_skeleton import t_pose_rotations
from studio.core.solver.adapt import adapt, body_point_positions
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.core.solver.task_assembly.clearance import arm_distances, rest_clearances
from studio.core.solver.task_assembly.self_contact import self_contact_of
from studio.io.project.character_file import bundled_characters
from tests.core.motions import walk

CHARACTERS = bundled_characters()
STOCKY = CHARACTERS["stocky_man"]
BARREL = BodyVolume(STOCKY.volume.segments, STOCKY.volume.places, 1.45 * STOCKY.volume.radii, STOCKY.volume.girths)
WALK, CONTACTS = walk()
ALWAYS = ActivationCurve(-1.0, -1.0, 100.0, 100.0)
WRIST = BodyPoint(BodyPart.RIGHT_FOREARM, at_end=True)
seeds = st.integers(0, 2**32 - 1)


def clear(activation: ActivationCurve = ALWAYS, priority: int = 0, **more: object) -> ClearConstraint:
    point = BodyPoint(BodyPart.THORAX)
    return ClearConstraint("walk", "Clear", point, Chain(), priority, activation, **more)  # type: ignore[arg-type]


def solved(*constraints: Constraint, frames: tuple[int, int | None] = (0, None)) -> AdaptedMotion:
    request = AdaptRequest(WALK, STOCKY.morphology, CONTACTS, constraints, volume=BARREL)
    return adapt(request, *frames)


def belly(adapted: AdaptedMotion) -> tuple[float, ...]:
    """A place within the belly at the first frame."""
    return tuple(adapted.positions[0, 1] + adapted.rotations[0, 1] @ [0.08, -0.02, 0.0])


@pytest.mark.parametrize("name", CHARACTERS)
def test_the_capsules_lie_close_under_the_skin(name: str) -> None:
    character = CHARACTERS[name]
    body, mesh = character.morphology, fit_skin(character.skin, character.build, character.morphology)
    pose, capsules, way = Pose(*rest_pose(body)), np.empty(9, CAPSULE), np.empty(3)
    volume = character.volume
    packed = CapsuleArrays(volume.segments, volume.places, volume.radii, volume.girths)
    kernel.place_capsules(packed, Pose(*pose), np.array(body.layout.proximal_points()), capsules)
    main = mesh.segments[:, 0]
    hips, neck = pose.positions[body.layout.hip_point(0), 2], pose.positions[body.layout.neck_base, 2]
    height = (mesh.vertices[:, 2] - hips) / (neck - hips)
    meant = (main < body.layout.spine_count) & (height > 0.05) & (height < 0.75)
    depth = [
        kernel.signed_distance_to_body(*mesh.vertices[v].astype(float), 0.0, capsules, way) for v in meant.nonzero()[0]
    ]
    assert np.median(np.abs(depth)) < 0.012 * body.stature
    assert np.quantile(depth, 0.98) < 0.02 * body.stature


def test_a_body_without_a_skin_is_as_thick_as_bodies_of_its_length_are() -> None:
    for character in CHARACTERS.values():
        fitted, usual = character.volume, usual_volume(character.morphology)
        assert np.array_equal(fitted.segments[6:], usual.segments[6:])
        assert np.abs(np.log(fitted.radii / usual.radii)).max() < np.log(2.0)


@pytest.mark.parametrize("name", CHARACTERS)
def test_an_arm_is_as_thick_in_whatever_pose_its_skin_is_bound(name: str) -> None:
    """Characters of others come with their arms stretched out."""
    character = CHARACTERS[name]
    body, skin, t_pose = character.build, character.skin, t_pose_rotations(character.build)
    vertices, normals = skin_vertices(skin, body, body, standing_points(body, t_pose), t_pose)
    bound = replace(skin, vertices=vertices, normals=normals, centres=vertices, stance=t_pose, hands=None)
    stretched, at_ease = (fitted_volume(mesh, body, body) for mesh in (bound, skin))
    assert stretched.girths == pytest.approx(at_ease.girths, rel=0.1)
    assert stretched.radii == pytest.approx(at_ease.radii, rel=0.1)


def wild(seed: int) -> tuple[BodyVolume, Morphology, np.ndarray, np.ndarray]:
    """A body posed anyhow, with capsules of any size anywhere on it."""
    random = np.random.default_rng(seed)
    body = STOCKY.morphology
    segments, places = STOCKY.volume.segments, random.normal(scale=0.3, size=(9, 2, 3))
    volume = BodyVolume(segments, places, random.uniform(0.0, 0.3, (9, 2)), random.uniform(0.0, 0.1, 5))
    positions, rotations = rest_pose(body)
    for side in range(2):
        k, upper = body.layout.collar_point(side) + 1, body.layout.segment_of_part(BodyPart.LEFT_UPPER_ARM) + 4 * side
        turn = np.linalg.qr(random.normal(size=(3, 3)))[0]
        turn *= np.linalg.det(turn)
        rotations[upper : upper + 3] = turn @ rotations[upper : upper + 3]
        positions[k : k + 4] = positions[k] + (positions[k : k + 4] - positions[k]) @ turn.T
    return volume, body, positions, rotations


def step(volume: BodyVolume, body: Morphology, pose: tuple, wanted: float | np.ndarray, share: float = 1.0) -> tuple:
    """One arm cleared: whether it moved, the clearances before and after."""
    packed = CapsuleArrays(volume.segments, volume.places, volume.radii, volume.girths)
    proximal, posed, before, after = np.array(body.layout.proximal_points()), Pose(*pose), np.empty(5), np.empty(5)
    actor = ActorClearance(packed, np.zeros((1, 2, 5)), np.zeros((1, 2, 5, 3)))
    clearing = make_clearance_scratch(packed)
    clearing.required_distances[:] = wanted
    kernel.place_capsules(packed, posed, proximal, clearing.capsules)
    kernel.measure_arm_distances(1, packed, clearing.capsules, posed.positions, before, clearing.directions)
    moved = kernel.push_arm_out(1, 0.0, 0, (share, 1.0, 1.0, 1.0), actor, clearing, posed)
    kernel.measure_arm_distances(1, packed, clearing.capsules, posed.positions, after, clearing.directions)
    return moved, before, after


@given(seed=seeds)
def test_any_capsules_leave_the_arm_an_arm(seed: int) -> None:
    volume, body, *posed = wild(seed)
    pose = Pose(*posed)
    before = Pose(*(part.copy() for part in pose))
    moved, _, _ = step(volume, body, tuple(pose), 0.0)
    k = body.layout.collar_point(1) + 1
    lengths = [
        np.linalg.norm(np.diff(positions[k : k + 4], axis=0), axis=1)
        for positions in (before.positions, pose.positions)
    ]
    assert lengths[1] == pytest.approx(lengths[0], abs=1e-9)
    assert np.isfinite(pose.rotations).all()
    assert pose.rotations @ np.swapaxes(pose.rotations, 1, 2) == pytest.approx(
        np.tile(np.eye(3), (len(pose.rotations), 1, 1)), abs=1e-9
    )
    rest = np.ones(len(pose.positions), dtype=bool)
    rest[k + 1 : k + 4] = False
    assert np.array_equal(pose.positions[rest], before.positions[rest])
    assert moved or np.array_equal(pose.positions, before.positions)


@given(seed=seeds)
def test_an_arm_with_room_enough_is_not_touched(seed: int) -> None:
    volume, body, *posed = wild(seed)
    pose = Pose(*posed)
    before = Pose(*(part.copy() for part in pose))
    fade = kernel.SHORTEST_APPROACH + kernel.CONTACT_MARGIN
    _, room, _ = step(volume, body, tuple(part.copy() for part in pose), 0.0)
    moved, _, _ = step(volume, body, tuple(pose), room.min() - fade - kernel.LONGEST_APPROACH)
    assert not moved
    assert all(np.array_equal(*pair) for pair in zip(pose, before, strict=True))


def test_fingers_that_alone_are_too_deep_bend_out() -> None:
    body, volume = STOCKY.morphology, STOCKY.volume
    pose = Pose(*rest_pose(body))
    before = Pose(*(part.copy() for part in pose))
    _, room, _ = step(volume, body, pose, -1.0)
    wanted = room - [1.0, 1.0, 1.0, 1.0, -0.06]
    _, _, after = step(volume, body, pose, wanted)
    wrist, hand = body.layout.wrist_point(1), body.layout.segment_of_part(BodyPart.LEFT_HAND) + 4
    turned = np.arccos(0.5 * (np.trace(pose.rotations[hand] @ before.rotations[hand].T) - 1.0))
    assert after[-1] == pytest.approx(wanted[-1], abs=0.01)
    assert turned > 0.1
    assert np.linalg.norm(pose.positions[wrist] - before.positions[wrist]) < 0.06


def test_arms_of_a_wide_body_come_out_of_it_and_nothing_else_moves() -> None:
    before, after = solved(), solved(clear())
    assert arm_distances(before).min() < 0.0
    assert arm_distances(after).min() > -1e-3
    assert after.residuals.max() < 1e-3
    layout = STOCKY.morphology.layout
    arms = [layout.collar_point(side) + bone for side in range(2) for bone in (2, 3, 4)]
    rest = [point for point in range(layout.point_count) if point not in arms]
    assert np.array_equal(after.positions[:, rest], before.positions[:, rest])


def test_arms_are_not_asked_farther_out_than_their_body_has_them_at_rest() -> None:
    thick = replace(STOCKY.volume, girths=6.0 * STOCKY.volume.girths)
    at_rest = rest_clearances(STOCKY.morphology, thick)
    assert at_rest.min() < -0.05
    actor = CHARACTERS["tall_man"].morphology
    contact = self_contact_of(WALK, STOCKY.morphology, (), thick, actor, clears=True)
    assert contact is not None
    assert contact.clearances is not None
    assert (contact.clearances[0] <= at_rest).all()


def test_any_window_gives_what_the_whole_clip_gives() -> None:
    whole = solved(clear())
    part = solved(clear(), frames=(20, 30))
    assert np.array_equal(part.positions, whole.positions[20:31])
    assert np.array_equal(part.residuals, whole.residuals[:, 20:31])


def test_it_fades_in_monotonely() -> None:
    depths = []
    for share in np.linspace(0.0, 1.0, 6):
        activation = ActivationCurve(-share, 1.0 - share, 100.0, 100.0, "linear") if share < 1.0 else ALWAYS
        depths.append(arm_distances(solved(clear(activation), frames=(0, 0))).min())
    assert (np.diff(depths) >= -1e-9).all()
    assert depths[0] == arm_distances(solved(frames=(0, 0))).min()


def test_a_margin_is_kept_and_one_arm_leaves_the_other_alone() -> None:
    before, after = solved(), solved(clear(margin=0.02, arms="left"))
    layout = STOCKY.morphology.layout
    assert arm_distances(after)[:, 0].min() > 0.019
    right = slice(layout.collar_point(1), layout.collar_point(1) + 5)
    assert np.array_equal(after.positions[:, right], before.positions[:, right])


@pytest.mark.parametrize("reach_priority", [0, 1])
def test_the_higher_priority_has_its_way(reach_priority: int) -> None:
    target = belly(solved(frames=(0, 0)))
    reach = PositionConstraint("walk", "Reach", WRIST, Chain(), reach_priority, ALWAYS, target=target)
    adapted = solved(reach, clear(priority=1 - reach_priority), frames=(0, 0))
    if reach_priority == 0:
        assert body_point_positions(WRIST, adapted)[0] == pytest.approx(target, abs=2e-4)
        assert adapted.residuals[1, 0] > 0.05
    else:
        assert arm_distances(adapted)[0, 1].min() > -1e-3
        assert adapted.residuals[0, 0] > 0.05


def test_only_the_elbow_gives_way_where_the_wrist_may_not() -> None:
    before = solved()
    after = solved(ClearConstraint("walk", "Clear", WRIST, Chain(limb=0.0), 0, ALWAYS))
    wrists = [STOCKY.morphology.layout.wrist_point(side) for side in range(2)]
    assert after.positions[:, wrists] == pytest.approx(before.positions[:, wrists], abs=1e-9)
