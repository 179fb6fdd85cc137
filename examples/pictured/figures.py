"""Figures of docs/method: drawn from what the kernels and the solver answer, not from memory."""

from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.spatial.transform import Rotation

from pictured.session import example
from studio.core.body.canonical import BodyPart
from studio.core.body.morphology import Morphology
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.constraints.position import PositionConstraint
from studio.core.curves.activation import ActivationCurve, EaseShape, ease
from studio.core.grounds.ground import Ground
from studio.core.grounds.steps import Steps
from studio.core.kernels.algebra.smooth_steps import penetration_correction
from studio.core.kernels.limbs.legs import required_root_lowering
from studio.core.kernels.limbs.limb import SOFT_IK_THRESHOLD, SOLE_SOFT_IK_THRESHOLD, place_limb, soft_extension
from studio.core.kernels.limits.limb_joint_limits import soft_clamp_above
from studio.core.kernels.records import LimbShape, Pose
from studio.core.kernels.search.chain_reach import soft_reachable_distance
from studio.core.normalized.transition import remaining_offset_fraction, remaining_speed_offset
from studio.core.quality.metrics import angular_acceleration
from studio.core.solver.adapt import solve_constraints
from studio.core.solver.grounding.grounded_motion import ground_motion
from studio.core.solver.grounding.support_polygon import corners, mass_path, standing_mask, support_polygons
from studio.core.windows import sliding_maximum
from studio.io.importing import GUESS_ALL
from studio.io.project.character_file import bundled_characters
from studio.jobs.adaptation import ADAPTED_MOTION_ID, ReadyCapture, ready_capture

BLUE, RED, GREEN, GREY, INK = "#2F6FB3", "#C8553D", "#4B8B3B", "#9AA4AE", "#22272E"
mpl.rcParams.update({"svg.hashsalt": "morpho-studio", "font.size": 9, "svg.fonttype": "none"})


def limb_frame() -> Figure:
    """An arm in its own frame, from the side and along the line from shoulder to wrist."""
    upper, lower, distance, aside = 0.30, 0.26, 0.47, 0.06
    pose = Pose(np.zeros((3, 3)), np.empty((2, 3, 3)))
    place_limb(0, 0, tuple(np.eye(3).ravel()), LimbShape((upper, lower), distance, aside, 1.0, (0.0, 0.0)), pose)
    (x, y, z), radius = pose.positions[1], float(np.hypot(pose.positions[1, 0], pose.positions[1, 1]))
    figure = Figure(figsize=(9.0, 3.4), layout="constrained")
    side, front = figure.subplots(1, 2, width_ratios=[1.6, 1.0])
    side.plot([0, z, distance], [0, radius, 0], color=INK, linewidth=3, marker="o")
    side.plot([0, distance], [0, 0], color=GREY, linestyle="--")
    side.plot([z, z], [0, radius], color=BLUE)
    _say(side, (0, 0), "R  shoulder, hip", (-8, -16))
    _say(side, (z, radius), "elbow, knee", (-20, 8))
    _say(side, (distance, 0), "E  wrist, ankle", (8, -4))
    _say(side, (z / 2, radius / 2), "L1", (-16, 4))
    _say(side, ((z + distance) / 2, radius / 2), "L2", (6, 4))
    _say(side, (z / 2, 0), "z", (0, 4))
    _say(side, (z, radius / 2), "ρ", (4, -4), BLUE)
    _say(side, (0.45 * distance, 0), "D = (1 - slack) (L1 + L2)", (-30, -16))
    circle = np.linspace(0.0, 2.0 * np.pi, 100)
    front.plot(radius * np.cos(circle), radius * np.sin(circle), color=GREY, linestyle="--")
    front.plot([0, x], [0, y], color=INK, linewidth=3, marker="o")
    front.plot([x, x], [0, y], color=BLUE)
    front.plot([0, x], [0, 0], color=RED, linewidth=2)
    for way, name in (((1, 0), "x  hinge"), ((0, 1), "y  side of the bend")):
        end = 0.22 * way[0], 0.22 * way[1]
        front.annotate("", end, (0, 0), arrowprops={"arrowstyle": "->", "color": GREY})
        _say(front, end, name, (-10 * way[0], 5), GREY)
    front.set(xlim=(-0.17, 0.3), ylim=(-0.17, 0.25))
    _say(front, (x / 2, 0), "x: off-plane", (-18, -14), RED)
    _say(front, (x, y / 2), "y = ± √(ρ² - x²)", (54, -2), BLUE)
    for axes, title in ((side, "from the side"), (front, "along z, from the root joint")):
        axes.set_title(title, color=GREY)
        axes.set_aspect("equal")
        axes.axis("off")
    side.margins(x=0.2, y=0.15)
    return figure


