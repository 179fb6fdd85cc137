"""Bodies and their measures, constant or changing with time."""

from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from studio.core.body.canonical import BodyLayout, BodyPart
from studio.core.body.growth import KeyedProportions, animated_morphology
from studio.core.body.kinematics import joint_world
from studio.core.body.morphology import AnimatedMorphology, Morphology, Proportions, sole_rows
from studio.core.errors import StudioError
from studio.core.grounds import Slope
from studio.core.grounds.ground import Ground
from studio.core.kernels import measure_columns as measure
from studio.core.kernels.algebra.rotation_tuples import rotation_from_matrix
from studio.core.kernels.body import parts as kernel
from studio.core.kernels.body.parts import distal_range
from studio.core.mesh.character import Character
from studio.core.normalized.realize import realize_motion
from studio.core.quality.metrics import angular_acceleration, contact_quality
from studio.core.rigs.character_skeleton import character_poses, character_skeleton
from studio.core.solver.adapt import adapt
from studio.core.solver.performers.staged_performances import adapt_performers
from studio.core.solver.request import AdaptRequest
from studio.document.document import Document
from studio.io.project.character_file import bundled_characters, read_character, write_character
from studio.io.project.entity_json import entity_of, entity_record
from tests.builders import make_morphology, make_project
from tests.core.motions import random_rotations, target, times, walk
from tests.core.twins import body as twin
from tests.core.twins.body import carried_by, carried_points

# Measures of a body and the sliders upon them.


factors = st.floats(0.2, 5.0)
proportions = st.builds(Proportions, *(factors for _ in fields(Proportions)))


def test_proportions_of_1_are_the_build_itself() -> None:
    for character in bundled_characters().values():
        assert np.array_equal(Proportions().applied_to(character.build).packed, character.build.packed)


@given(factors)
def test_stature_scales_every_measure_alike(factor: float) -> None:
    body = make_morphology()
    assert np.allclose(Proportions(stature=factor).applied_to(body).packed, times(factor, body))


@given(proportions)
def test_any_proportions_give_a_body(chosen: Proportions) -> None:
    body = chosen.applied_to(make_morphology())
    assert body.leg_length > 0.0
    assert body.stature > 0.0


@pytest.mark.parametrize(
    ("name", "moved"),
    [
        ("trunk", {"spine", "collar_base"}), ("shoulders", {"clavicle", "collar_base"}), ("hips", {"hip_offset"}),
        ("upper_arms", {"arm"}), ("forearms", {"arm"}), ("hands", {"hand"}), ("thighs", {"leg"}), ("shanks", {"leg"}),
        ("feet", {"foot", "toe", "ankle_height", "toe_height", "heel_length"}), ("head", {"head", "neck"}),
    ],
)  # fmt: skip
def test_each_slider_moves_its_own_measures(name: str, moved: set[str]) -> None:
    before, after = make_morphology(), Proportions(**{name: 1.5}).applied_to(make_morphology())
    changed = {
        field.name for field in fields(Morphology)
        if not np.array_equal(getattr(before, field.name), getattr(after, field.name))
    }  # fmt: skip
    assert changed == moved


@given(st.integers(2, 8))
def test_a_body_comes_back_from_json(spine_count: int) -> None:
    body = make_morphology(leg_scale=1.1, spine_count=spine_count)
    again = Morphology.from_json(body.to_json())
    assert again == body
    assert hash(again) == hash(body)
    assert again != make_morphology()


def test_packed_measures_stand_where_the_kernels_look_for_them() -> None:
    random = np.random.default_rng(0)
    plain = make_morphology()
    body = replace(
        plain, **{field.name: random.uniform(0.1, 1, np.shape(getattr(plain, field.name))) for field in fields(plain)}
    )
    for name, first in (
        ("neck", measure.NECK), ("head", measure.HEAD), ("collar_base", measure.COLLAR_BASE),
        ("clavicle", measure.CLAVICLE),
        ("arm", measure.ARM), ("hand", measure.HAND), ("hip_offset", measure.HIP_OFFSET),
        ("leg", measure.LEG),
        ("foot", measure.FOOT), ("toe", measure.TOE), ("ankle_height", measure.ANKLE_HEIGHT),
        ("toe_height", measure.TOE_HEIGHT), ("heel_length", measure.HEEL_LENGTH), ("spine", measure.SPINE),
    ):  # fmt: skip
        numbers = np.ravel(getattr(body, name))
        assert np.array_equal(body.packed[first : first + len(numbers)], numbers)
    assert len(body.packed) == measure.SPINE + 3 * len(body.spine)


