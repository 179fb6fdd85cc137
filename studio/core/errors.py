"""Errors whose message is meant for the user."""

INTERNAL_ERROR = "internal error"
"""Words in every message about a fault of the program; tests recognise such messages by them."""


class StudioError(Exception):
    """Error that the user can understand and act on.

    The message is one or two whole sentences: what happened, in which file and line or member, and what to do.
    Everything shown to users derives from this class; any other exception is a fault of the program.
    """


class Stopped(StudioError):  # noqa: N818 - it is no error to stop
    """Cancellation by the user; the message says which part of the work is kept."""
