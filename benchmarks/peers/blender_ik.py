"""Blender: its IK constraints on an armature, one update of the scene a frame; the pelvis does not move."""

import bpy
import numpy as np
from common import Problem, main
from mathutils import Quaternion, Vector


class Blender:
    """The skeleton as an armature; every wish is an IK constraint on the bone that ends there."""

    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        bpy.ops.wm.read_factory_settings(use_empty=True)
        self.rest = np.zeros((len(problem.names), 3))
        for joint, parent in enumerate(problem.parents):
            self.rest[joint] = problem.offsets[joint] + (self.rest[parent] if parent >= 0 else 0.0)
        self.ends = {parent: joint for joint, parent in reversed(list(enumerate(problem.parents))) if parent >= 0}
        armature = bpy.data.armatures.new("body")
        self.object = bpy.data.objects.new("body", armature)
        bpy.context.collection.objects.link(self.object)
        bpy.context.view_layer.objects.active = self.object
        bpy.ops.object.mode_set(mode="EDIT")
        for joint, name in enumerate(problem.names):
            if joint in self.ends:
                bone = armature.edit_bones.new(name)
                bone.head, bone.tail = self.rest[joint].tolist(), self.rest[self.ends[joint]].tolist()
                parent = problem.parents[joint]
                bone.parent = armature.edit_bones[problem.names[parent]] if parent >= 0 else None
        bpy.ops.object.mode_set(mode="POSE")
        self.bones = [(joint, self.object.pose.bones[problem.names[joint]]) for joint in sorted(self.ends)]
        self.axes = {joint: bone.bone.matrix_local.to_quaternion() for joint, bone in self.bones}
        self.targets = [self._add_wish(wish) for wish in problem.wishes]

    def _add_wish(self, wish: int) -> "bpy.types.Object":
        target = bpy.data.objects.new("target", None)
        bpy.context.collection.objects.link(target)
        problem, joint, length = self.problem, self.problem.parents[wish], 0
        bone = self.object.pose.bones[problem.names[joint]]
        while problem.free[joint]:
            joint, length = problem.parents[joint], length + 1
        constraint = bone.constraints.new("IK")
        constraint.target, constraint.chain_count = target, length
        return target

    def solve(self, frame: int) -> None:
        problem = self.problem
        for joint, bone in self.bones:
            x, y, z, w = problem.rotations[frame, joint]
            axes = self.axes[joint]
            bone.rotation_quaternion = axes.inverted() @ Quaternion((w, x, y, z)) @ axes
        root = self.bones[0][1]
        root.location = self.axes[0].inverted() @ Vector((problem.roots[frame] - self.rest[0]).tolist())
        for target, place in zip(self.targets, problem.targets[:, frame], strict=True):
            target.location = place.tolist()
        bpy.context.view_layer.update()

    def places(self) -> np.ndarray:
        found = np.zeros((len(self.problem.names), 3))
        for joint, bone in self.bones:
            found[self.ends[joint]] = bone.tail
        for joint, bone in self.bones:
            found[joint] = bone.head
        return found


main(Blender)
