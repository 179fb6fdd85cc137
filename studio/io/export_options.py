"""What the user chooses of a file that is written, beside its kind."""

from dataclasses import dataclass, replace
from pathlib import Path

from studio.core.body.zero_pose import t_pose, with_zero_pose
from studio.core.errors import StudioError
from studio.core.mesh.joint_skin import character_skin
from studio.io.export import Take
from studio.io.joint_names import with_joint_names

REST_POSES = {"t": "T-pose", "own": "the body's own"}
"""In which pose every angle of a file is zero, by key."""

CARRYING = (".bvh", ".glb", ".gltf", ".usd", ".usda", ".usdc", ".usdz", ".fbx")
"""Kinds of files in which a character carries the capture's fingers, props and other joints along."""


@dataclass(frozen=True)
class ExportOptions:
    """What is empty stays as the take has it: a T-pose and HumanIK's names for characters, its own for a capture."""

    joint_names: str = ""
    """A key of ``joint_names.joint_namings``."""
    rest_pose: str = ""
    """A key of ``REST_POSES``, for BVH: ``own`` is the pose in which a character's skin is bound, or the file's own."""
    body_only: bool = False
    """Leave out what a capture has beside the body: fingers, eyes, twist bones, props."""

    def carries(self, path: Path) -> bool:
        """Whether a character's file is to have the capture's other joints as well: skeletons have them, tables not."""
        return not self.body_only and path.suffix.lower() in CARRYING

    def check(self, path: Path) -> None:
        """Raise StudioError where a choice does not fit the kind of file that ``path`` is."""
        if self.rest_pose and path.suffix.lower() != ".bvh":
            raise StudioError(f"{path.name}: only BVH has a rest pose to choose; others keep the skin's own.")
        if self.rest_pose and self.rest_pose not in REST_POSES:
            raise StudioError(f"There is no rest pose '{self.rest_pose}'. Choose {', '.join(REST_POSES)}.")

    def applied_to(self, take: Take, path: Path) -> Take:
        """``take`` as it shall be written to ``path``. Raises StudioError where a choice does not fit."""
        self.check(path)
        capture = take.capture
        if self.rest_pose == "t" and take.character is None:
            capture = with_zero_pose(capture, t_pose(capture))
        elif self.rest_pose == "own" and take.character is not None:
            capture = with_zero_pose(capture, character_skin(take.character, capture.skeleton).bind_rotations)
        if self.joint_names:
            capture = with_joint_names(capture, self.joint_names)
        return take if capture is take.capture else replace(take, capture=capture)
