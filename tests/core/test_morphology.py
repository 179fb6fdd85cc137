"""Measures of a body and the sliders upon them."""

from dataclasses import fields, replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from studio.core.body.morphology import Morphology, Proportions
from studio.core.kernels import layout as at
from studio.io.project.character_file import bundled_characters
from tests.builders import make_morphology
from tests.core.motions import times

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


@pytest.mark.parametrize("factor", [0.19, 5.01, np.nan, np.inf, -1.0])
def test_a_slider_out_of_range_is_refused_by_name(factor: float) -> None:
    with pytest.raises(ValueError, match=r"shanks: a proportion lies between 0\.2 and 5"):
        Proportions(shanks=factor)


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
        ("neck", at.M_NECK), ("head", at.M_HEAD), ("collar_base", at.M_COLLAR_BASE), ("clavicle", at.M_CLAVICLE),
        ("arm", at.M_ARM), ("hand", at.M_HAND), ("hip_offset", at.M_HIP_OFFSET), ("leg", at.M_LEG),
        ("foot", at.M_FOOT), ("toe", at.M_TOE), ("ankle_height", at.M_ANKLE_HEIGHT),
        ("toe_height", at.M_TOE_HEIGHT), ("heel_length", at.M_HEEL_LENGTH), ("spine", at.M_SPINE),
    ):  # fmt: skip
        measure = np.ravel(getattr(body, name))
        assert np.array_equal(body.packed[first : first + len(measure)], measure)
    assert len(body.packed) == at.M_SPINE + 3 * len(body.spine)


def test_stature_is_sole_to_crown() -> None:
    body = make_morphology()
    assert body.stature == pytest.approx(0.08 + 0.84 + 0.04 + 0.48 + 0.10 + 0.18)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"spine": np.zeros((1, 3))}, "spine: expected"),
        ({"arm": np.ones(3)}, "arm: expected shape"),
        ({"hand": np.full((2, 3), np.nan)}, "hand: holds a number that is not finite"),
        ({"leg": [[0.4, 0.0], [0.4, 0.4]]}, "leg: a bone needs a length"),
        ({"neck": -0.1}, "neck: a bone needs a length"),
    ],
)
def test_a_damaged_body_is_refused_by_measure(change: dict, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        replace(make_morphology(), **change)


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
