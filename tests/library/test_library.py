"""Folders are indexed into a catalogue, and the library that it makes is searched."""

import shutil
import threading
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from studio.core.body.morphology import Proportions
from studio.library.catalogue import DATABASE_NAME, Catalogue
from studio.library.clip_labels import ClipLabel, HitSegment, Kind, Limb
from studio.library.hit_paths import limb_size
from studio.library.indexing import correct_label, index_folders, labels_without_confirmed
from studio.library.library import POSES_FILE, Library
from studio.library.searching import StrikeQuery, search_strikes

EXAMPLES = Path(__file__).resolve().parents[2] / "examples" / "captures"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    made = tmp_path_factory.mktemp("takes")
    for name in ("straight_punch", "front_kick", "reach_grasp"):
        shutil.copy(EXAMPLES / f"{name}.bvh", made)
    return made


@pytest.fixture(scope="module")
def indexed(folder, tmp_path_factory):
    place = tmp_path_factory.mktemp("catalogue")
    with Catalogue(place) as catalogue:
        index_folders(catalogue, [folder])
    return place


@pytest.fixture
def catalogue(indexed, tmp_path):
    place = tmp_path / "catalogue"
    shutil.copytree(indexed, place)
    with Catalogue(place) as opened:
        yield opened


def asked_of(clip, frame, body, place, **changes):
    motion = clip.take.motion
    pose = replace(motion, channels=motion.channels[frame : frame + 1])
    return StrikeQuery(pose, body, place, **changes)


def test_strikes_are_cut_from_takes_with_limb_kind_hit_and_path(catalogue):
    library = Library.of(catalogue)
    assert [(clip.label.limb, clip.label.kind) for clip in library.clips] == [
        (Limb.RIGHT_LEG, Kind.KICK),
        (Limb.RIGHT_ARM, Kind.PUNCH),
    ]
    assert len(library.actors) == 1
    for clip in library.clips:
        assert clip.path.first <= clip.label.hit <= clip.path.last
        low, high = clip.path.box
        assert (low <= clip.path.places).all()
        assert (clip.path.places <= high).all()


def test_nothing_is_read_again_that_has_not_changed(catalogue, folder):
    report = index_folders(catalogue, [folder])
    assert (report.read, report.kept, report.problems) == (0, 3, {})


def test_a_pose_of_a_clip_with_its_own_target_finds_that_clip_at_that_frame(catalogue):
    library = Library.of(catalogue)
    for clip in library.clips:
        frame = clip.searched_frames[5]
        best = search_strikes(library, asked_of(clip, frame, clip.actor.body, clip.path.places[2]))[0]
        assert (best.clip, best.start, best.hit) == (clip, frame, clip.path.first + 2)
        assert best.posture == pytest.approx(0.0, abs=1e-3)
        assert best.reach == pytest.approx(0.0, abs=1e-3)
        assert best.seconds_to_hit == pytest.approx((best.hit - frame) / 60.0)


def test_a_body_of_half_the_size_finds_the_same_with_a_target_of_half_the_distance(catalogue):
    clip = Library.of(catalogue).clips[1]
    body = Proportions(stature=0.5).applied_to(clip.actor.body)
    assert limb_size(body, Limb.RIGHT_ARM) == pytest.approx(0.5 * limb_size(clip.actor.body, Limb.RIGHT_ARM))
    best = search_strikes(
        Library.of(catalogue), asked_of(clip, clip.searched_frames[5], body, 0.5 * clip.path.places[2])
    )[0]
    assert best.clip.number == clip.number
    assert best.reach == pytest.approx(0.0, abs=1e-3)


def test_only_what_was_asked_for_is_found(catalogue):
    library = Library.of(catalogue)
    clip = library.clips[1]
    ask = [clip, clip.searched_frames[5], clip.actor.body, clip.path.places[2]]
    assert [each.clip.label.kind for each in search_strikes(library, asked_of(*ask, kinds=[Kind.KICK]))] == [Kind.KICK]
    assert search_strikes(library, asked_of(*ask, limbs=[Limb.LEFT_ARM])) == []
    assert search_strikes(library, asked_of(*ask, tags=["no such tag"])) == []
    assert search_strikes(library, asked_of(*ask, in_box=True))[0].clip is clip
    far = [*ask[:3], ask[3] + [9.0, 0.0, 0.0]]
    assert search_strikes(library, asked_of(*far, in_box=True)) == []


def test_copies_of_a_file_are_listed_once_with_the_labels_that_were_given(catalogue, folder, tmp_path):
    copies = tmp_path / "copies"
    shutil.copytree(folder, copies)
    (copies / "front_kick.bvh").rename(copies / "renamed.bvh")
    index_folders(catalogue, [copies])
    assert [clip.take.motion.name for clip in Library.of(catalogue).clips] == ["front_kick", "straight_punch"]
    number = next(clip.number for clip in catalogue.clips() if catalogue.takes()[clip.take].motion.name == "renamed")
    correct_label(catalogue, number, replace(Library.of(catalogue).clips[0].label, tags=("mine",)))
    assert [clip.label.tags for clip in Library.of(catalogue).clips] == [(), ("mine",)]
    shutil.rmtree(copies)
    assert [clip.take.motion.name for clip in Library.of(catalogue).clips] == ["front_kick", "straight_punch"]


