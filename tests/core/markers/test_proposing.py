"""Maps and subjects proposed for sets of markers that nobody knows."""

import numpy as np
import pytest

from studio.core.markers.label_words import initials_of, side_and_part
from studio.core.markers.proposing import propose_map
from studio.core.markers.subjects import shared_beginning, with_subjects
from studio.core.markers.trial import Trial
from studio.io.c3d.reader import read_c3d
from tests.core.markers.made import made_body, made_trial

# Maps proposed for sets nobody knows: by words, then by where the markers are.


@pytest.mark.parametrize(
    ("label", "said"),
    [
        ("RKNE", ("right", "knee")),
        ("L.Knee.Medial", ("left", "inner_knee")),
        ("LKneeIn", ("left", "inner_knee")),
        ("left_ankle", ("left", "ankle")),
        ("LKNE1", ("left", "knee")),
        ("R_WRI_ULN", ("right", "outer_wrist")),
        ("right med condyle", ("right", "inner_knee")),
        ("genou_int_gauche", ("left", "inner_knee")),
        ("cheville_ext_droite", ("right", "ankle")),
        ("RCOUDE_INT", ("right", "inner_elbow")),
        ("TETE_AV_G", ("left", "front_head")),
        ("tête arrière droite", ("right", "back_head")),
        ("POIGNET_EXT_D", ("right", "wrist")),
        ("poignet_int_gauche", ("left", "outer_wrist")),
        ("MAIN_G", ("left", "hand")),
        ("LSTYL_RAD", ("left", "wrist")),
        ("LMETA5", ("left", "outer_toe")),
        ("LHL", ("left", "heel")),
        ("RFWT", ("right", "front_hip")),
        ("R.ASIS", ("right", "front_hip")),
        ("LSHO", ("left", "shoulder")),
        ("ShoulderL", ("left", "shoulder")),
        ("V.Sacral", ("", "sacrum")),
        ("VSAC", ("", "sacrum")),
        ("C7", ("", "neck_back")),
        ("L_FLE", ("left", "knee")),
        ("RTHI_3", ("right", "thigh")),
        ("R_SAE", ("right", "shoulder")),
        ("LLANK", ("left", "ankle")),
        ("R_hip_lateral", ("right", "hip")),
        ("LeftHeelProx", ("left", "heel")),
        ("foot tip left", ("left", "big_toe")),
        ("R.Hallux", ("right", "big_toe")),
        ("LBigToe", ("left", "big_toe")),
        ("L_Metatarsal_1", ("left", "inner_toe")),
        ("R_5th_metatarsal", ("right", "outer_toe")),
        ("RMAL_L", ("right", "ankle")),
        ("Right Medial Humeral Epicondyle", ("right", "inner_elbow")),
        ("LWTS", ("left", "wrist")),
        ("PT07", None),
        ("*12", None),
        ("", None),
        ("L", None),
        ("Left", None),
    ],
)
def test_words_in_labels_say_side_and_part(label: str, said: tuple[str, str] | None) -> None:
    assert side_and_part(label) == said


@pytest.mark.parametrize(
    ("label", "side", "part"),
    [
        ("L.KN", "left", "knee"),
        ("R.AN", "right", "ankle"),
        ("LSH", "left", "shoulder"),
        ("RLEP", "right", "knee"),
        ("L_lat_epicondyle", "left", "knee"),
        ("RToe1", "right", "inner_toe"),
        ("LM5", "left", "outer_toe"),
    ],
)
def test_short_words_stand_for_the_first_place_that_no_other_label_names(label: str, side: str, part: str) -> None:
    assert side_and_part(label) is None
    own, parts = initials_of(label)
    assert (own, parts[0]) == (side, part)


def _renamed(names: dict[str, str]) -> Trial:
    trial, _ = made_trial(tuple(names))
    labels = tuple(names[role] for role in names)
    order = [trial.labels.index(role.replace("_", "")) for role in names]
    return Trial(
        "t", "t", labels, ("marker",) * len(labels), trial.points[:, order], trial.residuals[:, order], 100.0, 1, "mm"
    )


LOWER = {
    "left_front_hip": "LASI", "right_front_hip": "RASI", "left_back_hip": "VSAC",
    "left_knee": "LKNE", "left_inner_knee": "LKNE_2", "right_knee": "RKNE_2", "right_inner_knee": "RKNE",
    "left_ankle": "LANK", "right_ankle": "RANK", "left_toe": "LTOE", "right_toe": "RTOE",
}  # fmt: skip


