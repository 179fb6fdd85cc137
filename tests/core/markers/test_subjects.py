"""Subjects are told from labels, whatever sign stands between them and their markers."""

import pytest

from studio.core.markers.subjects import shared_beginning, with_subjects

MARKERS = ("LASI", "RASI", "L.Knee", "R.Knee", "L_Toe", "R_Toe", "HeadL", "HeadR", "C7")
BODY = (*MARKERS, "LPSI", "RPSI", "L.Ankle", "R.Ankle", "LHEE", "RHEE", "CLAV")


@pytest.mark.parametrize("sign", ["_", ".", "-", " ", "__"])
@pytest.mark.parametrize("names", [("Ann", "Ben"), ("S_1", "S_2"), ("Ann", "Ann-Lee")])
def test_each_subject_comes_before_a_colon_with_its_markers_and_no_others(sign: str, names: tuple[str, ...]) -> None:
    labels = [f"{name}{sign}{marker}" for name in names for marker in MARKERS] + ["Box1"]
    assert with_subjects(labels) == (*(f"{name}:{marker}" for name in names for marker in MARKERS), "Box1")


@pytest.mark.parametrize("form", ["{1}_{0}", "{1}.{0}", "{1}:{0}", "{0}{1}", "{1}{0}"])
@pytest.mark.parametrize("names", [("Ann", "Ben"), ("P1", "P2"), ("Li", "Ri"), ("1", "2"), ("Ann",)])
def test_a_name_behind_a_label_or_without_a_sign_is_told_by_the_body_it_has(form: str, names: tuple[str, ...]) -> None:
    labels = [form.format(name, marker) for name in names for marker in BODY] + ["Prop"]
    assert with_subjects(labels) == (*(f"{name}:{marker}" for name in names for marker in BODY), "Prop")


@pytest.mark.parametrize("form", ["Ben_{}", "Ben.{}", "{}_2", "{}-2", "{}.Ben"])
@pytest.mark.parametrize("alternate", [False, True])
def test_a_body_without_a_name_beside_a_named_one_is_the_first(form: str, alternate: bool) -> None:
    name = form.replace("{}", "").strip("_.-")
    whole = {marker: f"1:{marker}" for marker in BODY} | {form.format(marker): f"{name}:{marker}" for marker in BODY}
    labels = [each for marker in BODY for each in (marker, form.format(marker))] if alternate else list(whole)
    assert with_subjects([*labels, "Box1"]) == (*(whole[label] for label in labels), "Box1")


@pytest.mark.parametrize(
    "labels",
    [
        ("L.Knee", "R.Knee", "L.Ankle", "R.Ankle", "L.Lateral", "R.Lateral", "L.Low", "R.Low"),
        tuple(f"Skeleton_{marker}" for marker in MARKERS),
        tuple(f"{bone}_{place}" for bone in ("LThigh", "RThigh", "LShank", "RShank") for place in "1234"),
        tuple(
            f"{side}_{joint}_{place}"
            for side in "LR"
            for joint in ("Knee", "Ankle", "Elbow", "Wrist", "Toe")
            for place in ("Out", "In")
        ),
        tuple(
            f"{joint}{place}{side}" for side in "LR" for joint in ("Knee", "Ankle", "Elbow") for place in ("Out", "In")
        ),
        tuple(
            f"{side}{bone}_{place}"
            for side in "LR"
            for bone in ("THI", "TIB", "Foot", "UPA", "FRM", "Hand")
            for place in "123"
        ),
        BODY,
        tuple(
            f"p{side}{place}"
            for side in ("Left", "Right")
            for place in ("ASI", "Toe", "TopOfHand", "Elbow", "Acromion")
        ),
        ("Ann:LASI", "Ben_LASI"),
        (*BODY, *(f"{marker}_2" for marker in BODY if "Ankle" not in marker and "HEE" not in marker), "RHIP", "LHIP"),
        (),
    ],
)
def test_sides_bones_and_a_single_beginning_are_no_subjects(labels: tuple[str, ...]) -> None:
    assert with_subjects(labels) == labels


def test_a_beginning_that_all_labels_share_is_found_with_its_sign() -> None:
    assert shared_beginning([f"Skeleton_{marker}" for marker in MARKERS]) == "Skeleton_"
    assert shared_beginning(MARKERS) == ""
