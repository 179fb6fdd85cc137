"""The menu of scenes: one is made, shown, and says what to look for."""

from PySide6.QtTest import QTest

from studio.app.application import import_views, show_views
from studio.core.constraints.follow import FollowProp
from studio.document.obstacles import obstacles_of
from studio.library.scenes import SCENES
from tests.patience import PATIENCE, SECONDS


def test_the_fight_opens_from_the_menu_with_its_eight_fighters_and_their_clips(window, qtbot):
    said = []
    window.bench.message_posted.connect(lambda message: said.append(message.sentence))
    window.actions_by_id.by_id["scene_fight_training"].trigger()
    document, live = window.bench.document, window.bench.live
    qtbot.waitUntil(lambda: len(document.project.performers) == 8, timeout=PATIENCE)
    document.playhead.pause()
    assert any("forearm" in text for text in said)
    assert document.playhead.frame_rate == 60.0
    assert document.playhead.last > 300
    assert live.wait_until_solved(SECONDS)
    assert all(live.result(key) is not None for key in document.project.performers)
    document.playhead.set_time(2.03)
    import_views()
    show_views(window)
    qtbot.waitUntil(lambda: len(window.bench.viewport.posed) == 8, timeout=PATIENCE)
    QTest.qWait(300)


def test_the_areas_of_the_scene_with_tables_stay_tables_of_any_size():
    project = next(scene for scene in SCENES if scene.title == "Wrists above a table").make()
    for prop_id, table in project.props.items():
        (area,) = obstacles_of(project, prop_id).values()
        assert (area.centre, area.size) == (FollowProp(prop_id), table.size)
