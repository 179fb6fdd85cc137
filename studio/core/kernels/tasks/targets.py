"""What is to be at a frame: between the unsolved pose and the target, by activation (METHOD 5)."""

import math

from studio.core.kernels.algebra.turns import put_turn, turn_in
from studio.core.kernels.algebra.vectors import copy_matrix, copy_point, distance
from studio.core.kernels.compiling import kernel
from studio.core.kernels.search.placing import ease_turn, follow_body
from studio.core.kernels.tasks.areas import put_area
from studio.core.kernels.tasks.balance import centre_of_mass
from studio.core.kernels.tasks.goals import (
    AREA,
    BALANCE,
    DISTANCE,
    LOOK_AT,
    ORIENTATION,
    UPRIGHT,
    ease_goal,
    end_place,
    second_place,
)
from studio.core.kernels.tasks.task import ACTIVE, FREE, INACTIVE
from studio.core.kernels.tasks.upright import begin_upright

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
    tasks, areas, body, pose = problem.tasks, problem.areas, problem.body, problem.start
    places, turns, distances = targets
    acts = False
    for c in range(tasks.shape[0]):
        row, share = tasks[c], activations[c, frame]
        if share < 1.0 and row.blends:
            share = 1.0 if share >= least else 0.0
        row.share, row.status, row.pinned = share, ACTIVE if share > 0.0 else INACTIVE, FREE
        if share <= 0.0:
            continue
        acts = True
        target = places[c, frame if places.shape[1] > 1 else 0]
        if row.kind == ORIENTATION:
            wanted = turns[c, frame if turns.shape[1] > 1 else 0]
            put_turn(ease_turn(turn_in(pose.rotations[row.segments[0]]), turn_in(wanted), share), row.turn)
        elif row.kind == BALANCE:
            copy_point(centre_of_mass(body.shares, pose.positions), row.begin)
            for axis in range(3):
                way = 0.0 if math.isnan(target[axis]) else target[axis] - row.begin[axis]
                row.places[0, axis] = row.begin[axis] + share * way
        elif row.kind == LOOK_AT:
            copy_point(target, row.places[0])
            for axis in range(3):
                row.places[1, axis] = pose.rotations[row.segments[0], axis, 0]
            row.distance = share
        elif row.kind == UPRIGHT:
            begin_upright(row, target, distances[c, frame if distances.shape[1] > 1 else 0], pose)
        elif row.kind == AREA:
            row.distance = share
            copy_matrix(turns[c, frame if turns.shape[1] > 1 else 0], row.turn)
            put_area(areas[c], target, row.turn)
        elif row.kind == DISTANCE:
            copy_point(target, row.places[1])
            now = distance(end_place(row, 0, pose), second_place(row, pose))
            row.distance = now + share * (distances[c, frame if distances.shape[1] > 1 else 0] - now)
        else:
            copy_point(ease_goal(end_place(row, 0, pose), target, share), row.places[0])
        if row.kind != DISTANCE and row.points[1] >= 0:
            follow_body(row, areas[c], pose, problem)
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
