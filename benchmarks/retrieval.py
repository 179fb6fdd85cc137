"""The library's search beside trying every frame, a k-d tree and faiss: ``python -m benchmarks.retrieval [--quick]``.

Writes ``docs/retrieval.md`` and its two figures. Time is processor time of one thread, each query by itself, all
searchers in turns; faiss takes part where it is installed (the extra ``peers``). The clips are strikes of the shared
captures where they are there, else the bundled ones, as seen in a mirror too, with other measures and moments, until
there are enough.
"""

import sys
import time
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from benchmarks.clips import REAL, ROOT
from benchmarks.fighting import fights
from benchmarks.hits import draw_hits
from benchmarks.machine import machine
from benchmarks.report import table as markdown
from studio.core.clip_search import BYTES_A_FRAME, PoseQuery, SearchTable, pose_distances, search
from studio.core.kernels import pose_search as at
from studio.library.catalogue import Catalogue
from studio.library.clusters import map_of, rotation_free_features
from studio.library.indexing import index_folders
from studio.library.library import Library
from studio.library.mirroring import with_mirrored

PAPER_MOTIONS = {75: 0.54, 60: 0.52, 45: 0.46, 30: 0.38, 15: 0.34}
PAPER_CLUSTERS = {10: 5.68, 50: 1.24, 100: 0.54, 200: 1.56, 1000: 4.87}
"""Seconds (P09, tables 1 and 2)."""
FRAMES, ACTORS = 52, 4
"""Frames of a clip in the paper, 3,900 in all; actors in the paper."""
HEADER = """# Search of the motion library

Written by `make bench`; nothing here is written by hand. [method.md](method.md) explains the search.

"""

PROBED, TRAINED = 32, 40
"""Cells of faiss's inverted file to one that is looked into; poses a cell from which it is made."""
ALIKE = 1e-4
"""Metres by which an answer in single precision may lie beside one in double."""

FIGURES = """## At the hit

As figure 7 of the paper: strikes found for targets before one body, in grey as they were found, in blue driven to the
target, with what they miss then.

![Six strikes of one body as found and as driven to their targets](pictures/retrieval_adapted.svg)

As figure 8: the same target, 70 cm ahead and 110 cm high, finds a child, a woman and a giant three different strikes
(*Scenes > One target, three strikes*).

![One target, and the strikes that three bodies do](pictures/retrieval_bodies.svg)
"""

Searcher = Callable[[PoseQuery], float]


