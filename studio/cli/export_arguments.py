"""Options of the files that are written, the same for every verb that writes motions."""

from argparse import Namespace

from studio.io.export_options import ExportOptions


def export_options(arguments: Namespace) -> ExportOptions:
    """Export options of the command line."""
    begin, end = arguments.range or (None, None)
    return ExportOptions(
        joint_names=arguments.joint_names,
        rest_pose=arguments.rest_pose,
        body_only=getattr(arguments, "body_only", False),
        begin=begin,
        end=end,
        frame_rate=arguments.rate,
        root=arguments.root,
        at_origin=getattr(arguments, "at_origin", False),
    )
