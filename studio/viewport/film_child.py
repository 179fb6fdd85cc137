"""Child process that renders a video: ``python -m studio.viewport.film_child``, with ``Shots`` on standard input.

VTK holds Python's global lock while it renders, and graphics drivers may crash: neither affects the window. Frames go
to standard output, or as images into a folder; progress goes to standard error, one JSON record per line.
"""

import json
import os
import sys
from contextlib import closing, suppress

from studio.core.errors import StudioError
from studio.startup.process import prepare_process


def main() -> None:
    """Render the requested shots; an error is reported before the process ends."""
    frames_out = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())  # whatever else is said must not get between the frames
    prepare_process()
    from studio.io.png import write_numbered
    from studio.viewport.film_pictures import render_shots
    from studio.viewport.shots import receive_shots

    shots = receive_shots(sys.stdin.buffer)
    write_record(share=0.0, text="Adapting")
    try:
        # An encoder that takes no more tells by itself what the matter is.
        with suppress(BrokenPipeError), frames_out, closing(render_shots(shots)) as pictures:
            for number, picture in enumerate(pictures, 1):
                if shots.stem:
                    write_numbered(shots.stem, number, picture)
                else:
                    frames_out.write(picture.data)
                write_record(share=number / len(shots.times), text=f"Frame {number} of {len(shots.times)}")
    except StudioError as error:
        write_record(error=str(error))
    except OSError as error:
        write_record(errno=error.errno)


def write_record(**record: object) -> None:
    """Write one JSON record for the parent process."""
    print(json.dumps(record), file=sys.stderr, flush=True)


if __name__ == "__main__":
    main()
