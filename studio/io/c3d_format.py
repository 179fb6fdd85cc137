"""How a C3D file begins."""


def is_c3d(head: bytes) -> bool:
    """Whether a file that begins so may be C3D: where its parameters are, then the mark of the format, 80."""
    return len(head) >= 2 and head[0] >= 2 and head[1] == 0x50
