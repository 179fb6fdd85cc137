"""H-Anim characters: VRML97 and X3D, the classic and the XML encoding."""


def is_x3d(head: bytes) -> bool:
    """True if a file that begins with ``head`` is X3D in XML."""
    return b"<X3D" in head and head.lstrip(b"\xef\xbb\xbf \t\r\n")[:1] == b"<"


def is_vrml(head: bytes) -> bool:
    """True if a file that begins with ``head`` is VRML97 or X3D in the classic encoding."""
    return head.lstrip(b"\xef\xbb\xbf \t\r\n")[:5] in (b"#VRML", b"#X3D ")
