"""Closed-loop inverse kinematics written by hand over Pinocchio: one damped, weighted least-squares step a turn."""

import numpy as np
import pinocchio as pin
from common import Problem, main

TURNS = 60
DAMPING = 1e-4
HELD = 100.0
"""Weight of feet and balance beside a wish of priority 0; each further priority counts a hundredth."""
LONGEST = 0.3
"""Metres of error answered in one turn."""
REACHED = 1e-4


class Clik:
    """The skeleton as a free-flying root with ball joints."""

    def __init__(self, problem: Problem) -> None:
        self.problem, self.model = problem, pin.Model()
        self.joints: list[int] = []
        for joint, (name, parent) in enumerate(zip(problem.names, problem.parents, strict=True)):
            kind = pin.JointModelFreeFlyer() if parent < 0 else pin.JointModelSpherical()
            placement = pin.SE3(np.eye(3), problem.offsets[joint] if parent >= 0 else np.zeros(3))
            self.joints.append(self.model.addJoint(self.joints[parent] if parent >= 0 else 0, kind, placement, name))
        for (start, end), share, along in zip(
            problem.mass_joints, problem.mass_shares, problem.mass_places, strict=True
        ):
            lever = along * problem.offsets[end] if problem.parents[end] == start else np.zeros(3)
            body = pin.Inertia(max(float(share), 1e-9), lever, 1e-6 * np.eye(3))
            self.model.appendBodyToJoint(self.joints[start], body, pin.SE3.Identity())
        self.data = self.model.createData()
        self.columns = self._free_columns()

    def _free_columns(self) -> np.ndarray:
        columns = [0, 1, 2] if self.problem.root_is_free else []
        for joint, index in enumerate(self.joints):
            if self.problem.free[joint]:
                first = self.model.joints[index].idx_v
                columns += range(first, first + 3)
        return np.array(columns)

    def places(self) -> np.ndarray:
        return np.array([self.data.oMi[index].translation for index in self.joints])

    def solve(self, frame: int) -> None:
        problem, model, data = self.problem, self.model, self.data
        q = np.concatenate([problem.roots[frame], problem.rotations[frame, 0], problem.rotations[frame, 1:].ravel()])
        pin.forwardKinematics(model, data, q)
        feet = [data.oMi[self.joints[foot]].copy() for foot in problem.feet]
        centre = pin.centerOfMass(model, data, q).copy()
        for _ in range(TURNS):
            pin.computeJointJacobians(model, data, q)
            rows, errors = [], []
            for wish, target, priority in zip(
                problem.wishes, problem.targets[:, frame], problem.priorities, strict=True
            ):
                error = target - data.oMi[self.joints[wish]].translation
                weight = 0.01 ** (priority - problem.priorities.min())
                length = np.linalg.norm(error)
                rows.append(weight * self._jacobian(wish)[:3])
                errors.append(weight * error * min(1.0, LONGEST / max(length, 1e-9)))
            if problem.holds_feet:
                for foot, was in zip(problem.feet, feet, strict=True):
                    now = data.oMi[self.joints[foot]]
                    turn = pin.log3(was.rotation @ now.rotation.T)
                    rows.append(HELD * self._jacobian(foot))
                    errors.append(HELD * np.concatenate([was.translation - now.translation, turn]))
            if problem.balances:
                rows.append(HELD * pin.jacobianCenterOfMass(model, data, q)[:2][:, self.columns])
                errors.append(HELD * (centre - data.com[0])[:2])
            error = np.concatenate(errors)
            if np.abs(error).max() < REACHED:
                break
            matrix = np.concatenate(rows)
            normal = matrix.T @ matrix + DAMPING * np.eye(matrix.shape[1])
            step = np.zeros(model.nv)
            step[self.columns] = np.linalg.solve(normal, matrix.T @ error)
            q = pin.integrate(model, q, step)
            if np.abs(step).max() < 1e-5:
                break
        pin.forwardKinematics(model, data, q)

    def _jacobian(self, joint: int) -> np.ndarray:
        whole = pin.getJointJacobian(self.model, self.data, self.joints[joint], pin.ReferenceFrame.LOCAL_WORLD_ALIGNED)
        return np.asarray(whole[:, self.columns])


main(Clik)
