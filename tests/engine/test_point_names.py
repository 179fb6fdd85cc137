from studio.core.body.canonical import BodyLayout, BodyPart
from studio.core.constraints.base import BodyPoint
from studio.engine.point_names import POINT_NAMES, point_words
from studio.panels.constraint_editors.common import point_choices
from studio.viewport.body_points import body_joints


def test_a_point_has_the_same_name_in_viewport_inspector_and_library():
    offered = dict(point_choices())
    for joint in body_joints(BodyLayout(3)):
        assert joint.name == point_words(joint.point)
        assert offered[joint.point.part, joint.point.at_end] == joint.name.capitalize()


def test_no_two_points_share_a_name():
    assert len(set(POINT_NAMES.values())) == len(POINT_NAMES)


def test_a_point_without_a_name_of_its_own_goes_by_its_part():
    assert point_words(BodyPoint(BodyPart.LEFT_SHANK)) == "left lower leg"


def test_a_leg_asks_the_root_and_a_hand_the_trunk_too():
    chains = {joint.name: joint.chain for joint in body_joints(BodyLayout(3))}
    for name in ("left knee", "right ankle", "left ball of foot", "right toes"):
        assert (chains[name].limb, chains[name].clavicle, chains[name].trunk, chains[name].root) == (1.0, 0.0, 0.0, 0.6)
    for name in ("left wrist", "right fingertips"):
        assert (chains[name].limb, chains[name].clavicle, chains[name].trunk, chains[name].root) == (1.0, 1.0, 0.4, 0.2)