def test_a_label_that_somebody_gave_outlasts_a_changed_file(catalogue, folder, tmp_path):
    clip = Library.of(catalogue).clips[0]
    label = replace(clip.label, segment=HitSegment.HEEL, tags=("high",), hit=clip.label.hit - 3)
    correct_label(catalogue, clip.number, label)
    (folder / "front_kick.bvh").touch()
    assert index_folders(catalogue, [folder]).read == 1
    labels = [each.label for each in Library.of(catalogue).clips]
    assert replace(label, confirmed=True) in labels


def test_broken_files_and_folders_that_are_gone_are_told_and_the_rest_serves_on(catalogue, folder, tmp_path):
    broken = tmp_path / "broken"
    broken.mkdir()
    (broken / "half.bvh").write_bytes((EXAMPLES / "walk_turn.bvh").read_bytes()[:300])
    shutil.copy(EXAMPLES / "walk_turn.bvh", broken)
    report = index_folders(catalogue, [broken, tmp_path / "gone"])
    assert set(report.problems) == {str(broken / "half.bvh"), str(tmp_path / "gone")}
    assert report.read == 2
    assert len(Library.of(catalogue).clips) == 2
    shutil.rmtree(broken)
    index_folders(catalogue, [broken])
    assert str(broken / "half.bvh") in catalogue.files()
    broken.mkdir()
    assert index_folders(catalogue, [broken]).forgotten == 2


def test_cancelled_it_keeps_what_was_read(folder, tmp_path):
    told = []

    def twice(share, text):
        told.append(text)
        if len(told) == 3:
            raise InterruptedError

    with Catalogue(tmp_path / "c") as catalogue:
        with pytest.raises(InterruptedError):
            index_folders(catalogue, [folder], twice)
        assert len(catalogue.files()) == 2
        assert index_folders(catalogue, [folder]).read == 1


def test_a_catalogue_that_is_lost_or_damaged_is_made_anew(catalogue, folder):
    place = catalogue.folder
    catalogue.close()
    (place / DATABASE_NAME).write_bytes(b"no database" * 400)
    with Catalogue(place) as again:
        assert "a new one is made" in again.repaired
        assert (place / f"{DATABASE_NAME}.damaged").exists()
        assert index_folders(again, [folder]).read == 3
        assert len(Library.of(again).clips) == 2


def test_a_library_opened_while_another_is_indexing_is_of_one_moment(catalogue, tmp_path, monkeypatch):
    more = tmp_path / "more"
    more.mkdir()
    shutil.copy(EXAMPLES.parent / "strikes" / "cross_low.bvh", more)

    def write():
        with Catalogue(catalogue.folder) as other:
            index_folders(other, [more])

    writing = threading.Thread(target=write)
    takes = catalogue.takes()

    def takes_before_it_wrote():
        catalogue._database.execute("SELECT count(*) FROM takes").fetchone()
        writing.start()
        writing.join(2.0)
        return takes

    monkeypatch.setattr(catalogue, "takes", takes_before_it_wrote)
    assert len(Library.of(catalogue).clips) == 2
    writing.join()
    monkeypatch.undo()
    assert len(Library.of(catalogue).clips) == 3


@pytest.mark.parametrize("damage", [Path.unlink, lambda file: file.write_bytes(file.read_bytes()[:500])])
def test_channels_that_are_lost_are_read_again(catalogue, folder, damage):
    damage(sorted(catalogue.folder.glob("take_*.npy"))[0])
    assert len(Library.of(catalogue).clips) == 1
    assert index_folders(catalogue, [folder]).read == 1
    assert len(Library.of(catalogue).clips) == 2


def test_poses_stay_on_disk_and_are_written_again_when_clips_change(catalogue):
    first = Library.of(catalogue)
    assert first.table.rows.base is not None
    (catalogue.folder / POSES_FILE).unlink()
    assert np.array_equal(Library.of(catalogue).table.rows, first.table.rows)


def test_an_empty_library_finds_nothing(tmp_path, catalogue):
    clip = Library.of(catalogue).clips[0]
    with Catalogue(tmp_path / "empty") as empty:
        library = Library.of(empty)
    assert search_strikes(library, asked_of(clip, 0, clip.actor.body, (0.5, 0.0, 1.0), in_box=True)) == []


def test_a_confirmed_strike_takes_the_place_of_its_own_proposal_and_no_other():
    left = ClipLabel(0, 40, 20, Limb.LEFT_ARM, Kind.PUNCH, HitSegment.FIST)
    right = ClipLabel(10, 50, 32, Limb.RIGHT_ARM, Kind.PUNCH, HitSegment.FIST)
    said = replace(left, hit=23, confirmed=True)
    assert labels_without_confirmed([said], [left, right]) == [right]
    assert labels_without_confirmed([replace(right, limb=Limb.LEFT_ARM)], [right]) == []
    assert labels_without_confirmed([], [left, right]) == [left, right]
