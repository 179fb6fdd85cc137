"""Bundled scenes, made by the program from its own captures: each is a project with a text about it."""

from dataclasses import dataclass
from importlib import import_module
from pathlib import Path

from studio.core.stage.project import Project
from studio.resources_folder import resources_folder


@dataclass(frozen=True)
class BundledScene:
    """Scene that the program makes when the user asks for it."""

    title: str
    text: str
    """Description for the user."""
    maker: str
    """Module in this package and function that make the project."""
    tags: tuple[str, ...]

    @property
    def key(self) -> str:
        """Name of the scene's action and picture."""
        return self.maker.partition(".")[2]

    @property
    def picture(self) -> Path:
        """Path of the PNG picture of the scene's stage (made by ``examples/make_scene_pictures.py``)."""
        return resources_folder() / "scenes" / f"{self.key}.png"

    def make(self) -> Project:
        """Make the project. Raises StudioError if a bundled file cannot be read."""
        module, _, function = self.maker.partition(".")
        made: Project = getattr(import_module(f"{__name__}.{module}"), function)()
        return made


SCENES = (
    BundledScene(
        "Fight training",
        "Eight fighters of different bodies train in pairs with three motions: rest, kick, and ward off with a"
        " counter-punch. At 2.0 s each kick is met by the middle of a forearm; at 3.0 s each fist meets the other's"
        " head, which leans back. Change a body, or move a fighter: forearm and fist find ankle and head again. Played"
        " live they keep their distance, and X lets all in white kick.",
        "fight.fight_training",
        ("fight", "live"),
    ),
    BundledScene(
        "One walk on five bodies",
        "All walk the same way: steps are as long as legs allow, and no foot slides.",
        "papers.five_bodies",
        ("walk",),
    ),
    BundledScene(
        "Wrists above a table",
        "Three bodies reach over a table each: wrists, forearms, elbows and trunk stay out of it. Select a table and"
        " change its height or move it: they still do.",
        "papers.table",
        ("area",),
    ),
    BundledScene(
        "Reach with balance",
        "Both reach for the same place beside them. One keeps its centre of mass over its feet and moves its hips back;"
        " the other leans where it would fall.",
        "papers.balance",
        ("reach", "balance"),
    ),
    BundledScene(
        "Wrist before elbow",
        "The wrist is where it is to be on both. The first body's elbow nearly gets there too, the other's comes as"
        " near as the wrist lets it. Swap the priorities to see the elbow first.",
        "papers.wrist_before_elbow",
        ("reach", "priority"),
    ),
    BundledScene(
        "One carry, three boxes",
        "One walk on three bodies, each with a box of another size between its hands, from a hand's breadth to broader"
        " than its shoulders. Select a box and change its size: the wrists stay on its sides.",
        "carrying.three_boxes",
        ("walk", "prop"),
    ),
    BundledScene(
        "Walk on a slope",
        "Feet lie on the slope and stay where they stand. Change the angle while it plays.",
        "papers.slope",
        ("walk", "ground"),
    ),
    BundledScene(
        "Walk on steps",
        "Five bodies walk up low steps and turn on them: feet stand on the treads. Change rise and"
        " tread while it plays.",
        "changing.steps",
        ("walk", "ground"),
    ),
    BundledScene(
        "A clap",
        "Hands of short, usual and long arms meet at the same moments: at 0.5, 1.0 and 1.5 s. Change the length of an"
        " arm: they meet all the same.",
        "changing.clap",
        ("hands",),
    ),
    BundledScene(
        "Handstand and cartwheel",
        "Five bodies stand on their hands, then wheel to their left: hands stay where they stand, as feet do, arms of"
        " any length carry, and the hips rise as high as arms let them. Change the length of an arm while it plays.",
        "acrobatics.handstand_and_cartwheel",
        ("hands", "acrobatics"),
    ),
    BundledScene(
        "Bodies that grow and shrink",
        "One grows and one shrinks while they walk: from 1 to 7 s. Steps change with their legs, and no foot slides.",
        "changing.growing",
        ("walk", "proportions"),
    ),
    BundledScene(
        "One target, three strikes",
        "Three bodies stand on guard with a ball at the same place before each: 70 cm ahead, 110 cm high. The library"
        " of strikes is searched for each body, and each is found another one: the child strikes up at it, the woman"
        " jabs, the giant kicks. All hit; drag a ball, and its strike follows.",
        "choosing.one_target",
        ("fight", "search"),
    ),
    BundledScene(
        "Sparring",
        "Two fighters behave while the stage plays live: they step to keep their distance; X and C let the first one"
        " punch low and high, N and M the second. A forearm meets a low punch, a head leans away from a high one. Move"
        " a fighter while it plays: the other follows. Their states are in the Behaviour panel (Shift+B).",
        "sparring.sparring",
        ("fight", "live", "behaviour"),
    ),
)
