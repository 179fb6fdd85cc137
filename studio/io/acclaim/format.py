"""ASF and AMC as a format of the registry: what such files begin with."""

import re

_BEGINNING = re.compile(
    rb"(\xef\xbb\xbf)?(\s*#[^\r\n]*)*\s*:(version|name|units|fully-specified|degrees|radians)\b", re.IGNORECASE
)


def is_acclaim(head: bytes) -> bool:
    """True if a file that begins with ``head`` is a skeleton or a motion of Acclaim's: a keyword after comments."""
    return _BEGINNING.match(head) is not None
