"""Registration of TRC files, and their recognition."""


def is_trc(head: bytes) -> bool:
    """True if a file that begins with ``head`` is a TRC file."""
    return head.lstrip(b"\xef\xbb\xbf \t\r\n")[:12].lower() == b"pathfiletype"
