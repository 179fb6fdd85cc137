"""What is to be at a frame: between the unsolved pose and the target, by activation (METHOD 5)."""

from studio.core.kernels.compiling import kernel
from studio.core.kernels.tasks.kinds import begin_goal
from studio.core.kernels.tasks.task import ACTIVE, FREE, INACTIVE

LEAST_WEIGHT = 0.1
"""Part of the heaviest weight of a level that every constraint counts at least: a lighter one would be left off sooner
than within 0.2 mm, for a search ends when its weighted errors are small.
"""


@kernel
def set_goals(least, frame, activations, targets, problem):
    """What is to be at this frame: between the unsolved pose and the target, by activation. False when nothing acts.

    What ``kernels.time.activation_blend`` blends is wholly wanted, or, where its activation is below ``least``, not at
    all.
    """
    tasks, acts = problem.tasks, False
    for c in range(tasks.shape[0]):
        row, share = tasks[c], activations[c, frame]
        if share < 1.0 and row.blends:
            share = 1.0 if share >= least else 0.0
        row.share, row.status, row.pinned = share, ACTIVE if share > 0.0 else INACTIVE, FREE
        if share > 0.0:
            acts = True
            begin_goal(c, frame, targets, problem)
    return acts


@kernel
def weigh(tasks):
    """How much each counts: as a part of the heaviest of its level that acts, so that one alone counts wholly."""
    for row in tasks:
        heaviest = 0.0
        for other in tasks:
            if other.status == ACTIVE and other.rank == row.rank:
                heaviest = max(heaviest, other.weight)
        row.counts = max(row.weight / heaviest, LEAST_WEIGHT) if heaviest > 0.0 else 1.0
