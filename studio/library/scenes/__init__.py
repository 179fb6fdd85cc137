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
        "Eight fighters with different proportions train in pairs with three motions: rest, kick, and block with a"
        " counter-punch. At 2.0 s a forearm blocks each kick; at 3.0 s each fist meets the partner's head, which leans"
        " back. Change proportions or move a fighter: the hits are adapted. In live play the fighters keep their"
        " distance, and X makes the white fighters kick.",
        "fight.fight_training",
        ("fight", "live"),
    ),
    BundledScene(
        "One walk on five bodies",
        "One motion on five characters: steps scale with the legs, and no foot slides.",
        "papers.five_bodies",
        ("walk",),
    ),
    BundledScene(
        "Wrists above a table",
        "Three characters each reach over a table: wrists, forearms, elbows and torso stay out of it. Select a table,"
        " change its height or move it: the motion is adapted.",
        "papers.table",
        ("area",),
    ),
    BundledScene(
        "Reach with balance",
        "Both characters reach for the same position beside them. One has a balance constraint and shifts its hips"
        " back; the other leans so far that it would fall.",
        "papers.balance",
        ("reach", "balance"),
    ),
    BundledScene(
        "Wrist before elbow",
        "Both wrists reach their targets. The elbow has lower priority: it nearly reaches its target on the first"
        " character, and comes as near as the wrist allows on the second. Swap the priorities to put the elbow first.",
        "papers.wrist_before_elbow",
        ("reach", "priority"),
    ),
    BundledScene(
        "One carry, three boxes",
        "One walk on three characters, each with a box of a different size in its hands, from narrow to wider than the"
        " shoulders. Select a box and change its size: the hands stay on its sides.",
        "carrying.three_boxes",
        ("walk", "prop"),
    ),
    BundledScene(
        "Walk on a slope",
        "Feet align to the slope and stay planted. Change the angle during playback.",
        "papers.slope",
        ("walk", "ground"),
    ),
    BundledScene(
        "Walk on steps",
        "Five characters walk up low steps and turn on them, with feet planted on the treads. Change rise and tread"
        " during playback.",
        "changing.steps",
        ("walk", "ground"),
    ),
    BundledScene(
        "A clap",
        "The hands of short, average and long arms meet at the same times: at 0.5, 1.0 and 1.5 s. Change the length of"
        " an arm: the hands still meet.",
        "changing.clap",
        ("hands",),
    ),
    BundledScene(
        "Handstand and cartwheel",
        "Five characters do a handstand, then a cartwheel to the left. Hands stay planted as feet do, and the hips rise"
        " as high as the arms allow. Change the length of an arm during playback.",
        "acrobatics.handstand_and_cartwheel",
        ("hands", "acrobatics"),
    ),
    BundledScene(
        "Bodies that grow and shrink",
        "One character grows and one shrinks from 1 to 7 s of a walk. Steps scale with the legs, and no foot slides.",
        "changing.growing",
        ("walk", "proportions"),
    ),
    BundledScene(
        "One target, three strikes",
        "Three characters stand on guard, each with a ball at the same position: 70 cm ahead, 110 cm high. The library"
        " search finds a different strike for each: the child strikes upwards, the woman jabs, the giant kicks. All"
        " hit; drag a ball, and the strike follows.",
        "choosing.one_target",
        ("fight", "search"),
    ),
    BundledScene(
        "Sparring",
        "Two fighters react in live play: they step to keep their distance. X and C make the first one punch low and"
        " high, N and M the second. A forearm blocks a low punch; the head leans away from a high one. Move a fighter"
        " during play: the other follows. Their states are in the Behaviour panel (Shift+B).",
        "sparring.sparring",
        ("fight", "live", "behaviour"),
    ),
)
