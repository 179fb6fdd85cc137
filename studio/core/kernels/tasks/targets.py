"""Goals of all tasks at a frame, and their weights (METHOD 7)."""

from studio.core.kernels.compiling import kernel
from studio.core.kernels.tasks.task_kinds import set_goal
from studio.core.kernels.tasks.task_status import ACTIVE, set_initial_status

LEAST_RELATIVE_WEIGHT = 0.1
"""Least weight of a task relative to the heaviest of its level. A search ends when its weighted errors are small, so a
lighter task would be left before it is within 0.2 mm.
"""


@kernel
def set_goals(least, frame, activations, constraints, problem):
    """Set the goals and weights of all tasks at one frame; True if any task is active.

    Goals lie between the unsolved pose and the targets, by activation. A task whose transitions are blended
    (``kernels.time.activation_blend``) has full activation instead, or none if its activation is below ``least``.
    """
    tasks, weights, acts = problem.tasks, constraints.weights, False
    for c in range(tasks.shape[0]):
        row, activation = tasks[c], activations[c, frame]
        if activation < 1.0 and row.blends:
            activation = 1.0 if activation >= least else 0.0
        row.activation, row.weight = activation, weights[c, frame if weights.shape[1] > 1 else 0]
        set_initial_status(row, activation)
        if activation > 0.0:
            acts = True
            set_goal(c, frame, constraints.targets, problem)
    return acts


@kernel
def update_relative_weights(tasks):
    """Update the weight of each task relative to that of the heaviest active task of its level."""
    for row in tasks:
        heaviest = 0.0
        for other in tasks:
            if other.status == ACTIVE and other.level == row.level:
                heaviest = max(heaviest, other.weight)
        row.relative_weight = max(row.weight / heaviest, LEAST_RELATIVE_WEIGHT) if heaviest > 0.0 else 1.0
