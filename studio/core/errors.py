"""The error whose message is meant for a person."""

INTERNAL_ERROR = "internal error"
"""Words in every message about a fault of the program, by which tests know one."""


class StudioError(Exception):
    """Something the user can understand and act on.

    The message is one or two whole sentences: what happened, in which file and line or member, and what
    to do. Everything shown to users derives from this class; any other exception is a fault of the
    program.
    """


class Stopped(StudioError):  # noqa: N818 - it is no error to stop
    """The user stopped the work; the message says what is left of it."""
