"""The canonical body's layout holds together for any number of vertebrae."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from studio.core.body.canonical import BodyLayout, BodyPart
from studio.core.kernels.body.parts import distal_range
from tests.core.twins.body import carried_by, carried_points

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


@pytest.mark.parametrize("spine_count", [-1, 0, 1])
def test_a_spine_of_less_than_two_is_refused(spine_count: int) -> None:
    with pytest.raises(ValueError, match="needs a pelvis and a thorax"):
        BodyLayout(spine_count)


def test_parts_have_labels_in_words() -> None:
    assert BodyPart.LEFT_UPPER_ARM.label == "Left upper arm"
