"""Choices for an exported file, separate from their computation so that a window can list them quickly."""

REST_POSES = {"t": "T-pose", "own": "Bind pose"}
"""Poses in which every angle of a file is zero, by key."""
ROOT_CHOICES = {"": "On hips", "floor": "On root joint", "in-place": "In place"}
"""Joints that hold the travel of a body, by key."""

REST_POSE_SUFFIXES = (".bvh", ".fbx", ".glb", ".gltf", ".usd", ".usda", ".usdc", ".usdz")
"""Suffixes of files whose rest pose can be chosen."""
SKELETON_SUFFIXES = (*REST_POSE_SUFFIXES, ".vrma")
"""Suffixes of files that hold a skeleton, so that a character can carry the capture's fingers, props and
other joints.
"""
JOINT_SUFFIXES = (*SKELETON_SUFFIXES, ".csv", ".npz")
"""Suffixes of files that hold joints; other files hold a body or its markers."""
HIPS_ONLY_SUFFIXES = (".vrma",)
"""Suffixes of files in which only the hips can travel."""
