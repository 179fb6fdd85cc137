"""Bodies that grow have what their keys say at their times, and what lies between in between; files keep them."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from studio.core.body.growth import KeyedProportions, animated_morphology
from studio.core.body.morphology import AnimatedMorphology, Proportions
from studio.core.errors import StudioError
from studio.core.mesh.character import Character
from studio.core.solver.adapt import adapt
from studio.core.solver.performers.performing import adapt_performers
from studio.document.document import Document
from studio.io.project.character_file import bundled_characters, read_character, write_character
from studio.io.project.entity_json import entity_of, entity_record
from tests.builders import make_project

CHILD = bundled_characters()["child"]
KEYS = KeyedProportions((1.0, 3.0), (Proportions(), Proportions(stature=1.5, thighs=1.1, head=0.8)))
GROWING = replace(CHILD, proportions=KEYS)


@given(st.integers(0, 1), st.sampled_from([30.0, 60.0]))
def test_at_a_key_the_body_is_as_the_key_says(key: int, rate: float) -> None:
    body = animated_morphology(CHILD.build, KEYS, 0.0, rate, round(4 * rate))
    assert np.allclose(body.rows[round(KEYS.times[key] * rate)], KEYS.values[key].applied_to(CHILD.build).packed)


def test_between_keys_it_is_as_the_proportions_are_there_and_beyond_them_it_rests() -> None:
    body = GROWING.body_over(0.0, 30.0, 120)
    assert isinstance(body, AnimatedMorphology)
    assert np.allclose(body.rows[45], GROWING.proportions_at(1.5).applied_to(CHILD.build).packed)
    assert np.allclose(body.rows[0], body.rows[30])
    assert np.allclose(body.rows[90], body.rows[119])
    assert (np.diff([body.at(frame).stature for frame in range(30, 91)]) > 0.0).all()


def test_a_clip_that_begins_later_meets_the_body_as_it_is_then() -> None:
    late = GROWING.body_over(2.0, 30.0, 60)
    assert np.allclose(late.rows, GROWING.body_over(0.0, 30.0, 120).rows[60:])
    assert GROWING.body_over(2.0, 30.0, 60) is late  # so that what was solved for it is found again


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
    write_character(GROWING, tmp_path / "child.json")
    assert read_character(tmp_path / "child.json").proportions == KEYS
    members: dict[str, np.ndarray] = {}
    record = entity_record("characters", "child", GROWING, members)
    read = entity_of("characters", record, members.__getitem__)
    assert isinstance(read, Character)
    assert read.proportions == KEYS
    assert (record["schema"], entity_record("characters", "child", CHILD, members)["schema"]) == (2, 1)


@pytest.mark.parametrize(
    "record", ['"times": [0, 0], "values": [{}, {}]', '"times": [0, 1], "values": [{}]', '"times": [0]']
)
def test_keys_that_make_no_sense_are_refused_in_a_sentence(tmp_path: Path, record: str) -> None:
    path = tmp_path / "child.json"
    write_character(GROWING, path)
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
