"""Reading of FBX files as arrays, by ufbx in a child process."""

from studio.io.scene.scene_reader import SceneReader

FBX_READER = SceneReader("FBX", "studio.io.fbx.child", "ufbx", "ufbx")


def is_fbx(head: bytes) -> bool:
    """True if a file that begins with ``head`` is an FBX file, binary or text."""
    return head.startswith((b"Kaydara FBX Binary", b"; FBX"))