def test_stature_is_sole_to_crown() -> None:
    body = make_morphology()
    assert body.stature == pytest.approx(0.08 + 0.84 + 0.04 + 0.48 + 0.10 + 0.18)


def test_a_missing_measure_is_named() -> None:
    record = make_morphology().to_json()
    del record["toe"], record["neck"]
    with pytest.raises(ValueError, match="A morphology needs neck, toe"):
        Morphology.from_json(record)


def test_measures_cannot_be_changed_afterwards() -> None:
    body = make_morphology()
    for array in (body.leg, body.spine, body.packed):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 2.0


# Bodies whose measures change at every frame: feet stay locked, bones have their frame's length, nothing jitters.


BODIES = {name: character.morphology for name, character in bundled_characters().items()}
WALK, CONTACTS = walk(180)
TIME = np.linspace(0.0, 1.0, WALK.frame_count)
GROWING = TIME**3 * (10.0 - 15.0 * TIME + 6.0 * TIME**2)
HEELS = tuple(each for each in CONTACTS if each.point.is_heel)
TOES = tuple(each for each in CONTACTS if not each.point.is_heel)


def _between(first: str, second: str, shares: np.ndarray = GROWING) -> AnimatedMorphology:
    return AnimatedMorphology.from_bodies(BODIES[first], BODIES[second], shares)


@pytest.mark.parametrize("ground", [Ground(), Slope(0.0, 0.15, 0.4)], ids=["floor", "slope"])
@pytest.mark.parametrize(("first", "second"), [("child", "giant"), ("tall_man", "stocky_man")])
def test_feet_stay_locked_while_the_body_grows(first: str, second: str, ground: Ground) -> None:
    body = _between(first, second)
    adapted = adapt(AdaptRequest(WALK, body, CONTACTS, (), ground))
    assert contact_quality(adapted, HEELS, ground).slide < 1e-3
    whole = contact_quality(adapted, CONTACTS, ground)
    assert max(whole.rise, whole.penetration) < 2e-3
    for contact in TOES:  # a flat foot that grows pushes its toe ahead of its heel's edge by as much, and by no more
        soles = sole_rows(body, contact.point.side)[contact.first : contact.last + 1]
        lengths = soles[:, 0] + soles[:, 4]
        assert contact_quality(adapted, (contact,), ground).slide < np.ptp(lengths) * 1.1 + 1e-3


@pytest.mark.parametrize(("first", "second"), [("child", "giant"), ("adult_woman", "tall_man")])
def test_joints_are_as_smooth_as_on_a_still_body(first: str, second: str) -> None:
    """Travel, and turns, of a body that grows over the clip: at most 3 times the peaks of the still ones."""
    growing = adapt(AdaptRequest(WALK, _between(first, second), CONTACTS))
    still = [adapt(AdaptRequest(WALK, BODIES[name], CONTACTS)) for name in (first, second)]

    def peaks(positions: np.ndarray) -> np.ndarray:
        return np.linalg.norm(np.diff(positions, 2, axis=0), axis=-1).max(axis=0) * WALK.frame_rate**2

    assert (peaks(growing.positions) < 3.0 * np.maximum(*(peaks(each.positions) for each in still)) + 0.5).all()
    turns, usual = (angular_acceleration(each.rotations, WALK.frame_rate).max(axis=0) for each in (growing, still[0]))
    other = angular_acceleration(still[1].rotations, WALK.frame_rate).max(axis=0)
    assert (turns < 3.0 * np.maximum(usual, other) + 5.0).all()


