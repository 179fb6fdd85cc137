"""Registration of ASF and AMC files, and their recognition."""

import re

_BEGINNING = re.compile(
    rb"(\xef\xbb\xbf)?(\s*#[^\r\n]*)*\s*:(version|name|units|fully-specified|degrees|radians)\b", re.IGNORECASE
)


def is_acclaim(head: bytes) -> bool:
    """True if a file that begins with ``head`` is an ASF or AMC file: a keyword after comments."""
    return _BEGINNING.match(head) is not None
