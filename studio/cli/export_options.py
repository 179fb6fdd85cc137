"""Options of the files that are written, the same for every verb that writes motions."""

from argparse import Namespace

from studio.io.export_options import ExportOptions


def export_options(arguments: Namespace) -> ExportOptions:
    """What the user chose."""
    return ExportOptions(arguments.joint_names, arguments.rest_pose)
