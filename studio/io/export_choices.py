"""Names of the choices for an exported file, separate from their computation."""

REST_POSES = {"t": "T-pose", "own": "Bind pose"}
"""Poses in which every angle of a file is zero, by key."""
ROOTS = {"": "On hips", "floor": "On root joint", "in-place": "In place"}
"""Joints that keep the travel of a body, by key."""

RESTING = (".bvh", ".fbx", ".glb", ".gltf", ".usd", ".usda", ".usdc", ".usdz")
"""Kinds of files whose skeleton rests in a pose that can be chosen."""
SKELETAL = (*RESTING, ".vrma")
"""Kinds of files that hold a skeleton: a character carries the capture's fingers, props and other joints along."""
JOINTED = (*SKELETAL, ".csv", ".npz")
"""Kinds of files that hold joints; the others hold a body or its markers."""
ROOTLESS = (".vrma",)
"""Kinds of files in which nothing but the hips travels."""
