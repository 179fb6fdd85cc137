"""Areas that are tilted: by a rotation of their own, keyed, or with a prop that they follow."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from studio.core.body.canonical import BodyPart
from studio.core.constraints.area import AreaConstraint, AreaShape
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.constraints.carried_over import MIRROR_TRANSFORM, constraint_on_clip
from studio.core.constraints.follow import UNTURNED, FollowProp
from studio.core.curves.activation import ActivationCurve
from studio.core.curves.keyed import KeyedTurn
from studio.core.solver.adapt import adapt, body_point_positions
from studio.core.solver.request import AdaptRequest
from studio.core.solver.task_assembly.area_rows import nearest_allowed_position
from studio.core.solver.task_assembly.tracks import Track
from studio.io.project.character_file import bundled_characters
from tests.core.motions import walk
from tests.core.test_constraint_kinds import BLOCK

WRIST = BodyPoint(BodyPart.RIGHT_FOREARM, at_end=True)
ALWAYS = ActivationCurve(-1.0, -1.0, 100.0, 100.0)
WALK, CONTACTS = walk()
BODY = bundled_characters()["tall_man"].morphology
SLANTED = tuple(Rotation.from_euler("XY", (0.6, -0.4)).as_quat().tolist())
BODIED = (AreaShape.BOX, AreaShape.TABLE, AreaShape.CYLINDER, AreaShape.MESH)
seeds = st.integers(0, 2**32 - 1)


def area(shape: AreaShape = AreaShape.BOX, **more: object) -> AreaConstraint:
    fields = {"size": (0.6, 0.4, 0.5), "mesh": BLOCK if shape is AreaShape.MESH else None, **more}
    return AreaConstraint("walk", "Box", WRIST, Chain(), 0, ALWAYS, shape=shape, **fields)  # type: ignore[arg-type]


@pytest.mark.parametrize("shape", BODIED)
@given(seed=seeds)
def test_a_tilted_area_is_the_upright_one_rotated(shape: AreaShape, seed: int) -> None:
    random = np.random.default_rng(seed)
    turn, heading, centre = Rotation.random(random_state=seed), random.uniform(-3.0, 3.0), random.normal(size=3)
    inner = random.uniform(-0.35, 0.35, 3)
    whole = Rotation.from_rotvec([0.0, 0.0, heading]) * turn
    upright = nearest_allowed_position(area(shape), inner)
    tilted = area(shape, centre=tuple(centre), heading=heading, tilt=tuple(turn.as_quat().tolist()))
    assert nearest_allowed_position(tilted, centre + whole.apply(inner)) == pytest.approx(
        centre + whole.apply(upright), abs=1e-9
    )


def wrist_at(frame: int, *constraints: AreaConstraint, **request: object) -> np.ndarray:
    asked = AdaptRequest(WALK, BODY, CONTACTS, constraints, **request)  # type: ignore[arg-type]
    return np.asarray(body_point_positions(WRIST, adapt(asked, frame, frame))[0])


def round_the_wrist(**more: object) -> AreaConstraint:
    """A flat box of which the wrist is just inside the upper face, where it is tilted by ``SLANTED``."""
    up = Rotation.from_quat(SLANTED).apply([0.0, 0.0, 1.0])
    centre = wrist_at(30) - 0.06 * up
    return area(size=(0.6, 0.6, 0.2), centre=tuple(centre.tolist()), **more)


def test_a_wrist_leaves_a_tilted_box_through_its_own_upper_face() -> None:
    box = round_the_wrist(tilt=SLANTED)
    up = Rotation.from_quat(SLANTED).apply([0.0, 0.0, 1.0])
    assert up @ (wrist_at(30, box) - np.array(box.centre)) == pytest.approx(0.1, abs=2e-4)


def test_a_keyed_tilt_is_that_of_each_frame() -> None:
    keys = KeyedTurn((10 / WALK.frame_rate, 30 / WALK.frame_rate), (UNTURNED, SLANTED))
    keyed, fixed = round_the_wrist(tilt=keys), round_the_wrist(tilt=SLANTED)
    assert wrist_at(30, keyed) == pytest.approx(wrist_at(30, fixed), abs=1e-6)


def test_a_box_that_follows_a_prop_tilts_with_it() -> None:
    fixed = round_the_wrist(tilt=SLANTED, heading=0.3)
    turned = Rotation.from_rotvec([0.0, 0.0, 0.3]) * Rotation.from_quat(SLANTED)
    prop = Track(np.array([fixed.centre]), turned.as_matrix()[None])
    following = replace(fixed, centre=FollowProp("box"), tilt=UNTURNED, heading=0.0)
    assert wrist_at(30, following, tracks={following.centre: prop}) == pytest.approx(wrist_at(30, fixed), abs=1e-6)


@pytest.mark.parametrize("tilt", [SLANTED, KeyedTurn((0.0, 1.0), (SLANTED, UNTURNED))])
def test_the_mirror_image_of_a_tilted_area_is_its_reflection(tilt: object) -> None:
    box = area(centre=(0.3, 0.2, 0.9), heading=0.4, tilt=tilt)
    mirrored = constraint_on_clip(box, MIRROR_TRANSFORM)
    assert constraint_on_clip(mirrored, MIRROR_TRANSFORM) == box
    if not isinstance(tilt, KeyedTurn):
        across = np.array([1.0, -1.0, 1.0])
        for point in np.random.default_rng(1).normal((0.3, 0.2, 0.9), 0.2, (20, 3)):
            there = nearest_allowed_position(mirrored, across * point)
            assert there == pytest.approx(across * nearest_allowed_position(box, point), abs=1e-9)
