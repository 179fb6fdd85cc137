"""The papers' scenes hold in figures."""

import time
from dataclasses import replace

import numpy as np
import pytest

from studio.core.body.canonical import BodyPart
from studio.core.captures.contacts import ContactPoint
from studio.core.constraints.base import BodyPoint
from studio.core.constraints.follow import FollowPerformer
from studio.core.grounds.ground import Ground
from studio.core.mesh.skin import skin_vertices
from studio.core.quality.metrics import acceleration_ratio, contact_quality
from studio.core.solver.adapt import adapt, body_point_positions
from studio.core.solver.performers.staged_performances import (
    Performance,
    PrepareCapture,
    StagedPerformances,
    adapt_performers,
)
from studio.core.stage.placement import Placement
from studio.core.stage.project import Project
from studio.io.project.character_file import bundled_characters
from studio.jobs.performances import prepared_capture
from studio.library.scenes import SCENES, acrobatics, changing, choosing, fight, papers

FEW = 5
"""Sweeps that a pair of fighters may need."""
HEELS = (ContactPoint.LEFT_HEEL, ContactPoint.RIGHT_HEEL)


def exact(project: Project) -> Project:
    """The same without easing in time, which may cost exactness."""
    changes = [(key, replace(each, eased=False), None) for key, each in project.performers.items()]
    return project.with_entities("performers", changes)


@pytest.fixture(scope="module")
def scene() -> Project:
    return exact(fight.fight_training())


@pytest.fixture(scope="module")
def staged(scene: Project) -> StagedPerformances:
    return adapt_performers(scene, scene.performers, prepared_capture, adapt)


def prepared_already(scene: Project) -> PrepareCapture:
    """Captures whose motions are known."""
    known = {id(each): prepared_capture(each) for each in scene.captures.values()}
    return lambda capture: known[id(capture)]


def on_stage(scene: Project, staged: StagedPerformances, key: str, point: BodyPoint, seconds: float) -> np.ndarray:
    performance: Performance = staged.performances[key]
    frame = round(performance.composite.timing.frame_at(seconds))
    return Placement.of(scene.performers[key]).to_stage(body_point_positions(point, performance.adapted)[frame])


def pairs(scene: Project) -> list[tuple[str, str]]:
    keys = list(scene.performers)
    return list(zip(keys[::2], keys[1::2], strict=True))


def test_eight_fighters_of_different_bodies_share_three_motions(scene: Project) -> None:
    assert len(scene.performers) == 8
    assert len({each.morphology for each in scene.characters.values()}) == 8
    assert len(scene.motions) == 3
    assert len(scene.captures) == 2


def test_forearms_meet_ankles_and_fists_meet_heads(scene: Project, staged: StagedPerformances) -> None:
    assert not staged.failures
    for white, red in pairs(scene):
        forearm = on_stage(scene, staged, red, fight.WARDING_FOREARM_POINT, 2.033)
        assert np.linalg.norm(forearm - on_stage(scene, staged, white, fight.KICKING_ANKLE_POINT, 2.033)) < 1e-3
        fist = on_stage(scene, staged, red, fight.RIGHT_FIST_POINT, 3.0)
        assert np.linalg.norm(fist - on_stage(scene, staged, white, fight.CHIN_POINT, 3.0)) < 1e-3
        assert staged.performances[white].iterations <= FEW


def test_heads_lean_back_from_the_fist(scene: Project, staged: StagedPerformances) -> None:
    for white, _ in pairs(scene):
        adapted = staged.performances[white].adapted
        frame = round(staged.performances[white].composite.timing.frame_at(3.0))
        head = adapted.morphology.layout.head_joint
        assert adapted.unconstrained is not None
        back = adapted.unconstrained.positions[frame, head] - adapted.positions[frame, head]
        assert back[0] > 0.12 * adapted.body.leg_length