@pytest.mark.parametrize("shift", [(0.0, 0.0), (20.0, -7.0)])
def test_where_a_growing_body_goes_does_not_depend_on_how_far_the_origin_is(shift: tuple[float, float]) -> None:
    body, channels = _between("child", "giant"), WALK.channels.copy()
    channels[:, :2] += shift
    here, there = (realize_motion(replace(WALK, channels=each), body)[0] for each in (WALK.channels, channels))
    apart = there - here
    assert np.allclose(apart, apart[0], atol=1e-9)
    assert np.allclose(apart[0, 0, :2], np.array(shift) * BODIES["child"].leg_length, atol=1e-9)


def test_every_frame_has_its_own_lengths_and_constraints_are_met() -> None:
    body = _between("child", "giant")
    wrist = target("left_forearm", (1.2, 0.4, 1.0))
    adapted = adapt(AdaptRequest(WALK, body, CONTACTS, (wrist,)), 20, 160)
    rows = body.rows[20:161]
    legs = np.linalg.norm(np.diff(adapted.positions[:, body.layout.hip_point(0) :][:, :3], axis=1), axis=2)
    assert np.allclose(legs, rows[:, 26:28], atol=1e-9)
    assert adapted.animated is body
    assert adapted.morphology == body.first_frame_body == BODIES["child"]
    whole = adapt(AdaptRequest(WALK, body, CONTACTS, (wrist,)))
    assert np.array_equal(adapted.positions, whole.positions[20:161])


def test_a_body_that_stays_as_it_is_is_the_still_one() -> None:
    body = BODIES["tall_man"]
    still = adapt(AdaptRequest(WALK, body, CONTACTS))
    animated = adapt(AdaptRequest(WALK, AnimatedMorphology(np.tile(body.packed, (WALK.frame_count, 1))), CONTACTS))
    assert np.allclose(animated.positions, still.positions, atol=1e-12)
    assert still.animated is None


def test_other_programs_get_every_joint_where_it_is() -> None:
    adapted = adapt(AdaptRequest(WALK, _between("child", "tall_man"), CONTACTS))
    poses = character_poses(adapted)
    places, _ = joint_world(character_skeleton(adapted.morphology), poses)
    ankle = adapted.morphology.layout.ankle_point(0)
    distances = np.linalg.norm(places - adapted.positions[:, ankle, None], axis=2).min(axis=1)
    assert distances.max() < 1e-9


@given(st.floats(0.0, 1.0), st.integers(2, 5))
def test_between_two_bodies_lie_their_measures(share: float, spine_count: int) -> None:
    small, large = (make_morphology(scale, spine_count=spine_count) for scale in (0.7, 1.3))
    body = AnimatedMorphology.from_bodies(small, large, np.array([0.0, share, 1.0]))
    assert body.layout == small.layout
    assert np.allclose(body.rows[1], small.packed + share * (large.packed - small.packed))
    assert body.first_frame_body == small


# Bodies that grow have what their keys say at their times, and what lies between in between; files keep them.


CHILD = bundled_characters()["child"]
KEYS = KeyedProportions((1.0, 3.0), (Proportions(), Proportions(stature=1.5, thighs=1.1, head=0.8)))
GROWING_BODY = replace(CHILD, proportions=KEYS)


@given(st.integers(0, 1), st.sampled_from([30.0, 60.0]))
def test_at_a_key_the_body_is_as_the_key_says(key: int, rate: float) -> None:
    body = animated_morphology(CHILD.build, KEYS, 0.0, rate, round(4 * rate))
    assert np.allclose(body.rows[round(KEYS.times[key] * rate)], KEYS.values[key].applied_to(CHILD.build).packed)


def test_between_keys_it_is_as_the_proportions_are_there_and_beyond_them_it_rests() -> None:
    body = GROWING_BODY.body_over(0.0, 30.0, 120)
    assert isinstance(body, AnimatedMorphology)
    assert np.allclose(body.rows[45], GROWING_BODY.proportions_at(1.5).applied_to(CHILD.build).packed)
    assert np.allclose(body.rows[0], body.rows[30])
    assert np.allclose(body.rows[90], body.rows[119])
    assert (np.diff([body.at(frame).stature for frame in range(30, 91)]) > 0.0).all()


