"""A fighter keeps at striking distance of a head that moves, strikes when told, and hits."""

import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from numpy.typing import NDArray

from benchmarks.fighting import IN_REACH, ducking
from examples.keyed.strikes import HIT, STRIKES, Kick
from studio.cli.live import guard_of, rehearse, swaying_head
from studio.cli.main import main
from studio.core.captures.contacts import touching_points
from studio.io.project.character_file import bundled_characters
from studio.library.catalogue import Catalogue
from studio.library.clip_labels import Kind, Limb
from studio.library.indexing import bundled_library, index_folders
from studio.library.library import Library
from studio.library.mirroring import with_mirrored
from studio.live import vmc
from studio.live.fight import ANY_STRIKE, FIGHT_ORDERS, FightReport, fight, orders_every
from studio.live.fighter import Fighter, FighterState
from studio.live.osc import encode_message
from studio.live.recording import write_recording

EXAMPLES = Path(__file__).resolve().parents[2] / "examples" / "captures"
BODIES = {name: character.morphology for name, character in bundled_characters().items()}
GUARD = guard_of(None)


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    with Catalogue(tmp_path_factory.mktemp("library")) as catalogue:
        index_folders(catalogue, [EXAMPLES])
        return with_mirrored(Library.of(catalogue))


@pytest.fixture(scope="module")
def bundled():
    return bundled_library()


def near(body, angle=0.0, height=0.78):
    apart = 1.1 * body.leg_length
    return np.array([apart * np.cos(angle), apart * np.sin(angle), height * body.stature])


def test_a_mirrored_library_has_every_limb(library):
    assert {clip.label.limb for clip in library.clips} == {Limb.RIGHT_ARM, Limb.RIGHT_LEG, Limb.LEFT_ARM, Limb.LEFT_LEG}


@pytest.mark.parametrize("name", ["adult_woman", "giant"])
def test_it_hits_a_moving_head_within_a_millimetre(library, name):
    body = BODIES[name]
    fighter = Fighter(library, body, GUARD)
    report = fight(fighter, lambda now: swaying_head(now, body.stature), orders_every(1.5, [ANY_STRIKE]), 10.0)
    assert len(report.hits) == 6
    assert max(hit.missed for hit in report.hits) < 1e-3


@pytest.mark.parametrize("order", FIGHT_ORDERS)
def test_it_strikes_with_the_limb_that_is_called(library, order):
    body = BODIES["adult_woman"]
    fighter = Fighter(library, body, GUARD)
    height = 0.55 if FIGHT_ORDERS[order][1] == (Kind.KICK,) else 0.78
    fight(fighter, lambda now: near(body, height=height), orders_every(1.0, [FIGHT_ORDERS[order]]), 2.5)
    assert [(hit.limb, hit.kind) for hit in fighter.hits[:1]] == [
        (FIGHT_ORDERS[order][0][0], FIGHT_ORDERS[order][1][0])
    ]


def test_nothing_jumps_and_feet_that_stand_stay(library):
    body = BODIES["adult_woman"]
    fighter, shown, standing = Fighter(library, body, GUARD), [], []

    def show(positions, *_):
        frame = max(fighter.frame - 1, 0)
        shown.append(positions)
        contacts = fighter.plan.standing.contacts
        standing.append(
            {each.point.side for each in contacts if each.point.is_heel and each.first <= frame <= each.last}
        )

    fight(fighter, lambda now: swaying_head(now, body.stature), orders_every(2.0, [ANY_STRIKE]), 8.0, show)
    positions = np.array(shown)
    jerk = np.linalg.norm(np.diff(positions, 2, axis=0), axis=2).max()
    take = next(clip for clip in library.clips if clip.label.limb is Limb.RIGHT_ARM).take
    own = np.linalg.norm(np.diff(Fighter(library, body, GUARD).plan.standing.positions, 2, axis=0), axis=2).max()
    assert jerk < max(0.1, own)
    assert take.motion.frame_rate == fighter.rate
    for side in (0, 1):
        ankle = positions[:, body.layout.ankle_point(side), :2]
        stays = [frame for frame in range(1, len(shown)) if side in standing[frame] & standing[frame - 1]]
        assert np.linalg.norm(ankle[stays] - ankle[np.array(stays) - 1], axis=1).max() < 0.005


FOUGHT_SECONDS = {"child": 60.0, "adult_woman": 26.0, "giant": 26.0}


