"""Options of the files that are written, the same for every verb that writes motions."""

from argparse import ArgumentParser, Namespace

from studio.io.export_options import REST_POSES, ExportOptions
from studio.io.joint_names import joint_namings


def add_export_options(parser: ArgumentParser) -> None:
    """Names of the joints, and the pose in which every angle is zero."""
    group = parser.add_argument_group("writing")
    group.add_argument("--joint-names", choices=tuple(joint_namings()), default="", help="as which program names them")
    group.add_argument(
        "--rest-pose", choices=tuple(REST_POSES), default="", help="of BVH: T-pose, or the body's own; T for characters"
    )


def export_options(arguments: Namespace) -> ExportOptions:
    """What the user chose."""
    return ExportOptions(arguments.joint_names, arguments.rest_pose)