def test_of_two_markers_at_a_knee_the_outer_one_is_told_by_where_it_is() -> None:
    """Numbers do not matter: on the right the second one is outside here."""
    proposed = propose_map(_renamed(LOWER))
    assert proposed.markers["left_knee"] == ("LKNE",)
    assert proposed.markers["right_knee"] == ("RKNE_2",)
    assert proposed.markers["right_inner_knee"] == ("RKNE",)
    assert proposed.has_legs()


def test_two_knees_of_a_set_that_numbers_them_are_its_sides() -> None:
    names = LOWER | {
        "left_knee": "LKNE1",
        "left_inner_knee": "LKNE2",
        "right_knee": "RKNE2",
        "right_inner_knee": "RKNE1",
    }
    proposed = propose_map(_renamed(names))
    assert proposed.markers["left_inner_knee"] == ("LKNE2",)
    assert proposed.markers["right_knee"] == ("RKNE2",)


def test_letters_of_gauche_and_droit_name_the_sides_of_a_whole_set() -> None:
    french = {
        "front_hip": "EAS", "back_hip": "EPS", "knee": "CL", "inner_knee": "CM", "ankle": "ML", "inner_ankle": "MM",
        "heel": "CAL", "shoulder": "ACR", "elbow": "COU", "wrist": "RAD", "outer_wrist": "ULN",
    }  # fmt: skip
    names = {
        f"{side}_{part}": f"{letter}{word}"
        for side, letter in (("left", "G"), ("right", "D"))
        for part, word in french.items()
    }
    proposed = propose_map(_renamed(names))
    assert {role: own[0] for role, own in proposed.markers.items()} == names


def test_initials_stand_for_the_first_place_that_no_other_label_names() -> None:
    """``E`` is an elbow in either set; ``LE`` a knee where none is named, ``A`` an ankle or else an acromion."""
    legs = {f"{side}_front_hip": f"{side[0].upper()}ASI" for side in ("left", "right")}
    latin = legs | {"left_knee": "LLE", "left_inner_knee": "LME", "left_ankle": "LLM", "left_shoulder": "LA"}
    plain = legs | {"left_knee": "LK", "left_ankle": "LA", "left_shoulder": "LS"}
    for names in (latin, plain):
        proposed = propose_map(_renamed(names)).markers
        assert {role: own for role, (own, *_) in proposed.items()} == names


@pytest.mark.parametrize(("ankle", "foot"), [("ankle", "toe"), ("", "ankle")])
def test_the_only_point_of_a_foot_in_a_set_of_joints_is_its_ankle_or_else_its_toe(ankle: str, foot: str) -> None:
    """Human3.6M has hip, knee and foot; SMPL has an ankle and a foot."""
    _, joints = made_body()
    tracks = {(side, part): joints[f"{side}_{part}"] for side in ("left", "right") for part in ("hip", "knee", "ankle")}
    names = {"hip": "Hip", "knee": "Knee", "ankle": "Ankle" if ankle else "Foot"}
    labelled = {f"{side[0].upper()}_{names[part]}": track for (side, part), track in tracks.items()}
    if ankle:
        labelled |= {
            f"{side[0].upper()}_Foot": tracks[side, "ankle"] + [0.13, 0.0, -0.06] for side in ("left", "right")
        }
    points = 1000.0 * np.stack(list(labelled.values()), axis=1)
    kinds, seen = ("marker",) * len(labelled), np.zeros(points.shape[:2])
    proposed = propose_map(Trial("t", "t", tuple(labelled), kinds, points, seen, 100.0, 1, "mm"))
    assert (proposed.markers if foot == "toe" else proposed.centres)[f"left_{foot}"] in ("L_Foot", ("L_Foot",))


def test_a_sacrum_marker_is_both_backs_of_the_pelvis() -> None:
    proposed = propose_map(_renamed(LOWER))
    assert proposed.markers["left_back_hip"] == proposed.markers["right_back_hip"] == ("VSAC",)


def test_four_markers_round_a_pelvis_are_its_corners(captures) -> None:
    """Checked by hand: in this take the body looks along +y, its left is -x."""
    trial = read_c3d(captures / "c3d" / "sample01_Eb015pi.c3d").trial
    markers = propose_map(trial).markers
    at = {label: np.nanmean(trial.track(label), axis=0) for label in ("PV1", "PV2", "PV3", "pv4")}
    assert markers["right_front_hip"] == ("PV2",)
    assert markers["left_back_hip"] == ("PV3",)
    assert at["PV2"][1] > at["PV1"][1]
    assert len(markers["left_thigh"]) == 4


def test_labels_without_words_give_nothing(captures) -> None:
    trial = read_c3d(captures / "c3d" / "sample15_FP1_metres.c3d").trial
    assert not propose_map(trial).markers


# Subjects are told from labels, whatever sign stands between them and their markers.


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