class Fought(NamedTuple):
    """A fight with a head that ducks."""

    report: FightReport
    frame_seconds: float
    """Processor seconds of a frame in the mean."""
    slides: NDArray[np.float64]
    """Metres that each foot that stands, and stood in the frame before, has gone."""


@pytest.fixture(scope="module")
def fought(bundled):
    """Fight of a body by its name, fought once."""
    return cache(lambda name: _fought(bundled, name))


def _fought(bundled, name):
    body, before, slides = BODIES[name], {}, []
    fighter = Fighter(bundled, body, GUARD)
    rehearse(fighter)

    def show(positions, *_):
        frame = fighter.frame - 1
        now = {
            each.point: positions[touching_points(each.point, body.layout)[0]]
            for each in fighter.plan.standing.contacts
            if each.point.is_foot and each.first <= frame <= each.last
        }
        slides.extend(float(np.linalg.norm((now[point] - before[point])[:2])) for point in now.keys() & before.keys())
        before.clear()
        before.update(now)

    orders = orders_every(1.5, [*FIGHT_ORDERS.values(), ANY_STRIKE])
    begun = time.thread_time()
    report = fight(
        fighter, lambda now: ducking(now, body.stature), orders, FOUGHT_SECONDS[name], show, clock=time.thread_time
    )
    return Fought(report, (time.thread_time() - begun) / report.frames, np.array(slides))


@pytest.mark.parametrize("name", FOUGHT_SECONDS)
def test_feet_that_stand_stay_in_place_as_blows_and_steps_take_over(fought, name):
    """A foot that stood turned by 24 mm, on a giant by 36, within the first frame of every other blow."""
    assert len(fought(name).report.hits) >= 15
    assert np.mean(fought(name).slides > 1e-3) < 0.01  # who is called on while it steps still turns on its heel


def test_who_is_too_far_off_steps_up_before_it_strikes(bundled):
    body = BODIES["child"]
    fighter = Fighter(bundled, body, GUARD)
    place = np.array([2.0 * body.leg_length, 0.0, 0.75 * body.stature])
    assert fighter.strike(place, *FIGHT_ORDERS["left punch"])
    states = []
    while not fighter.hits:
        fighter.step(place)
        states.append(fighter.plan.state)
        assert len(states) < 240
    assert states[0] is FighterState.STEP
    assert fighter.hits[0].missed < 1e-3


def test_a_blow_recorded_at_another_rate_lasts_as_long_as_it_did(bundled):
    fast = [
        replace(clip, take=replace(clip.take, motion=replace(clip.take.motion, frame_rate=120.0)))
        for clip in bundled.clips
    ]
    body = BODIES["adult_woman"]
    fighter = Fighter(Library.of_clips(fast), body, GUARD)
    assert fighter.strike(near(body))
    while not fighter.hits:
        fighter.step(near(body))
    blow = fighter.plan.blow
    assert fighter.hits[0].seconds == pytest.approx(blow.seconds, abs=0.04)


def test_it_follows_a_target_that_walks_away_and_turns_to_it(library):
    body = BODIES["child"]
    fighter = Fighter(library, body, GUARD)
    for frame in range(600):
        place = near(body, 0.0015 * frame) + np.array([0.0012 * frame, 0.0, 0.0])
        positions, _ = fighter.step(place)
    apart = np.linalg.norm(place[:2] - positions[0, :2]) / body.leg_length
    assert apart == pytest.approx(fighter.distance, abs=0.45)
    assert fighter.plan.state in (FighterState.GUARD, FighterState.STEP)


def test_a_frozen_target_can_be_dodged(library):
    body = BODIES["adult_woman"]
    fighter = Fighter(library, body, GUARD, follows=False)
    begun = near(body)
    fighter.strike(begun)
    for frame in range(80):
        fighter.step(begun + np.array([0.0, 0.004 * frame, 0.0]))
    (hit,) = fighter.hits
    assert hit.missed < 1e-3  # it is where the head was


def test_the_character_can_be_changed_while_it_plays(library):
    fighter = Fighter(library, BODIES["adult_woman"], GUARD)
    for frame in range(90):
        if frame == 30:
            fighter.change_body(BODIES["giant"])
        positions, _ = fighter.step(near(BODIES["giant"]))
        assert np.isfinite(positions).all()
    assert fighter.body is BODIES["giant"]


