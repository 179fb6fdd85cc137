"""mink: differential inverse kinematics as quadratic programmes over a MuJoCo model, solved by daqp."""

import mink
import mujoco
import numpy as np
from common import Problem, main

TURNS = 30
HELD, DAMPING = 100.0, 1e-4
REACHED = 1e-4


class Mink:
    """The skeleton as a free root with ball joints."""

    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        self.configuration = mink.Configuration(mujoco.MjModel.from_xml_string(model_of(problem)))
        model = self.configuration.model
        self.wishes = []
        for wish, priority in zip(problem.wishes, problem.priorities, strict=True):
            cost = 0.01 ** (priority - problem.priorities.min())
            task = mink.FrameTask(problem.names[wish], "body", position_cost=cost, orientation_cost=0.0)
            self.wishes.append(task)
        self.feet = [mink.FrameTask(problem.names[foot], "body", HELD, HELD) for foot in problem.feet]
        self.balance = mink.ComTask(np.array([HELD, HELD, 0.0]))
        tasks = [*self.wishes]
        tasks += self.feet if problem.holds_feet else []
        self.tasks = [*tasks, self.balance] if problem.balances else tasks
        locked = [] if problem.root_is_free else [0, 1, 2]
        locked += [3, 4, 5]
        for joint, free in enumerate(problem.free):
            if not free and problem.parents[joint] >= 0:
                first = model.jnt_dofadr[model.joint(problem.names[joint]).id]
                locked += range(first, first + 3)
        self.constraints = [mink.DofFreezingTask(model, dof_indices=locked)]

    def places(self) -> np.ndarray:
        return np.array([self.configuration.data.body(name).xpos for name in self.problem.names])

    def solve(self, frame: int) -> None:
        problem, configuration = self.problem, self.configuration
        quaternions = problem.rotations[frame][:, [3, 0, 1, 2]]
        configuration.update(np.concatenate([problem.roots[frame], quaternions.ravel()]))
        for foot in self.feet:
            foot.set_target_from_configuration(configuration)
        for task, target in zip(self.wishes, problem.targets[:, frame], strict=True):
            task.set_target(mink.SE3.from_translation(target))
        self.balance.set_target_from_configuration(configuration)
        for _ in range(TURNS):
            velocity = mink.solve_ik(
                configuration, self.tasks, 1.0, "daqp", damping=DAMPING, limits=[], constraints=self.constraints
            )
            configuration.integrate_inplace(velocity, 1.0)
            if np.abs(velocity).max() < REACHED:
                break


def model_of(problem: Problem) -> str:
    """MJCF of the skeleton, with each segment's mass at its place along it."""
    children: dict[int, list[int]] = {}
    for joint, parent in enumerate(problem.parents):
        children.setdefault(parent, []).append(joint)

    def body(joint: int) -> str:
        root = problem.parents[joint] < 0
        place = " ".join(f"{value:.9g}" for value in ([0, 0, 0] if root else problem.offsets[joint]))
        masses = ""
        for (start, end), share, along in zip(
            problem.mass_joints, problem.mass_shares, problem.mass_places, strict=True
        ):
            if start == joint:
                lever = along * problem.offsets[end] if problem.parents[end] == start else np.zeros(3)
                at = " ".join(f"{value:.9g}" for value in lever)
                masses = f'<inertial pos="{at}" mass="{max(share, 1e-6):.9g}" diaginertia="1e-6 1e-6 1e-6"/>'
        kind = "free" if root else "ball"
        own = masses or '<inertial pos="0 0 0" mass="1e-6" diaginertia="1e-6 1e-6 1e-6"/>'
        inner = "".join(body(child) for child in children.get(joint, []))
        name = problem.names[joint]
        return f'<body name="{name}" pos="{place}"><joint name="{name}" type="{kind}"/>{own}{inner}</body>'

    return f"<mujoco><worldbody>{body(0)}</worldbody></mujoco>"


main(Mink)
