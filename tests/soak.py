"""Spoilt files, and a monkey: ``make soak``, or ``python -m tests.soak``, with ``--help`` for its options.

Every kind of file that the studio reads, and every surface of ``tests.surfaces``, each in a process of its own with
limits of memory and time. Whatever is neither read nor refused in a sentence (another exception, a process that dies,
more than five seconds of the processor or ten minutes by the clock) is kept in a folder, with the seed that makes it
again; the exit code is then 1.
"""

import argparse
import contextlib
import math
import multiprocessing
import os
import resource
import subprocess
import sys
import tempfile
import time
import traceback
import warnings
from concurrent.futures import ThreadPoolExecutor
from multiprocessing.sharedctypes import Synchronized
from pathlib import Path
from random import Random

from studio.startup.process import prepare_process

COUNT, COUNTS = (
    100_000,
    dict.fromkeys((".fbx", "catalogue", "clips", "commands", "stages", "words"), 5_000)
    | {"kills": 2_000, "actions": 200, "projects": 200},
)  # these take longer
SECONDS, STILL, START = 5.0, 600.0, 600.0
"""Seconds of the processor for a file; by the clock, however busy the machine is; and by the clock for the first, for
which kernels may have to be compiled."""
SECONDS_OF = {"actions": 200.0, "projects": 60.0}
"""Seconds of the processor for what is longer than a file."""
TELLS = 30.0
"""Seconds between two lines that say how far a kind of file is."""
MEMORY = 500 << 20
TIMES_SIZE = 20
MOST_KEPT = 20


def spoil(suffix: str, first: int, count: int, now: "Synchronized[int]", keep: Path) -> None:
    """Read one spoilt file after another; ``now`` is the seed under way. What is wrong is kept with its stack."""
    prepare_process()
    from studio.core.errors import StudioError
    from tests.io.forked_readers import fork_readers
    from tests.io.seeds import SEEDS, read, spoiled
    from tests.surfaces import SURFACES

    fork_readers()
    kept = 0
    with tempfile.TemporaryDirectory() as folder:
        path, trial = Path(folder).resolve() / f"take{suffix}", SURFACES.get(suffix)
        original = b""
        if trial is None:
            warnings.simplefilter("error")
            SEEDS[suffix](path)
            read(path)
            original = path.read_bytes()
            limit_memory(len(original))
        for seed in range(first, count):
            now.value = seed
            try:
                if trial is not None:
                    trial(seed, path.parent)
                    continue
                path.write_bytes(spoiled(Random(seed), original))
                with contextlib.suppress(StudioError):
                    read(path)
            except Exception:  # noqa: BLE001 - this is what is looked for
                if trial is None:
                    (keep / f"{seed}{suffix}").write_bytes(path.read_bytes())
                (keep / f"{seed}{suffix}.txt").write_text(traceback.format_exc())
                kept += 1
                if kept == MOST_KEPT:
                    break
    now.value = count


def limit_memory(size: int) -> None:
    """Limit the memory to that of the process now, and as much more as a file of that size may cost."""
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    most = pages * resource.getpagesize() + MEMORY + TIMES_SIZE * size
    resource.setrlimit(resource.RLIMIT_AS, (most, most))


def watch(suffix: str, first: int, count: int, keep: Path) -> str:
    """Spoil files of one kind by seeds ``first`` to ``count``; after one that dies or hangs another process goes on."""
    context = multiprocessing.get_context("spawn")
    start, lost, seed = time.monotonic(), 0, first
    while seed < count and lost < MOST_KEPT:
        now = context.Value("q", seed - 1)
        process = context.Process(target=spoil, args=(suffix, seed, count, now, keep))
        process.start()  # no daemon, which could have no workers of its own
        try:
            reason = _until_it_ends_or_hangs(process, now, suffix, count)
        finally:
            process.kill()
        seed = max(now.value, seed) + 1
        if now.value >= count:
            break
        lost += 1
        (keep / f"{now.value}{suffix}.txt").write_text(reason)
    wrong = len(list(keep.glob(f"*{suffix}.txt")))
    return f"{suffix:14} {min(seed, count) - first:>9,} files, {wrong} wrong, {time.monotonic() - start:.0f} s"


def _until_it_ends_or_hangs(
    process: "multiprocessing.process.BaseProcess", now: "Synchronized[int]", suffix: str, count: int
) -> str:
    seen, since, told, worked = now.value, time.monotonic() + START, time.monotonic(), math.inf
    most = SECONDS_OF.get(suffix, SECONDS)
    while process.is_alive():
        process.join(0.5)
        if time.monotonic() - told > TELLS:
            told = time.monotonic()
            print(f"{suffix:14} {now.value:>9,} of {count:,}", file=sys.stderr, flush=True)
        if now.value != seen:
            seen, since, worked = now.value, time.monotonic(), processor_seconds(process)
        elif time.monotonic() - since > STILL or processor_seconds(process) - worked > most:
            process.kill()
            process.join()
            return f"seed {seen}: more than {most:g} seconds"
    return f"seed {now.value}: the process died with {process.exitcode}"


def processor_seconds(process: "multiprocessing.process.BaseProcess") -> float:
    """Processor seconds of a process; none once it has ended."""
    with contextlib.suppress(FileNotFoundError, ProcessLookupError):
        user, system = Path(f"/proc/{process.pid}/stat").read_text().rpartition(")")[2].split()[11:13]
        return (int(user) + int(system)) / os.sysconf("SC_CLK_TCK")
    return 0.0


def let_a_monkey_in(events: int, keep: Path) -> str:
    """As many events as files of a kind at the real window, in a process of its own."""
    command = [sys.executable, "-m", "tests.monkey", "--events", str(events)]
    with open(keep / "monkey.log", "wb") as log:
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=log, check=False)
    if done.returncode:
        (keep / "monkey.txt").write_bytes(done.stdout or b"the process died: see monkey.log")
    return f"{'monkey':14} {events:>9,} events, {'wrong' if done.returncode else '0 wrong'}"


def main() -> int:
    """Every kind beside the others, as many at a time as there are cores."""
    from tests.io.seeds import SEEDS
    from tests.surfaces import SURFACES

    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--first", type=int, default=0, help="first seed; runs that begin elsewhere spoil other files")
    parser.add_argument("--count", type=int, help=f"files of each kind; {COUNT:,} by default, of what takes long 5,000")
    parser.add_argument(
        "--kind", nargs="+", default=[*SEEDS, *SURFACES], choices=[*SEEDS, *SURFACES], help="all by default"
    )
    parser.add_argument("--keep", type=Path, default=Path("soak"), help="folder for what is wrong")
    parser.add_argument(
        "--no-monkey", dest="monkey", action="store_false", help="leave the window alone (tests.monkey)"
    )
    arguments = parser.parse_args()
    arguments.keep.mkdir(parents=True, exist_ok=True)
    counts = {kind: arguments.count or COUNTS.get(kind, COUNT) for kind in arguments.kind}
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        monkey = pool.submit(let_a_monkey_in, arguments.count or COUNT, arguments.keep) if arguments.monkey else None
        jobs = [
            pool.submit(watch, suffix, arguments.first, arguments.first + count, arguments.keep)
            for suffix, count in counts.items()
        ]
        for job in jobs:
            print(job.result(), flush=True)
        if monkey is not None:
            print(monkey.result(), flush=True)
    wrong = sorted(arguments.keep.glob("*.txt"))
    print(f"{len(wrong)} wrong" + (f", kept in {arguments.keep}" if wrong else ""))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