def test_a_character_that_is_changed_while_its_blow_is_made_strikes_as_it_is_then(library):
    with ThreadPoolExecutor(1) as beside:
        fighter = Fighter(library, BODIES["adult_woman"], GUARD, executor=beside)
        fighter.step(near(BODIES["giant"]))
        assert fighter.strike(near(BODIES["giant"]))
        fighter.change_body(BODIES["giant"])
        for _ in range(2000):
            fighter.step(near(BODIES["giant"]))
            assert fighter.plan.standing.morphology is BODIES["giant"]
            if fighter.hits:
                break
    assert fighter.hits[0].missed < 1e-3


def test_what_is_made_beside_the_animation_holds_up_no_frame(library):
    body = BODIES["adult_woman"]
    with ThreadPoolExecutor(1) as beside:
        fighter = Fighter(library, body, GUARD, executor=beside)
        assert fighter.strike(near(body))
        assert not fighter.strike(near(body))
        for _ in range(2000):
            fighter.step(near(body))
            if fighter.hits:
                break
    assert fighter.hits[0].missed < 1e-3


def test_the_verb_fights_a_replayed_head_and_reports(tmp_path, capsys):
    place = str(tmp_path / "library")
    assert main(["index", str(EXAMPLES), "--library", place, "--json"]) == 0
    packets = []
    for frame in range(60):
        unity = [0.1 * np.sin(0.1 * frame), 1.3, 0.95]
        message = encode_message(vmc.TRACKER_ADDRESS, ["marker", *(float(each) for each in unity), 0.0, 0.0, 0.0, 1.0])
        packets.append((frame / 30.0, message))
    write_recording(tmp_path / "head.osc", packets)
    capsys.readouterr()
    asked = ["live", "--library", place, "--fast", "--seconds", "4", "--strike-every", "1.5", "--head", "marker"]
    assert main([*asked, "--replay", str(tmp_path / "head.osc"), "--mirrored"]) == 0
    printed = capsys.readouterr().out
    assert "240 frames, 2 strikes" in printed
    assert "60 packets received, 0 invalid" in printed


def test_ctrl_c_ends_a_fight_with_the_report_of_what_was_fought_until_then(library):
    body = bundled_characters()["child"].morphology
    fighter = Fighter(library, body, guard_of(None))

    def target_until_stopped(now):
        if now >= 0.5:
            raise KeyboardInterrupt
        return near(body)

    report = fight(fighter, target_until_stopped, lambda now: None, 60.0)
    assert report.stopped
    assert report.frames == 0.5 * fighter.rate
    assert report.words.startswith(f"{report.frames} frames, 0 strikes")


@pytest.mark.parametrize("name", ["child", "adult_woman"])
def test_the_bundled_fighter_strikes_again_and_again_at_a_head_that_ducks(fought, name):
    report, minutes = fought(name).report, FOUGHT_SECONDS[name] / 60.0
    assert len(report.hits) >= 35 * minutes
    assert {hit.limb for hit in report.hits} == set(Limb)
    in_reach = [hit.missed for hit in report.hits if hit.apart <= IN_REACH]
    assert len(in_reach) >= 10 * minutes
    assert max(in_reach) < 1e-3
    assert sum(hit.missed < 1e-3 for hit in report.hits) >= 0.95 * len(report.hits)
    # Found in the time of so many frames, however fast the machine is.
    assert max(report.latencies) < 60.0 * fought(name).frame_seconds


def test_the_bundled_strikes_are_of_two_actors_and_every_limb_high_and_low(bundled):
    assert len(bundled.clips) == len(STRIKES) == 14
    statures = sorted(actor.body.stature for actor in bundled.actors)
    assert len(statures) == 2
    assert statures[1] > 1.1 * statures[0]
    for limb in Limb:
        heights = sorted(clip.path.places[:, 2].mean() for clip in bundled.clips if clip.label.limb == limb)
        assert len(heights) >= 3
        assert heights[-1] > heights[0] + 0.3
    keyed = {name: strike.side + (2 if isinstance(strike, Kick) else 0) for name, strike in STRIKES.items()}
    assert {clip.take.motion.name: int(clip.label.limb) for clip in bundled.clips} == keyed
    assert max(abs(clip.label.hit - HIT * 60.0) for clip in bundled.clips) <= 7
