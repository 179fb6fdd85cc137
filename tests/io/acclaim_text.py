"""A pair of ASF and AMC files made in code, with axes that differ from bone to bone."""

import numpy as np

BONES: dict[str, tuple[str, tuple[float, float, float], float, str]] = {
    "lhipjoint": ("root", (0.63, -0.71, 0.3), 2.4, ""),
    "lfemur": ("lhipjoint", (0.34, -0.94, 0.0), 7.0, "rx ry rz"),
    "ltibia": ("lfemur", (0.34, -0.94, 0.0), 7.2, "rx"),
    "lfoot": ("ltibia", (0.1, -0.3, 0.95), 2.1, "rx rz"),
    "ltoes": ("lfoot", (0.0, 0.0, 1.0), 1.1, "rx"),
    "rhipjoint": ("root", (-0.63, -0.71, 0.3), 2.4, ""),
    "rfemur": ("rhipjoint", (-0.34, -0.94, 0.0), 7.0, "rx ry rz"),
    "rtibia": ("rfemur", (-0.34, -0.94, 0.0), 7.2, "rx"),
    "rfoot": ("rtibia", (-0.1, -0.3, 0.95), 2.1, "rx rz"),
    "rtoes": ("rfoot", (0.0, 0.0, 1.0), 1.1, "rx"),
    "lowerback": ("root", (0.0, 1.0, -0.05), 2.0, "rx ry rz"),
    "upperback": ("lowerback", (0.0, 1.0, 0.0), 2.0, "rx ry rz"),
    "thorax": ("upperback", (0.0, 1.0, 0.0), 2.0, "rx ry rz"),
    "lowerneck": ("thorax", (0.0, 1.0, 0.1), 1.6, "rx ry rz"),
    "head": ("lowerneck", (0.0, 1.0, 0.0), 3.0, "rx ry rz"),
    "lclavicle": ("thorax", (0.9, 0.4, 0.0), 3.4, "ry rz"),
    "lhumerus": ("lclavicle", (1.0, 0.0, 0.0), 5.0, "rx ry rz"),
    "lradius": ("lhumerus", (1.0, 0.0, 0.0), 3.4, "rx"),
    "lwrist": ("lradius", (1.0, 0.0, 0.0), 1.7, "ry"),
    "rclavicle": ("thorax", (-0.9, 0.4, 0.0), 3.4, "ry rz"),
    "rhumerus": ("rclavicle", (-1.0, 0.0, 0.0), 5.0, "rx ry rz"),
    "rradius": ("rhumerus", (-1.0, 0.0, 0.0), 3.4, "rx"),
    "rwrist": ("rradius", (-1.0, 0.0, 0.0), 1.7, "ry"),
}
"""Parent, direction, length in units of 1/0.45 inch, channels: a body as those of CMU."""
FRAMES = 20


def axis_of(name: str) -> tuple[list[float], str]:
    """Three angles in degrees, another for each bone, and the order in which they are applied."""
    random = np.random.default_rng(sum(map(ord, name)))
    return random.uniform(-90.0, 90.0, 3).round(3).tolist(), "".join(random.permutation(["X", "Y", "Z"]))


def asf_text() -> str:
    lines = ["# a body", ":version 1.10", ":name made", ":units", "  mass 1.0", "  length 0.45", "  angle deg"]
    lines += [":documentation", "  made for a test", ":root", "  order TX TY TZ RX RY RZ", "  axis XYZ"]
    lines += ["  position 0 0 0", "  orientation 0 0 0", ":bonedata"]
    for number, (name, (_, direction, length, channels)) in enumerate(BONES.items(), 1):
        angles, order = axis_of(name)
        lines += ["  begin", f"    id {number}", f"    name {name}", f"    direction {' '.join(map(str, direction))}"]
        lines += [f"    length {length}", f"    axis {' '.join(map(str, angles))} {order}"]
        if channels:
            lines += [f"    dof {channels}", "    limits (-160.0 20.0)", "           (-70.0 70.0)"]
        lines.append("  end")
    lines += [":hierarchy", "  begin"]
    for parent in dict.fromkeys(parent for parent, *_ in BONES.values()):
        lines.append(f"    {parent} {' '.join(name for name, bone in BONES.items() if bone[0] == parent)}")
    return "\n".join([*lines, "  end", ""])


def motion(frames: int = FRAMES) -> list[dict[str, list[float]]]:
    """Angles in degrees of small, smooth turns, for each frame by bone; the root walks along Z."""
    random = np.random.default_rng(5)
    waves = {name: random.uniform(-15.0, 15.0, len(own[3].split())) for name, own in BONES.items() if own[3]}
    return [
        {"root": [0.0, 17.0, 0.2 * frame, 3.0 * np.sin(0.1 * frame), -4.0 * np.sin(0.1 * frame), 2.0]}
        | {name: (wave * np.sin(0.1 * frame)).tolist() for name, wave in waves.items()}
        for frame in range(frames)
    ]


def amc_text(frames: list[dict[str, list[float]]], keywords: str = ":FULLY-SPECIFIED\n:DEGREES\n") -> str:
    rows = [
        "\n".join(
            [str(number), *(f"{name} {' '.join(f'{value:.8f}' for value in own)}" for name, own in frame.items())]
        )
        for number, frame in enumerate(frames, 1)
    ]
    return f"#!OML:ASF F:\\VICON\\07.ASF\n{keywords}" + "\n".join(rows) + "\n"