def reach_sharing() -> Figure:
    """Extension of a limb when more is asked, and speed at which its elbow opens then."""
    asked = np.linspace(0.85, 1.2, 1400)
    figure = Figure(figsize=(9.0, 3.2), layout="constrained")
    left, right = figure.subplots(1, 2)
    hard = np.minimum(asked, 1.0)
    left.plot(asked, hard, color=GREY, linestyle="--", label="as far as it goes")
    right.plot(asked[1:], np.diff(_opening(hard)) / np.diff(asked), color=GREY, linestyle="--")
    for comfort, colour, who in (
        (SOFT_IK_THRESHOLD, RED, "leg in the air"),
        (SOLE_SOFT_IK_THRESHOLD, BLUE, "leg that stands"),
    ):
        soft = np.array([soft_extension(each, comfort) for each in asked])
        left.plot(asked, soft, color=colour, label=f"{who}, a = {comfort}")
        right.plot(asked[1:], np.diff(_opening(soft)) / np.diff(asked), color=colour)
    left.set(xlabel="asked, parts of the limb's length", ylabel="stretched to", ylim=(0.85, 1.02))
    right.set(xlabel="asked", ylabel="opening of the middle joint, rad per length", ylim=(0, 25))
    left.legend(frameon=False, loc="lower right")
    return _tidied(figure)


def activation() -> Figure:
    """The three eases, their second derivatives, and what ramps of different length do to an arm moved by 30 cm."""
    t = np.linspace(0.0, 1.0, 400)
    figure = Figure(figsize=(9.0, 3.2), layout="constrained")
    shapes, curvatures, peaks = figure.subplots(1, 3)
    for shape, colour in zip(EaseShape, (GREY, GREEN, BLUE), strict=True):
        values = ease(t, shape)
        shapes.plot(t, values, color=colour, label=shape.value)
        curvatures.plot(t, np.gradient(np.gradient(values, t), t), color=colour)
        ramps = (0.05, 0.1, 0.2, 0.3, 0.5)
        peaks.plot(ramps, [_ramp_acceleration(ramp, shape) for ramp in ramps], "o-", color=colour, markersize=3)
    shapes.set(xlabel="share of the ramp", ylabel="activation")
    curvatures.set(xlabel="share of the ramp", ylabel="second derivative", ylim=(-12, 12))
    peaks.set(xlabel="ramp, s", ylabel="peak of the arm, rad/s²", yscale="log")
    shapes.legend(frameon=False)
    return _tidied(figure)