def test_no_limb_jolts_by_more_than_three_times_its_own_motion(scene: Project, staged: StagedPerformances) -> None:
    for performance in staged.performances.values():
        alone = adapt(replace(performance.request, constraints=()))
        assert acceleration_ratio(performance.adapted, alone) < 3.0


def test_a_second_of_the_fight_is_solved_in_a_second(scene: Project, staged: StagedPerformances) -> None:
    begun = time.thread_time()
    adapt_performers(scene, scene.performers, prepared_already(scene), adapt)
    length = max(each.composite.timing.end for each in staged.performances.values())
    assert time.thread_time() - begun < length


def test_feet_that_stand_stay_through_all_clips(staged: StagedPerformances) -> None:
    for performance in staged.performances.values():
        quality = contact_quality(performance.adapted, performance.adapted.contacts, Ground())
        assert quality.slide < 1e-3


def test_the_order_of_performers_is_all_the_same(scene: Project, staged: StagedPerformances) -> None:
    turned = replace(scene, performers=dict(reversed(list(scene.performers.items()))))
    again = adapt_performers(turned, turned.performers, prepared_capture, adapt)
    for key, performance in staged.performances.items():
        np.testing.assert_allclose(again.performances[key].adapted.positions, performance.adapted.positions, atol=1e-6)


def test_who_has_lost_its_capture_fails_alone(scene: Project) -> None:
    key = next(iter(scene.performers))
    alone = replace(scene, performers={key: scene.performers[key], "lost": replace(scene.performers[key], clips=())})
    made = adapt_performers(replace(alone, constraints={}), alone.performers, prepared_capture, adapt)
    assert list(made.performances) == [key]
    assert "has no clip" in made.failures["lost"]


HALF_A_HAND = 0.02
"""Metres of flesh about the bones of a hand."""


@pytest.mark.parametrize("index", range(1, len(SCENES)))
def test_every_scene_can_be_played(index: int) -> None:
    project = exact(SCENES[index].make())
    made = adapt_performers(project, project.performers, prepared_capture, adapt)
    assert not made.failures
    assert len(made.performances) == len(project.performers)


def performed(title: str) -> tuple[Project, dict[str, Performance]]:
    project = exact(next(scene for scene in SCENES if scene.title == title).make())
    made = adapt_performers(project, project.performers, prepared_capture, adapt)
    assert not made.failures
    return project, dict(made.performances)


def test_hands_of_arms_of_any_length_meet_at_the_same_moments() -> None:
    project, made = performed("A clap")
    assert len({each.morphology.arm[0, 0] for each in project.characters.values()}) == 3
    for performance in made.values():
        left, right = (body_point_positions(point, performance.adapted) for point in changing.PALM_POINTS)
        apart = np.linalg.norm(left - right, axis=1)
        frame_at = performance.composite.timing.frame_at
        assert all(apart[round(frame_at(second))] < 1e-3 for second in changing.CLAP_SECONDS)
        assert all(apart[round(frame_at(second + 0.25))] > 0.3 for second in changing.CLAP_SECONDS[:-1])


def test_the_same_target_finds_three_bodies_three_strikes_and_all_meet_it() -> None:
    project, made = performed("One target, three strikes")
    chosen = [performer.clips[-1].motion_id for performer in project.performers.values()]
    assert len(set(chosen)) == len(made) == 3
    struck = [project.constraints[f"target {key}"].point for key in project.performers]
    assert {point.part.value.partition("_")[2] for point in struck} == {"hand", "foot"}
    for (key, performer), point in zip(project.performers.items(), struck, strict=True):
        adapted, ball = made[key].adapted, np.array(project.props[f"target {key}"].position)
        standing = Placement.of(performer).to_stage(adapted.positions[60, 0])
        before = (ball - standing)[:2], ball[2]
        np.testing.assert_allclose(np.hstack(before), [choosing.TARGET_AHEAD, 0.0, choosing.TARGET_HEIGHT], atol=0.02)
        way = Placement.of(performer).to_stage(body_point_positions(point, adapted)) - ball
        assert np.linalg.norm(way, axis=1).min() < 1e-3