def test_a_clip_that_begins_later_meets_the_body_as_it_is_then() -> None:
    late = GROWING_BODY.body_over(2.0, 30.0, 60)
    assert np.allclose(late.rows, GROWING_BODY.body_over(0.0, 30.0, 120).rows[60:])
    assert GROWING_BODY.body_over(2.0, 30.0, 60) is late  # so that what was solved for it is found again


def test_proportions_between_keys_are_none_beyond_them() -> None:
    keys = KeyedProportions((0.0, 1.0, 1.1, 3.0), tuple(Proportions(stature=each) for each in (0.2, 4.9, 5.0, 0.2)))
    assert np.ptp(keys.at(np.linspace(0.0, 3.0, 500))[:, 0]) <= 4.8


def test_a_body_that_grows_is_solved_as_such_on_the_stage() -> None:
    project = make_project(characters=1, constraints=0, frames=101)
    [(key, character)] = project.characters.items()
    growing = replace(character, proportions=KeyedProportions((0.0, 1.0), (Proportions(), Proportions(stature=1.4))))
    project = project.with_entity("characters", key, growing)
    from studio.jobs.performances import prepared_capture

    [made] = adapt_performers(project, project.performers, prepared_capture, adapt).performances.values()
    lengths = np.linalg.norm(
        np.diff(made.adapted.positions[:, made.adapted.morphology.layout.hip_point(0) :][:, :2], axis=1), axis=2
    )
    assert lengths[-1] / lengths[0] == pytest.approx(1.4)
    assert made.adapted.morphology_at(100).stature == pytest.approx(1.4 * growing.morphology.stature)


def test_keys_come_back_from_a_character_file_and_from_a_project(tmp_path: Path) -> None:
    write_character(GROWING_BODY, tmp_path / "child.json")
    assert read_character(tmp_path / "child.json").proportions == KEYS
    members: dict[str, np.ndarray] = {}
    record = entity_record("characters", "child", GROWING_BODY, members)
    read = entity_of("characters", record, members.__getitem__)
    assert isinstance(read, Character)
    assert read.proportions == KEYS
    assert (record["schema"], entity_record("characters", "child", CHILD, members)["schema"]) == (2, 1)


@pytest.mark.parametrize(
    "record", ['"times": [0, 0], "values": [{}, {}]', '"times": [0, 1], "values": [{}]', '"times": [0]']
)
def test_keys_that_make_no_sense_are_refused_in_a_sentence(tmp_path: Path, record: str) -> None:
    path = tmp_path / "child.json"
    write_character(GROWING_BODY, path)
    text = path.read_text()
    begin, end = text.index('"proportions": {') + 16, text.index('"blending"')
    path.write_text(f"{text[:begin]}{record}}},\n {text[end:]}")
    with pytest.raises(StudioError, match="the measures are damaged"):
        read_character(path)


def test_a_key_is_an_undo_step() -> None:
    document = Document(make_project(characters=1))
    [(key, character)] = document.project.characters.items()
    document.replace("characters", key, replace(character, proportions=KEYS), "Key the body")
    document.undo_stack.undo()
    assert document.project.characters[key].proportions == character.proportions
    document.close()


# The canonical body's layout holds together for any number of vertebrae.


layouts = st.integers(2, 24).map(BodyLayout)


@given(layouts)
def test_every_point_has_one_name_and_every_segment_two_ends(layout: BodyLayout) -> None:
    names = layout.point_names()
    assert len(names) == len(set(names)) == layout.point_count
    assert len(layout.proximal_points()) == len(layout.distal_points()) == layout.segment_count
    ends = [
        *layout.distal_points(),
        0,
        *(at(side) for side in (0, 1) for at in (layout.collar_point, layout.hip_point)),
    ]
    assert sorted(ends) == list(range(layout.point_count))