def canonical_body() -> Figure:
    """Segments of the canonical body, standing, from the front."""
    ready, body = _walk()
    standing = ground_motion(ready.motion, body, ready.contacts, Ground())
    points, layout = standing.positions[0] - standing.positions[0, 0], body.layout
    figure = Figure(figsize=(9.0, 5.0), layout="constrained")
    axes = figure.subplots()
    heading = Rotation.from_euler("z", -float(ready.motion.channels[0, 3]))
    flat = heading.apply(points)[:, 1:]  # left and up

    def chain(first: int, count: int, colour: str) -> None:
        axes.plot(*flat[first : first + count].T, color=colour, linewidth=3, marker="o", markersize=4)

    chain(0, layout.neck_base + 1, INK)
    chain(layout.neck_base, 3, GREEN)
    for side, colour in ((0, BLUE), (1, RED)):
        chain(layout.collar_point(side), 5, colour)
        chain(layout.hip_point(side), 5, colour)
    for name, first, aside in (
        ("clavicle", layout.collar_point(0), (8, 10)),
        ("upper arm", layout.collar_point(0) + 1, (12, 0)),
        ("forearm", layout.collar_point(0) + 2, (12, 0)),
        ("hand", layout.collar_point(0) + 3, (12, 0)),
        ("thigh", layout.hip_point(0), (12, -14)),
        ("shank", layout.hip_point(0) + 1, (12, 0)),
        ("foot and toe", layout.hip_point(0) + 2, (14, -10)),
    ):
        middle = flat[first : first + 2].mean(axis=0)
        _say(axes, (float(middle[0]), float(middle[1])), name, aside, BLUE)
    for name, place in (
        ("pelvis", 0),
        ("thorax", layout.neck_base - 1),
        ("neck", layout.neck_base),
        ("head", layout.head_joint),
    ):
        middle = flat[place : place + 2].mean(axis=0)
        _say(axes, (float(middle[0]), float(middle[1])), name, (6, -14 if name == "thorax" else -3), INK)
    _say(axes, (float(flat[:, 0].max()), float(flat[:, 1].max())), "side 0, left", (20, 0), BLUE)
    _say(axes, (float(flat[:, 0].min()), float(flat[:, 1].max())), "side 1, right", (-60, 0), RED)
    axes.set_aspect("equal")
    axes.margins(x=0.6)
    axes.axis("off")
    return figure


def offset_decay() -> Figure:
    """Way in which an offset and a speed die away in a transition of 0.4 s."""
    times, figure = np.linspace(0.0, 0.5, 300), Figure(figsize=(9.0, 2.8), layout="constrained")
    left, right = figure.subplots(1, 2)
    left.plot(times, remaining_offset_fraction(times, 0.4), color=BLUE)
    left.set(xlabel="time, s", ylabel="part of the offset that is left")
    right.plot(times, remaining_speed_offset(times, 0.4), color=RED)
    right.set(xlabel="time, s", ylabel="offset by a speed of 1 a second")
    return _tidied(figure)


def foot_clearance() -> Figure:
    """Lift of a foot by its height over the ground, for a room of 2 cm."""
    heights, margin = np.linspace(-0.04, 0.04, 300), 0.02
    lifts = np.array([penetration_correction(each, margin) for each in heights])
    figure = Figure(figsize=(9.0, 2.8), layout="constrained")
    axes = figure.subplots()
    axes.plot(100 * heights, 100 * heights, color=GREY, linestyle="--", label="height in the motion")
    axes.plot(100 * heights, 100 * (heights + lifts), color=BLUE, label="height as shown")
    axes.fill_between(100 * heights, -4, 0, color=GREY, alpha=0.2)
    axes.set(xlabel="height of the foot in the motion, cm", ylabel="cm")
    axes.legend(frameon=False)
    return _tidied(figure)


def soft_limit() -> Figure:
    """Joint angle after its limit: where the motion stays within, and where it goes beyond by itself."""
    asked = np.linspace(0.0, 2.0, 300)
    figure = Figure(figsize=(9.0, 2.8), layout="constrained")
    axes = figure.subplots()
    axes.plot(asked, asked, color=GREY, linestyle="--", label="asked for")
    for own, colour in ((0.5, BLUE), (1.2, RED)):
        shown = [soft_clamp_above(each, own, 0.95, 1.0) for each in asked]
        axes.plot(asked, shown, color=colour, label=f"the motion itself is at {own:g} of the limit")
    axes.set(xlabel="angle asked for, parts of the limit", ylabel="angle taken", ylim=(0, 1.6))
    axes.legend(frameon=False, loc="upper left")
    return _tidied(figure)