def test_nobody_slides_on_steps_and_all_come_up() -> None:
    project, made = performed("Walk on steps")
    for key, performance in made.items():
        performer = project.performers[key]
        ground = project.ground.seen_from(performer.position, performer.heading)
        quality = contact_quality(performance.adapted, performance.adapted.contacts, ground)
        assert quality.slide < 2e-3
        heights = performance.adapted.positions[:, performance.adapted.morphology.layout.toe_point(0), 2]
        assert heights.max() > changing.STEP_RISE_METRES


def test_who_grows_and_who_shrinks_keeps_its_feet_where_they_stand() -> None:
    _, made = performed("Bodies that grow and shrink")
    grows, shrinks = (each.adapted for each in made.values())
    for adapted, larger in ((grows, True), (shrinks, False)):
        first, last = (adapted.body.at(frame).stature for frame in (0, adapted.frame_count - 1))
        assert (last > 1.5 * first) if larger else (last < 0.65 * first)
    for performance in made.values():
        heels = [each for each in performance.adapted.contacts if each.point in HEELS]  # toes of a longer foot go on
        assert contact_quality(performance.adapted, heels, Ground()).slide < 2e-3


@pytest.mark.parametrize("height", [0.9, 1.0, 1.1])
def test_whole_arms_and_trunk_stay_out_of_a_table_of_any_height_that_is_seen(height: float) -> None:
    """Forearm and upper arm went 13 cm into it, the hand 15, the trunk 3."""
    scene = exact(papers.table())
    tables = [
        (key, replace(each, size=(*each.size[:2], height), position=(*each.position[:2], height / 2)), None)
        for key, each in scene.props.items()
    ]
    scene = scene.with_entities("props", tables)
    areas = [  # as the form of a prop resizes them with it
        (f"body {key}", replace(scene.constraints[f"body {key}"], size=scene.props[f"table {key}"].size), None)
        for key in scene.performers
    ]
    scene = scene.with_entities("constraints", areas)
    made = adapt_performers(scene, scene.performers, prepared_capture, adapt)
    above = 0
    for key, performance in made.performances.items():
        table, layout = scene.props[f"table {key}"], performance.adapted.morphology.layout
        places = Placement.of(scene.performers[key]).to_stage(performance.adapted.positions)
        bones = [(0, layout.neck_base, 0.0)]
        for wrist in (layout.wrist_point(0), layout.wrist_point(1)):
            bones += [(wrist - 2, wrist - 1, 0.0), (wrist - 1, wrist, 0.0), (wrist, wrist + 1, HALF_A_HAND)]
            over = np.abs(places[:, wrist, :2] - table.position[:2]) < np.array(table.size[:2]) / 2
            above += int(over.all(axis=1).sum())
        for begin, end, soft in bones:
            along = np.linspace(0.0, 1.0, 9)[:, None, None]
            bone = places[:, begin] + along * (places[:, end] - places[:, begin])
            depth = (np.array(table.size) / 2 - np.abs(bone - np.array(table.position))).min(axis=2)
            assert depth.max() < soft + 1e-3
    assert above > 100


@pytest.mark.parametrize("others", [(), ("child", "giant")], ids=["the scene's bodies", "others"])
def test_the_skin_of_arms_and_trunk_stays_out_of_a_table_while_pops_are_smoothed(others: tuple[str, ...]) -> None:
    """The table was up to 37 mm inside a hand and 13 mm inside a forearm."""
    scene = papers.table()
    for key, name in zip(scene.performers, others, strict=False):
        scene = scene.with_entity("characters", name, bundled_characters()[name])
        scene = scene.with_entity("performers", key, replace(scene.performers[key], character_id=name))
    made = adapt_performers(scene, scene.performers, prepared_capture, adapt).performances
    for key, performance in made.items():
        adapted, table = performance.adapted, scene.props[f"table {key}"]
        character, layout = scene.characters[scene.performers[key].character_id], adapted.morphology.layout
        mesh, placement = character.shown_skin, Placement.of(scene.performers[key])
        legs = [
            layout.segment_of_part(part) for part in BodyPart if part.value.endswith(("thigh", "shank", "foot", "toe"))
        ]
        above = ~np.isin(mesh.segments[:, 0], legs)
        for row in range(0, adapted.frame_count, 2):
            pose = adapted.positions[row], adapted.rotations[row]
            skin, _ = skin_vertices(mesh, character.build, adapted.body, *map(np.ascontiguousarray, pose))
            away = np.abs(placement.to_stage(skin[above]) - np.array(table.position)) - np.array(table.size) / 2
            assert away.max(axis=1).min() > -0.005, (key, row)