def main(arguments: list[str]) -> None:
    """Measure and write."""
    quick = "--quick" in arguments
    queries, large = (20, 100_000) if quick else (200, 1_000_000)
    poses, paths = real_poses()
    small = made_table(poses, paths, 75)
    parts = [HEADER, machine(), f"; {BYTES_A_FRAME} bytes a frame, of which {4 * at.POSE_WIDTH} stay on disk.\n\n"]
    parts += ["## Number of motions\n\n", motions(poses, paths, queries), "\n"]
    parts += ["## Number of clusters\n\n", clusters(small, queries), "\n"]
    parts += ["## The bundled fighter, 60 s against a head that moves\n\n", fights(), "\n"]
    parts += ["## Size\n\n", sizes([small, made_table(poses, paths, large // FRAMES + 1)], queries)]
    draw_hits(ROOT / "docs" / "pictures")
    parts += ["\n", FIGURES]
    (ROOT / "docs" / "retrieval.md").write_text("".join(parts), encoding="utf-8")
    print("".join(parts))


def real_poses() -> tuple[list[NDArray[np.float32]], list[NDArray[np.float64]]]:
    """Poses (F, 64) before hits, and paths (T, 3) of the hits, of the clips that are found."""
    folder = REAL / "strikes" if REAL.is_dir() else ROOT / "examples" / "captures"
    with TemporaryDirectory() as place, Catalogue(Path(place)) as catalogue:
        index_folders(catalogue, [folder])
        library = with_mirrored(Library.of(catalogue))
    split = np.split(library.table.rows, library.table.first_rows[1:])
    return split, [clip.path.places for clip in library.clips]


def made_table(poses: list[NDArray[np.float32]], paths: list[NDArray[np.float64]], count: int) -> SearchTable:
    """``count`` clips of 52 frames out of those there are: stretched in time, joints moved by a few centimetres."""
    random = np.random.default_rng(count)
    rows, hits = [], []
    for clip in range(count):
        own, path = poses[clip % len(poses)], paths[clip % len(poses)]
        sampled = own[np.linspace(0, len(own) - 1, FRAMES).astype(np.int64)].copy()
        sampled[:, : at.SQUARE] += random.normal(0.0, 0.006, at.SQUARE).astype(np.float32)
        sampled[:, at.SQUARE] = np.square(sampled[:, : at.SQUARE], dtype=np.float64).sum(axis=1)
        rows.append(sampled)
        hits.append(path[np.linspace(0, len(path) - 1, 8).astype(np.int64)])
    each = np.arange(count)
    lengths = np.full(count, FRAMES), np.full(count, 8)
    return SearchTable(np.concatenate(rows), lengths[0], np.concatenate(hits), lengths[1], each % ACTORS, each % 4)


def queries_of(table: SearchTable, count: int) -> list[PoseQuery]:
    """Poses near those of a table, and targets within reach."""
    random, made = np.random.default_rng(1), []
    for _ in range(count):
        near = table.rows[random.integers(0, len(table.rows), ACTORS)].copy()
        near[:, : at.SQUARE] += random.normal(0.0, 0.01, (ACTORS, at.SQUARE)).astype(np.float32)
        near[:, at.SQUARE] = np.square(near[:, : at.SQUARE], dtype=np.float64).sum(axis=1)
        angle, apart, height = random.uniform(-3, 3, (3, ACTORS, 4)) * [[[1.0]], [[0.1]], [[0.15]]] + [
            [[0.0]], [[0.9]], [[1.2]]]  # fmt: skip
        made.append(PoseQuery(near, np.stack([apart * np.cos(angle), apart * np.sin(angle), height], axis=2)))
    return made


def timed(searcher: Searcher, queries: list[PoseQuery]) -> tuple[float, float]:
    """Milliseconds of processor time, median and most."""
    searcher(queries[0])
    times = []
    for query in queries:
        begin = time.thread_time()
        searcher(query)
        times.append(1000.0 * (time.thread_time() - begin))
    return float(np.median(times)), max(times)


def every_frame(table: SearchTable) -> Searcher:
    """NumPy, all at once: posture and hit of every frame."""
    clips = np.repeat(np.arange(table.clip_count), table.frame_counts)
    actors, limbs = table.actors[clips], table.limbs[clips]
    by_actor = [np.flatnonzero(actors == actor) for actor in range(ACTORS)]
    paths = table.paths.reshape(table.clip_count, 8, 3)

    def searcher(query: PoseQuery) -> float:
        best = np.inf
        for actor, rows in enumerate(by_actor):
            posture, turns = pose_distances(query.poses[actor], table.rows[rows])
            away = paths[clips[rows]].copy()
            away[..., :2] -= table.rows[rows, None, at.POSE_CENTRE : at.POSE_CENTRE + 2]
            c, s = np.cos(turns)[:, None], np.sin(turns)[:, None]
            x, y = c * away[..., 0] - s * away[..., 1], s * away[..., 0] + c * away[..., 1]
            target = query.targets[actor][limbs[rows]][:, None]
            reach = np.sqrt(
                (x - target[..., 0]) ** 2 + (y - target[..., 1]) ** 2 + (away[..., 2] - target[..., 2]) ** 2
            )
            best = min(best, float((posture + reach.min(axis=1)).min()))
        return best

    return searcher


def tree(table: SearchTable) -> Searcher:
    """scipy's k-d tree over what turns do not change: the nearest posture alone, and not the hit."""
    built = cKDTree(rotation_free_features(table.rows))
    return lambda query: built.query(rotation_free_features(query.poses))[0].min()


def nearest_cluster(table: SearchTable, count: int) -> Searcher:
    """As in P09: the cluster of the nearest centre, every frame of it; its answer may be another one."""
    made = map_of(table, count)
    members = [table.rows[made.clusters == group] for group in range(len(made.centres))]

    def searcher(query: PoseQuery) -> float:
        best = np.inf
        for pose in query.poses:
            group = int(np.argmin(np.linalg.norm(made.centres - rotation_free_features(pose[None]), axis=1)))
            best = min(best, float(pose_distances(pose, members[group])[0].min()))
        return best

    return searcher


def motions(poses: list[NDArray[np.float32]], paths: list[NDArray[np.float64]], count: int) -> str:
    """Table 1 of P09 with ours beside it."""
    rows = []
    for number, paper in PAPER_MOTIONS.items():
        table = made_table(poses, paths, number)
        queries = queries_of(table, count)
        one, eight = (timed(lambda query, n=n, table=table: search(table, query, n)[0].cost, queries) for n in (1, 8))
        rows.append([str(number), f"{1000 * paper:.0f}", f"{one[0]:.3f}", f"{one[1]:.3f}", f"{eight[0]:.3f}"])
    return markdown(("motions", "paper, ms", "ours, best clip, ms", "at most", "ours, best 8, ms"), rows)


def clusters(table: SearchTable, count: int) -> str:
    """Table 2 of P09: how it depends on the number of clusters, and how often the nearest cluster has the answer."""
    rows, queries = [], queries_of(table, count)
    for number, paper in PAPER_CLUSTERS.items():
        searcher = nearest_cluster(table, number)
        right = sum(
            np.isclose(searcher(query), min(pose_distances(pose, table.rows)[0].min() for pose in query.poses))
            for query in queries
        )
        median, _ = timed(searcher, queries)
        rows.append(
            [str(number), f"{1000 * paper:.0f}", f"{median:.3f}", f"{100.0 * float(right) / len(queries):.0f} %"]
        )
    titles = ("clusters", "paper, ms", "nearest cluster in NumPy, posture only, ms", "finds the nearest posture")
    return markdown(titles, rows)


def faiss_indexes(table: SearchTable) -> list[tuple[str, Searcher]]:
    """faiss over what turns do not change: all of it, and the nearest of its cells; none where it is not installed."""
    try:
        import faiss
    except ImportError:
        return []
    faiss.omp_set_num_threads(1)
    features = rotation_free_features(table.rows).astype(np.float32)
    cells = round(np.sqrt(len(features)))
    made = []
    for name, kind in (("every row", "Flat"), (f"1 of {PROBED} cells", f"IVF{cells},Flat")):
        index = faiss.index_factory(features.shape[1], kind)
        index.train(features[:: max(len(features) // (TRAINED * cells), 1)])
        index.add(features)
        if kind != "Flat":
            index.nprobe = max(cells // PROBED, 1)
        made.append((f"faiss, {name}: posture only, a bound of it", _nearest_of(index)))
    return made


def _nearest_of(index: Any) -> Searcher:
    return lambda query: float(
        np.sqrt(index.search(rotation_free_features(query.poses).astype(np.float32), 1)[0].min())
    )


def sizes(tables: list[SearchTable], count: int) -> str:
    """Ours beside every frame, a k-d tree and faiss, and how often each says what trying every frame says."""
    rows = []
    for table in tables:
        queries = queries_of(table, count)
        few = queries[: max(3, 20_000 * 20 // len(table.rows))]
        every, nearest = every_frame(table), tree(table)
        hits, postures = ([float(searcher(query)) for query in few] for searcher in (every, nearest))
        for name, searcher, some, right in (
            ("ours: posture and hit, exact", lambda query, of=table: search(of, query, 1)[0].cost, queries, hits),
            ("NumPy: posture and hit, every frame", every, few, hits),
            ("scipy cKDTree: posture only, a bound of it", nearest, queries, postures),
            *((*each, queries, postures) for each in faiss_indexes(table)),
        ):
            same = np.isclose([float(searcher(query)) for query in few], right, atol=ALIKE).mean()
            median, most = timed(searcher, some)
            rows.append([f"{len(table.rows):,} frames", name, f"{median:.3f}", f"{most:.3f}", f"{100.0 * same:.0f} %"])
    return markdown(("library", "who", "ms, median", "at most", "finds the nearest"), rows)


if __name__ == "__main__":
    main(sys.argv[1:])
