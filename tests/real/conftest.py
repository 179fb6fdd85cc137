"""Faults that recordings and captures show: each is expected, and fails the run once it is mended."""

from fnmatch import fnmatchcase
from pathlib import Path

import pytest

KNOWN_FAULTS = {
    "test_no_joint_jolts_and_no_foot_slides[accad_female1_B03_Walk1-adult_woman]": "a wrist a metre out of reach "
    "accelerates 3.5 times as sharply as the walk and the target bring, where 3 are allowed",
    "test_cartwheels_and_crawls_hold_on_slopes[get_up-up]": "legs accelerate 5.0 times as sharply as the source's",
    "test_cartwheels_and_crawls_hold_on_slopes[get_up-aside]": "legs accelerate 4.5 times as sharply as the source's",
    "test_cartwheels_and_crawls_hold_on_slopes[cartwheel-up]": "arms accelerate 4.5 times as sharply as the source's",
    "test_cartwheels_and_crawls_hold_on_slopes[cartwheel-aside]": "arms accelerate 3.6 times as sharply",
    "test_on_a_slope_hands_stand_and_lie_along_it_and_do_not_jolt[recorded on all fours-*]": "hands accelerate 3.7 to "
    "4.7 times as sharply as the source's where they land and leave",
    "test_arms_come_out_of_the_body_without_a_pop[dance-giant]": "an arm accelerates 4.3 times as sharply where hands "
    "meet",
    "test_edges_add_at_most_twice_the_peak_of_the_source[walk-child-*]": "balance over a place that the walk is metres "
    "away from begins with 5,500 rad/s2 for 360 of the source",
    "test_a_reach_with_balance_lets_no_joint_jump[punch-*]": "a reach with balance accelerates 5 to 30 times as "
    "sharply as the punch",
    "test_hips_go_up_and_down_as_much[walk]": "hips bob by 21 % more than the actor's, on the actor's own body",
    "test_hips_go_up_and_down_as_much[turn]": "hips bob by 15 % more than the actor's on the giant",
    "test_a_wrist_is_led_along_keys_without_a_jerk[kick-tall_man]": "one of 24 keys is missed by 0.35 mm",
    "test_a_wrist_is_led_along_keys_without_a_jerk[kick-giant]": "one of 24 keys is missed by 0.40 mm",
    "test_a_real_walk_holds_its_feet_on_any_ground[walk]": "upstairs 4.4 % of swinging feet are below the ground for 4",
}
"""Reasons by the name of a test with its parameters."""


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Expect every known fault; a pattern's ``[`` is no wildcard."""
    here = Path(__file__).parent
    for item in items:
        for name, reason in KNOWN_FAULTS.items():
            if item.path.parent == here and fnmatchcase(item.name, name.replace("[", "[[]")):
                item.add_marker(pytest.mark.xfail(strict=True, reason=reason))