def reachability() -> Figure:
    """Distance asked of joints that together reach half a metre."""
    asked = np.linspace(0.0, 1.0, 200)
    figure = Figure(figsize=(9.0, 2.8), layout="constrained")
    axes = figure.subplots()
    axes.plot(asked, asked, color=GREY, linestyle="--", label="way to the target")
    axes.plot(
        asked, [soft_reachable_distance(each, 0.5) for each in asked], color=BLUE, label="way asked of the joints"
    )
    axes.axhline(0.5, color=RED, linewidth=1, label="E, as far as they reach")
    axes.set(xlabel="distance from the target, m", ylabel="m")
    axes.legend(frameon=False, loc="upper left")
    return _tidied(figure)


def balance() -> Figure:
    """Centre of mass of a walk from above, and the outlines of the standing soles it is held over."""
    ready, body = _walk()
    standing = ground_motion(ready.motion, body, ready.contacts, Ground())
    positions, rotations = np.array(standing.positions), np.array(standing.rotations)
    frames = slice(60, 260)
    masses = mass_path(positions, body)[frames]
    areas = corners(support_polygons(positions, rotations, standing_mask(ready.contacts, len(positions)), body))[frames]
    figure = Figure(figsize=(9.0, 3.0), layout="constrained")
    axes = figure.subplots()
    for outline in areas[::20]:
        axes.fill(*outline.T, color=BLUE, alpha=0.12)
    axes.plot(masses[:, 0], masses[:, 1], color=RED, label="centre of mass")
    axes.fill([], [], color=BLUE, alpha=0.3, label="support of the soles, every 20th frame")
    axes.set(xlabel="x, m", ylabel="y, m", aspect="equal")
    axes.legend(frameon=False, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2)
    return _tidied(figure)


def smoothing() -> Figure:
    """Averaging by a bump around a peak: a step of one frame, how far each frame is averaged, and what is left."""
    rate, width = 60.0, 0.2
    times = np.arange(-36, 37) / rate
    track = np.where(times < 0.0, 0.0, 1.0)
    half = round(width * rate)
    hann = np.hanning(2 * half + 3)[1:-1] / np.hanning(2 * half + 3).sum()
    peak = sliding_maximum(np.abs(times) < 0.5 / rate, half).astype(np.float64)
    bump = np.convolve(np.pad(peak, half), hann, mode="valid")
    mean = np.convolve(np.pad(track, half, mode="edge"), hann, mode="valid")
    figure = Figure(figsize=(9.0, 2.8), layout="constrained")
    axes = figure.subplots()
    axes.plot(times, track, color=GREY, linestyle="--", label="solved frame by frame")
    axes.plot(times, bump, color=GREEN, label="bump b around the peak")
    axes.plot(times, track + bump * (mean - track), color=BLUE, label="averaged by b")
    axes.set(xlabel="time, s")
    axes.legend(frameon=False, loc="upper left")
    return _tidied(figure)


def footprints() -> Figure:
    """A walk up a flight of steps: ankles, contacts, and how the root comes down for them."""
    ready, body = _walk()
    straight = ready.motion.channels[:240]
    ground = Steps(rise=0.17, tread=0.30, count=4, start=(0.5, 0.0), direction=float(np.median(straight[:, 3])))
    contacts = ready.contacts
    level = ground_motion(ready.motion, body, contacts, Ground())
    standing = ground_motion(ready.motion, body, contacts, ground)
    frames = slice(0, 240)
    time = np.arange(240) / ready.motion.frame_rate
    footing = standing.footing
    figure = Figure(figsize=(9.0, 4.4), layout="constrained")
    feet, root = figure.subplots(2, 1, sharex=True)
    for side, colour, name in ((0, BLUE, "left"), (1, RED, "right")):
        feet.plot(time, footing.ankles[side, frames, 2], color=colour, label=f"{name} ankle")
        stands = footing.states[side, frames] != 0
        feet.fill_between(time, 0, footing.ankles[side, frames, 2], where=stands.tolist(), color=colour, alpha=0.12)
    feet.set(ylabel="height, m")
    feet.legend(frameon=False, loc="upper left")
    climb = standing.positions[frames, 0, 2] - level.positions[frames, 0, 2]
    needed = _literal_drops(ready, body, standing.footing.ankles)[frames]
    root.plot(time, climb, color=INK, label="root above its level walk, as solved")
    root.plot(time, -needed, color=GREY, linestyle="--", label="the plain minimum of three heights")
    root.set(xlabel="time, s", ylabel="m")
    root.legend(frameon=False, loc="upper left")
    return _tidied(figure)