@given(layouts)
def test_points_are_called_what_they_are(layout: BodyLayout) -> None:
    names = layout.point_names()
    assert names[layout.neck_base] == "neck base"
    assert names[layout.head_joint] == "head joint"
    assert names[layout.head_end] == "head end"
    for side, name in enumerate(("left", "right")):
        assert names[layout.collar_point(side)] == f"{name} collar"
        assert names[layout.wrist_point(side)] == f"{name} wrist"
        assert names[layout.hip_point(side)] == f"{name} hip"
        assert names[layout.ankle_point(side)] == f"{name} ankle"
        assert names[layout.toe_point(side)] == f"{name} toe"


@given(layouts)
def test_a_segment_begins_where_the_one_that_carries_it_ends(layout: BodyLayout) -> None:
    begin, end = layout.proximal_points(), layout.distal_points()
    hung = {
        layout.segment_of_part(BodyPart(f"{side}_{part}"))
        for side in ("left", "right")
        for part in ("clavicle", "thigh")
    }
    for segment, parent in enumerate(layout.parent_segments()):
        assert parent < segment
        if segment == 0:
            assert parent == -1
        elif segment not in hung:
            assert begin[segment] == end[parent]


@given(layouts)
def test_parts_and_segments_name_each_other(layout: BodyLayout) -> None:
    assert {layout.part_of_segment(segment) for segment in range(layout.segment_count)} >= set(BodyPart) - {
        BodyPart.ABDOMEN
    }
    for part in BodyPart:
        if part is not BodyPart.ABDOMEN or layout.spine_count > 2:
            assert layout.part_of_segment(layout.segment_of_part(part)) is part


@given(layouts, st.data())
def test_all_that_hangs_on_a_segment_is_one_range(layout: BodyLayout, data: st.DataObject) -> None:
    segment = data.draw(st.integers(0, layout.segment_count - 1))
    first, past, first_point, past_point = distal_range(segment, layout.spine_count)
    assert set(range(first, past)) == carried_by(layout, segment)
    assert set(range(first_point, past_point)) == carried_points(layout, segment)


def test_parts_have_labels_in_words() -> None:
    assert BodyPart.LEFT_UPPER_ARM.label == "Left upper arm"


# Moving parts of a posed body.


seeds = st.integers(0, 2**32 - 1)
BODY = make_morphology(spine_count=4)
POSITIONS, ROTATIONS = (array[17] for array in realize_motion(walk(20)[0], BODY))


@given(seeds, st.integers(0, BodyLayout(4).segment_count - 1))
def test_turning_a_part_carries_all_that_hangs_on_it_and_keeps_every_bone(seed: int, segment: int) -> None:
    turn, positions, rotations = random_rotations(np.random.default_rng(seed)), POSITIONS.copy(), ROTATIONS.copy()
    pivot = POSITIONS[BODY.layout.proximal_points()[segment]].copy()
    kernel.rotate_part(rotation_from_matrix(turn), segment, BODY.layout.spine_count, pivot, positions, rotations)
    moved, turned = twin.turn_part(BODY.layout, turn, segment, POSITIONS, ROTATIONS)
    assert np.allclose(positions, moved, atol=1e-12)
    assert np.allclose(rotations, turned, atol=1e-12)
    lengths = [twin.bone_lengths(BODY.layout, each) for each in (POSITIONS, positions)]
    assert np.allclose(*lengths, atol=1e-12)


@given(seeds)
def test_the_whole_body_moves_together(seed: int) -> None:
    shift, positions = np.random.default_rng(seed).normal(size=3), POSITIONS.copy()
    kernel.translate_points(*shift, positions)
    assert np.allclose(positions, POSITIONS + shift, atol=1e-15)


@given(seeds)
def test_a_point_goes_with_its_segment(seed: int) -> None:
    random = np.random.default_rng(seed)
    offset, segment = random.normal(size=3), int(random.integers(BODY.layout.segment_count))
    point = int(random.integers(BODY.layout.point_count))
    found = kernel.body_point_position(point, segment, offset, POSITIONS, ROTATIONS)
    assert np.allclose(found, POSITIONS[point] + ROTATIONS[segment] @ offset, atol=1e-14)
