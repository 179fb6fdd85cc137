"""Options that override the guesses of importers, the same for every verb that reads captures."""

from argparse import Namespace

from studio.core.markers.cleaning import USUAL_STEPS, FillLongGaps, FillShortGaps, LowPass, Step, UndoSwaps
from studio.io.figure.body_maps import read_body_map
from studio.io.importing import ImportOptions
from studio.io.markers.maps import read_map


def import_options(arguments: Namespace) -> ImportOptions:
    """Import options of the command line. Raises StudioError if a body map or marker map cannot be read."""
    return ImportOptions(
        unit=arguments.unit,
        up_axis=arguments.up_axis,
        frame_rate=arguments.frame_rate,
        floor=arguments.floor,
        reference=arguments.reference,
        clean=arguments.clean,
        marker_map=read_map(arguments.marker_map) if arguments.marker_map else None,
        marker_steps=_marker_steps(arguments),
        body_map=read_body_map(arguments.body_map) if arguments.body_map else None,
    )


def _marker_steps(arguments: Namespace) -> tuple[Step, ...] | None:
    """Cleaning steps in the order of the markers dialog; None if no argument names any."""
    if not (arguments.undo_swaps or arguments.fill_gaps is not None or arguments.smooth is not None):
        return None
    steps: list[Step] = [UndoSwaps()] if arguments.undo_swaps else []
    if arguments.fill_gaps != 0.0:
        steps += (
            USUAL_STEPS if arguments.fill_gaps is None else (FillShortGaps(longest=arguments.fill_gaps), FillLongGaps())
        )
    if arguments.smooth is not None:
        steps.append(LowPass(cutoff=arguments.smooth))
    return tuple(steps)
