"""A skeleton is one tree of named joints, or it is not made."""

import numpy as np
import pytest

from studio.core.body.skeleton import Skeleton
from studio.core.errors import StudioError


def _skeleton(names: str = "hips spine head leg foot", parents: tuple[int, ...] = (-1, 0, 1, 0, 3)) -> Skeleton:
    words = tuple(names.split())
    return Skeleton(words, np.array(parents), np.zeros((len(words), 3)), np.zeros(len(words), dtype=bool))


def test_a_skeleton_knows_its_tree() -> None:
    skeleton = _skeleton()
    assert skeleton.children == ((1, 3), (2,), (), (4,), ())
    assert skeleton.depths == (0, 1, 2, 1, 2)
    assert skeleton.path(0, 4) == (0, 3, 4)
    assert skeleton.path(1, 4) == ()
    assert skeleton.common_ancestor(2, 4) == 0
    assert skeleton.descendants(0) == (1, 2, 3, 4)


def test_its_arrays_are_frozen() -> None:
    with pytest.raises(ValueError, match="read-only"):
        _skeleton().offsets[0] = 1.0


def test_a_wrong_joint_name_is_answered_with_near_ones() -> None:
    with pytest.raises(StudioError, match=r"No joint is called 'Foot'\. Nearest names: foot"):
        _skeleton().index("Foot")


@pytest.mark.parametrize(
    ("names", "parents", "sentence"),
    [
        ("a b b", (-1, 0, 0), "Two joints of the skeleton are called 'b'"),
        ("a b c", (-1, 2, 0), "Joint 'b' comes before its parent"),
        ("a b c", (-1, -1, 0), "Joint 'b' comes before its parent"),
        ("a b c", (1, 0, 0), "must be its root"),
        ("", (), "at least one joint"),
        ("a b", (-1, 0, 0), "needs parents of shape"),
    ],
)
def test_joints_that_are_no_tree_are_refused(names: str, parents: tuple[int, ...], sentence: str) -> None:
    with pytest.raises(StudioError, match=sentence):
        _skeleton(names, parents)


def test_an_offset_that_is_no_number_is_refused() -> None:
    with pytest.raises(StudioError, match="offset of joint 'b' is not a finite number"):
        Skeleton(("a", "b"), np.array([-1, 0]), np.array([[0, 0, 0], [0, np.nan, 0]]), np.zeros(2, dtype=bool))