def test_a_wrist_comes_before_an_elbow_and_balance_costs_no_reach() -> None:
    wrist = exact(SCENES[4].make())
    made = adapt_performers(wrist, wrist.performers, prepared_capture, adapt).performances
    near, far = (each.adapted.residuals[:, papers.FAR_TARGET_FRAME] for each in made.values())
    assert near[0] < 1e-3
    assert far[0] < 1e-3
    assert near[1] < 0.03 < 0.2 < far[1]
    held = exact(SCENES[3].make())
    kept, _ = adapt_performers(held, held.performers, prepared_capture, adapt).performances.values()
    assert np.nanmax(kept.adapted.residuals[0]) < 1e-3


def test_hands_carry_all_bodies_through_a_handstand_and_a_cartwheel_without_a_slip() -> None:
    scene = acrobatics.handstand_and_cartwheel()
    made = adapt_performers(scene, scene.performers, prepared_capture, adapt)
    assert len(made.performances) == 5
    for performance in made.performances.values():
        adapted, contacts = performance.adapted, performance.adapted.contacts
        layout, leg = adapted.morphology.layout, adapted.body.leg_length
        stood = [each for each in contacts if each.point in (ContactPoint.LEFT_HAND, ContactPoint.RIGHT_HAND)]
        assert [each.point.side for each in stood] in ([0, 0, 1, 1], [0, 1, 0, 1])
        for each in stood:
            wrist = adapted.positions[each.first : each.last + 1, layout.wrist_point(each.point.side)]
            assert np.ptp(wrist, axis=0).max() < 1e-3
        quality = contact_quality(adapted, contacts, Ground())
        assert quality.slide < 1e-3
        assert quality.penetration < 1e-3
        upside_down = adapted.positions[round(3.4 * 60)]
        feet, head = upside_down[[layout.ankle_point(0), layout.ankle_point(1)], 2], upside_down[layout.head_joint, 2]
        assert feet.min() > head + 1.0 * leg
        up = adapted.rotations[: 60 * 7, 0, 2, 2]
        assert up.min() < -0.98
        alone = adapt(replace(performance.request, constraints=()))
        assert acceleration_ratio(adapted, alone) == pytest.approx(1.0)


def test_blows_touch_for_one_to_three_frames() -> None:
    """Fists stayed on a head for 13 frames of 60 Hz, kicks on a forearm for 10."""
    scene = exact(fight.fight_training(pairs=1))
    made = adapt_performers(scene, scene.performers, prepared_capture, adapt).performances
    seconds = np.arange(0.0, 4.5, 1.0 / 60.0)

    def path(point: BodyPoint, key: str) -> np.ndarray:
        timing, adapted = made[key].composite.timing, made[key].adapted
        rows = np.rint(timing.frames_at(seconds)).astype(int).clip(0, adapted.frame_count - 1)
        return Placement.of(scene.performers[key]).to_stage(body_point_positions(point, adapted)[rows])

    hits = [each for each in scene.constraints.values() if isinstance(each.target, FollowPerformer)]
    assert len(hits) == 3
    for each in hits:
        apart = path(each.point, each.scope.performer_id) - path(each.target.point, each.target.performer_id)
        assert 1 <= (np.linalg.norm(apart, axis=1) < 0.005).sum() <= 3