def _literal_drops(ready: ReadyCapture, body: Morphology, ankles: np.ndarray) -> np.ndarray:
    """(F,) metres by which min(h1, h2, h3) lies below the level walk's root (negative where it may rise)."""
    standing = ground_motion(ready.motion, body, (), Ground())
    drops = np.empty(ready.motion.frame_count)
    lift = 0.5 * (ankles[0, :, 2] + ankles[1, :, 2])
    relative = ankles - standing.positions[:, 0]
    relative[..., 2] -= lift
    states = np.full(ankles.shape[:2], 3)
    comforts = np.full(ankles.shape[:2], SOLE_SOFT_IK_THRESHOLD)
    required_root_lowering(
        ready.motion.channels, body.packed[None], standing.rotations, relative, comforts, states, drops
    )
    return np.maximum(drops, 0.0) - lift


def _walk() -> tuple[ReadyCapture, Morphology]:
    return ready_capture(example("walk_turn"), GUESS_ALL), bundled_characters()["adult_woman"].morphology


def _opening(reach: np.ndarray) -> np.ndarray:
    """Angle of the middle joint of a limb of two equal bones, stretched to ``reach`` parts of its length."""
    return np.asarray(2.0 * np.arcsin(np.minimum(reach, 1.0)))


def _ramp_acceleration(ramp: float, shape: EaseShape) -> float:
    """Peak angular acceleration (rad/s^2) of an arm whose wrist is moved by 30 cm within ``ramp`` seconds."""
    ready = ready_capture(example("reach_grasp"), GUESS_ALL)
    body = bundled_characters()["adult_woman"].morphology
    before = ground_motion(ready.motion, body, ready.contacts, Ground())
    middle = ready.motion.duration / 2
    wrist = np.median(before.positions[:, body.layout.wrist_point(0)], axis=0) + np.array([0.1, 0.0, 0.28])
    curve = ActivationCurve(middle - ramp, middle, middle + 0.3, middle + 0.3 + ramp, shape)
    point, place = BodyPoint(BodyPart.LEFT_FOREARM, at_end=True), (float(wrist[0]), float(wrist[1]), float(wrist[2]))
    asked = PositionConstraint(ADAPTED_MOTION_ID, "wrist", point, Chain(clavicle=0.0), 0, curve, target=place)
    after = solve_constraints(before, (asked,))
    arm = slice(body.layout.spine_count + 3, body.layout.spine_count + 5)
    return float(angular_acceleration(after.rotations[:, arm], ready.motion.frame_rate).max())


def _say(axes: Axes, place: tuple[float, float], text: str, aside: tuple[float, float], colour: str = INK) -> None:
    axes.annotate(text, place, aside, textcoords="offset points", color=colour)


def _tidied(figure: Figure) -> Figure:
    for axes in figure.axes:
        axes.spines[["top", "right"]].set_visible(False)
    return figure


def write_figure(path: Path, figure: Figure) -> None:
    """An SVG file that is the same whenever the figure is."""
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, format="svg", metadata={"Date": None})
    print(f"{path.name}: {path.stat().st_size // 1000} kB")


FIGURES = {
    "method_canonical_body": canonical_body,
    "method_offset_decay": offset_decay,
    "method_foot_clearance": foot_clearance,
    "method_soft_limit": soft_limit,
    "method_reachability": reachability,
    "method_balance": balance,
    "method_smoothing": smoothing,
    "method_limb_frame": limb_frame,
    "method_reach_sharing": reach_sharing,
    "method_activation": activation,
    "method_footprints": footprints,
}
