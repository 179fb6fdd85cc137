"""The example captures by name."""

from collections.abc import Callable, Mapping

from .cartwheel import cartwheel
from .front_kick import front_kick
from .handstand import handstand
from .reach_grasp import reach_grasp
from .straight_punch import straight_punch
from .targets import Targets
from .walk_turn import walk_turn

CLIPS: Mapping[str, Callable[[], Targets]] = {
    "walk_turn": walk_turn,
    "reach_grasp": reach_grasp,
    "front_kick": front_kick,
    "straight_punch": straight_punch,
    "handstand": handstand,
    "cartwheel": cartwheel,
}
