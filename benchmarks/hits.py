"""Figures 7 and 8 of P09 with the bundled strikes: as found, and driven to the target, at the moment of the hit."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from studio.cli.live import guard_of
from studio.core.body.morphology import Morphology
from studio.core.body.sticks import bone_pairs
from studio.core.grounds.ground import Ground
from studio.core.normalized.pieces import MotionPiece
from studio.core.solver.adapt import adapt, solve_constraints
from studio.core.solver.grounding.grounded_motion import ground_motion
from studio.io.project.character_file import bundled_characters
from studio.library.indexing import bundled_library
from studio.library.library import Library
from studio.library.scenes.choosing import FIGHTER_BODIES, MOST_STRIKES_TRIED, TARGET_AHEAD, TARGET_HEIGHT, target_of
from studio.library.searching import Result, search_strikes
from studio.library.striking import Strike, StrikeClip, make_strike, tried_strikes

INK, FOUND, TARGET = "#2F6FB3", "#9AA4AE", "#C8553D"
HELD = 0.5
"""Seconds for which the pose is held that the strike takes over from."""
PLACES = ((0.75, 1.45), (0.85, 1.1), (0.95, 1.3), (0.75, 0.75), (1.0, 0.95), (0.95, 1.15))
"""Metres ahead of the root and above the ground, of the targets of figure 7."""
WIDE, HIGH, PER_METRE = 210, 280, 110
"""Pixels of a body's picture, and of a metre in it."""
ACROSS = np.array([[1.0, 0.0], [0.35, 0.15], [0.0, 1.0]])
"""A body as it is seen from its right and a little above."""


@dataclass(frozen=True, eq=False)
class Shown:
    """A body as the strike was found and as it was driven, both (P, 3), and what it was to hit."""

    title: str
    body: Morphology
    found: NDArray[np.float64]
    driven: NDArray[np.float64]
    target: NDArray[np.float64]


def draw_hits(folder: Path) -> None:
    """Both figures as SVG: strikes on one body, and the same target for three."""
    library, guard = bundled_library(), guard_of(None)
    bodies = {key: character.morphology for key, character in bundled_characters().items()}
    woman = [_shown(library, guard, bodies["adult_woman"], place) for place in PLACES]
    _draw(woman, folder / "retrieval_adapted.svg")
    _draw(
        [_shown(library, guard, bodies[key], (TARGET_AHEAD, TARGET_HEIGHT)) for key in FIGHTER_BODIES],
        folder / "retrieval_bodies.svg",
    )


def _shown(library: Library, guard: MotionPiece, body: Morphology, place: tuple[float, float]) -> Shown:
    last = guard.first + round(HELD * guard.motion.frame_rate)
    asked = target_of(guard.motion, last, body, place)
    x, y, z = np.asarray(asked.place).tolist()

    def made_of(found: Result) -> Strike:
        return make_strike(replace(guard, last=last), last, StrikeClip.of(found), body, (x, y, z))

    def residual_of(found: Result) -> float:
        strike = made_of(found)
        return float(adapt(strike.request(), strike.hit, strike.hit).residuals[0, 0])

    found = tried_strikes(search_strikes(library, asked, MOST_STRIKES_TRIED), residual_of)[0].found
    made = made_of(found)
    standing = ground_motion(made.composite.motion, body, made.composite.contacts, Ground())
    solved = solve_constraints(standing, [made.constraint], made.hit, made.hit)
    missed = f"{found.clip.take.motion.name.replace('_', ' ')}, {1000.0 * solved.residuals[0, 0]:.2f} mm"
    return Shown(missed, body, standing.positions[made.hit], solved.positions[0], np.asarray(asked.place))


def _draw(every: Sequence[Shown], file: Path) -> None:
    bodies = "".join(f'<g transform="translate({WIDE * index})">{_one(one)}</g>' for index, one in enumerate(every))
    size = f'width="{WIDE * len(every)}" height="{HIGH}"'
    style = f"path{{fill:none;stroke-width:4;stroke-linecap:round}}text{{font:13px sans-serif;fill:{FOUND}}}"
    file.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" {size}><style>{style}</style>{bodies}</svg>\n')


def _one(shown: Shown) -> str:
    middle = shown.driven[0] @ ACROSS
    origin = np.array([0.32 * WIDE - PER_METRE * middle[0], HIGH - 30.0])

    def seen(points: NDArray[np.float64]) -> list[list[int]]:
        return np.rint(origin + PER_METRE * (points @ ACROSS) * [1.0, -1.0]).astype(np.int64).reshape(-1, 2).tolist()

    lines = []
    for points, colour in ((shown.found, FOUND), (shown.driven, INK)):
        places, pairs = seen(points), bone_pairs(shown.body.layout).tolist()
        sticks = "".join("M{} {}L{} {}".format(*places[begin], *places[end]) for begin, end in pairs)
        lines.append(f'<path stroke="{colour}" d="{sticks}"/>')
    [(x, y)] = seen(shown.target)
    ball = f'<circle cx="{x}" cy="{y}" r="7" fill="{TARGET}"/>'
    return "".join([*lines, ball, f'<text x="10" y="{HIGH - 5}">{shown.title}</text>'])
