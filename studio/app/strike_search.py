"""Search for library strikes in the window: folders are indexed, strikes are searched for the active performer, and
inserted.
"""

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtWidgets import QStackedWidget

from studio.app.capture_import import read_motion
from studio.app.file_dialogs import ask_folder
from studio.app.labelling import LabelController
from studio.app.pose_mapping import PoseMapController
from studio.app.strike_edit import FloatArray, StrikeRequest, put_strike, strike_scene
from studio.app.strike_target import StrikeTarget, targets_of
from studio.app.workbench import Workbench
from studio.cli.arguments import library_folder
from studio.core.errors import StudioError
from studio.core.solver.performers.rows import timing_of
from studio.core.stage.placement import Placement
from studio.engine.background_tasks import CancelledError, Progress
from studio.engine.posed_performer import row_at
from studio.io.importing import GUESS_ALL
from studio.library.clip_labels import Kind, Limb
from studio.panels.strikes import (
    EVALUATING_HINT,
    NO_MATCH_HINT,
    NO_STRIKES_HINT,
    NO_TARGET_HINT,
    OWN_FACE_HINT,
    POSE_CLIPS_HINT,
    READY_HINT,
    UNSOLVED_HINT,
    Strikes,
)
from studio.resources_folder import bundled_strikes_folder

# Here and below: what searches loads the solver, which takes longer than a window.
if TYPE_CHECKING:
    from studio.library.indexing import IndexReport
    from studio.library.library import Library, LibraryClip
    from studio.library.searching import Result, StrikeQuery
    from studio.library.striking import TriedStrike


class StrikeSearchController:
    """Controller that connects the Strikes panel, the motion library on disk and the document."""

    def __init__(self, bench: Workbench, folder: Path | None = None) -> None:
        self.bench, self.folder = bench, folder or library_folder()
        limbs = [(limb, limb.words.capitalize()) for limb in Limb]
        kinds = [(kind, kind.capitalize()) for kind in Kind if kind is not Kind.NONE]
        self.panel = Strikes(limbs, kinds)
        self.labelling = LabelController(self)
        self.mapping = PoseMapController(self)
        self.pages = QStackedWidget()
        for page in (self.panel, self.labelling.form):
            self.pages.addWidget(page)
        self.library: Library | None = None
        self.found: list[TriedStrike] = []
        self.listed: list[LibraryClip] = []
        """The clips that the panel lists: those found, or all while there is no target."""
        self._sought: tuple[StrikeQuery, Placement] | None = None
        self._waits = False
        """True while a search waits for a body to be solved."""
        self._outdated = False
        """True if the panel lists what was found for another project, target or character."""
        self._searched_for = ""
        """Performer for which the listed strikes were found; empty if they are ranked for none."""
        self._trial = -1
        """Task that tries the strikes that were found last."""
        self.panel.folder_requested.connect(lambda: ask_folder(bench, "Add to the motion library", self.add_folder))
        self.panel.search_requested.connect(self.search)
        self.panel.strike_chosen.connect(self.play)
        self.panel.strike_highlighted.connect(self.aim_at)
        bench.document.entity_changed.connect(self._entity_changed)
        bench.document.project_opened.connect(self._project_opened)
        self.panel.shown.connect(self._update_results)
        bench.live.adapted.connect(lambda _: self.search() if self._waits else None)
        self._offer_targets()
        self.panel.opened.connect(self.label)

    def _entity_changed(self, collection: str, entity_id: str) -> None:
        if collection in ("props", "performers"):
            self._offer_targets()

    def _project_opened(self) -> None:
        """Discard the results that were found for the previous project."""
        self._end_trial()
        self._outdated = True
        self._offer_targets()

    def _offer_targets(self) -> None:
        """Update the list of targets that can be hit.

        A new box is chosen if nothing is; a chosen target stays chosen. Results for another target, or for a removed
        performer, are searched again.
        """
        targets = targets_of(self.bench.document.project)
        props = [target for target, _ in targets if target.collection == "props"]
        chosen = self.panel.target.value
        new = next((target for target in props if not self.panel.target.offers(target)), None)
        self.panel.offer_targets(targets, new if chosen is None else chosen)
        is_gone = self._searched_for not in ("", *self.bench.document.project.performers)
        self._outdated = self._outdated or is_gone or self.panel.target.value != chosen
        self._update_results()

    def _update_results(self) -> None:
        """Search again if the panel is visible and its results are outdated."""
        if self._outdated and self.library is not None and self.panel.isVisible():
            self.search_in(self.library)

    def add_folder(self, folder: Path) -> int:
        """Index a folder of captures in the background. Returns the id of the task; files read before a cancellation
        are kept.
        """

        def work(progress: Progress) -> "tuple[IndexReport | None, Library, str]":
            from studio.library.catalogue import Catalogue
            from studio.library.indexing import index_folders
            from studio.library.library import Library

            with Catalogue(self.folder) as catalogue:
                try:
                    report = index_folders(catalogue, [folder], progress)
                except CancelledError:
                    report = None
                library = Library.of(catalogue)
                return report, library, catalogue.remarks

        def done(answer: "tuple[IndexReport | None, Library, str]") -> None:
            report, library, remarks = answer
            self.search_in(library)
            words = f"{remarks} {_unused_files(report, folder)}".strip()
            if words:
                self.bench.post_message(words)

        task: int = self.bench.runner.run(f"Indexing {folder.name}", work, done)
        return task

    def search(self) -> None:
        """Search strikes for the active performer; the library is read from disk the first time."""
        if self.library is not None:
            self.search_in(self.library)
            return

        def work(progress: Progress) -> "tuple[Library, str]":
            from studio.library.catalogue import Catalogue
            from studio.library.indexing import index_folders, load_library

            with Catalogue(self.folder) as catalogue:
                is_new = not catalogue.paths() or catalogue.repaired
                if is_new and not catalogue.read_only:  # it begins with the strikes that come with the studio
                    index_folders(catalogue, [bundled_strikes_folder()], progress)
                library = load_library(catalogue, progress)
                return library, catalogue.remarks

        def done(answer: "tuple[Library, str]") -> None:
            library, remarks = answer
            self.search_in(library)
            if remarks:
                self.bench.post_message(remarks)

        self.bench.runner.run("Opening the motion library", work, done)

    def play(self, index: int, performer_id: str | None = None, time: float | None = None) -> None:
        """Insert the listed strike at ``index`` on a performer, by default the active one, at ``time`` seconds, by
        default the playhead. Errors are reported as messages.
        """
        self.aim_at(-1)
        document = self.bench.document
        key = performer_id or document.active_performer_id
        if not 0 <= index < len(self.listed) or key is None or key not in document.project.performers:
            return
        try:
            self._play(self._wish(self.listed[index], key, document.playhead.time if time is None else time))
        except StudioError as error:
            self.bench.post_message(str(error))

    def _play(self, wish: StrikeRequest) -> None:
        path = wish.found.clip.take.path
        known = [each for each, source in self.bench.sources.items() if str(source) == path]
        capture_id = next((each for each in known if each in self.bench.document.project.captures), None)
        if capture_id is not None:
            put_strike(self.bench, wish, capture_id)
            return
        self.bench.runner.run(
            f"Opening {Path(path).name}",
            lambda progress: read_motion(Path(path), GUESS_ALL, progress),
            lambda read: put_strike(self.bench, wish, read),
        )

    def _wish(self, clip: "LibraryClip", performer_id: str, time: float) -> StrikeRequest:
        """Request for a library clip, starting at the frame that best fits the performer's pose at ``time``. Raises
        StudioError if the performer or the target is missing.
        """
        from studio.library.searching import search_strikes

        project, target = self.bench.document.project, self.panel.target.value
        if not isinstance(target, StrikeTarget):
            raise StudioError("There is nothing to hit. Add a box (Prop > Add box) and choose it as target.")
        name = project.performers[performer_id].name
        if target == StrikeTarget("performers", performer_id):
            raise StudioError(f"{name} cannot strike at its own face. Choose another target.")
        asked = self._strike_query(performer_id, time)
        if asked is None or self.library is None:
            raise StudioError(
                f"{name} or the target is hidden, has no clip or is not solved yet. Show both, wait until they are"
                " adapted, then search again."
            )
        found = search_strikes(self.library, replace(asked, limbs=(), kinds=(), numbers=(clip.number,)), 1)
        if not found:
            raise StudioError("That clip is no longer in the motion library. Search again.")
        return StrikeRequest(found[0], performer_id, time, target, self._frozen(target, time))

    def _frozen(self, target: StrikeTarget, time: float) -> FloatArray | None:
        """Position (3,) of the target at ``time`` on the stage; None if strikes follow the moving target."""
        return None if self.panel.follows else target.place(self.bench.document.project, self.bench.live.result, time)

    def aim_at(self, index: int) -> None:
        """Show the listed strike at ``index`` as a ghost; a negative ``index`` removes the ghost."""
        if 0 <= index < len(self.found) and self._sought is not None:
            asked, where = self._sought
            self._show_ghost(self.found[index].found, asked, where)
        elif 0 <= index < len(self.listed):
            self.show_ghost(self.listed[index], self.listed[index].searched_frames.start)
        else:
            self.show_ghost(None, 0)

    def label(self, index: int) -> None:
        """Open the form of the listed strike at ``index``, to correct its label."""
        self.labelling.open(self.listed[index])

    def show_ghost(self, clip: "LibraryClip | None", frame: int) -> None:
        """Show a library clip as a ghost from ``frame`` to its hit, aligned with the active performer; None removes the
        ghost.
        """
        document = self.bench.document
        key = document.active_performer_id
        asked = None if clip is None or key is None else self._posed(key, document.playhead.time)
        if clip is None or key is None or asked is None:
            if self.bench.has_viewport:
                self.bench.viewport.preview.show(None)
            return
        from studio.library.searching import result_at_frame

        where = Placement.of(document.project.performers[key])
        self._show_ghost(result_at_frame(clip, frame, asked), asked, where)

    def _show_ghost(self, found: "Result", asked: "StrikeQuery", where: Placement) -> None:
        if not self.bench.has_viewport:  # the window has no 3D view
            return
        from studio.core.body.sticks import bone_pairs
        from studio.library.searching import strike_path

        points = where.to_stage(strike_path(found, asked))
        self.bench.viewport.preview.show(points, bone_pairs(asked.body.layout))

    def search_in(self, library: "Library") -> None:
        """Search strikes in a library, and show the results."""
        from studio.library.searching import search_strikes
        from studio.library.striking import tried_strikes

        self.library, self._outdated, self._searched_for = library, False, ""
        if self.mapping.view.isVisible():
            self.mapping.show(library)
        active, now = self.bench.document.active_performer_id, self.bench.document.playhead.time
        asked = None if active is None else self._strike_query(active, now)
        target = self.panel.target.value
        self._end_trial()
        if asked is None or active is None or not isinstance(target, StrikeTarget):
            hint = self._unasked(active or "")
            self._waits = hint == UNSOLVED_HINT
            self._show(hint)
            return
        self._waits, self.listed, self._searched_for = False, [], active
        self.panel.show_results([], EVALUATING_HINT)
        self._sought = asked, Placement.of(self.bench.document.project.performers[active])
        scene = strike_scene(self.bench, active, now, target, self._frozen(target, now))

        def work(progress: Progress) -> "list[TriedStrike]":
            results = search_strikes(library, asked)

            def residual_of(found: "Result") -> float:
                progress.report(results.index(found) / len(results))
                return scene.solved_residual(found)

            return tried_strikes(results, residual_of)

        def done(found: "list[TriedStrike]") -> None:
            if self._trial == number:
                self.found = found
                self._show(READY_HINT if found else NO_MATCH_HINT)

        number = self._trial = self.bench.runner.run("Ranking strikes", work, done)

    def _end_trial(self) -> None:
        """Cancel the running evaluation, and discard its results."""
        self.bench.runner.cancel(self._trial)
        self._trial, self.found = -1, []

    def _unasked(self, performer_id: str) -> str:
        """Sentence why strikes cannot be ranked now."""
        target = self.panel.target.value
        if not isinstance(target, StrikeTarget):
            return NO_TARGET_HINT
        return OWN_FACE_HINT if target == StrikeTarget("performers", performer_id) else UNSOLVED_HINT

    def _show(self, hint: str) -> None:
        self.listed = [each.found.clip for each in self.found]
        texts = [(each.found.clip.name, ", ".join(each.reasons)) for each in self.found]
        if hint not in (READY_HINT, NO_MATCH_HINT) and self.library is not None:
            self.listed = [clip for clip in self.library.clips if self._is_wanted(clip)]
            texts = [(clip.name, _state(clip)) for clip in self.listed]
        self.panel.show_results(
            texts, hint if self.library and self.library.clips else NO_STRIKES_HINT, bool(self.found)
        )

    def _is_wanted(self, clip: "LibraryClip") -> bool:
        limb, kind = self.panel.limb.value, self.panel.kind.value
        return limb in (None, clip.label.limb) and kind in (None, clip.label.kind)

    def list_clips(self, clips: "list[LibraryClip]") -> None:
        """List ``clips``, those of one group of the pose map."""
        self._end_trial()
        self.listed, self._outdated, self._searched_for = clips, False, ""
        aimed = isinstance(self.panel.target.value, StrikeTarget)
        self.panel.show_results([(clip.name, _state(clip)) for clip in clips], POSE_CLIPS_HINT, aimed)

    def _posed(self, performer_id: str, time: float) -> "StrikeQuery | None":
        """Search query of a performer's pose at ``time``, without a target; None without a motion, or if its pose is
        not solved.
        """
        from studio.core.normalized.encode import encode_motion
        from studio.library.searching import StrikeQuery

        project, adapted = self.bench.document.project, self.bench.live.result(performer_id)
        performer = project.performers.get(performer_id)
        if adapted is None or performer is None or not performer.clips or not self.bench.live.ready:
            return None
        row = row_at(adapted, timing_of(project, performer), time)
        rows = slice(row, row + 1)
        pose = encode_motion(adapted.positions[rows], adapted.rotations[rows], adapted.morphology, adapted.frame_rate)
        return StrikeQuery(pose, adapted.morphology, (0.0, 0.0, 0.0))

    def _strike_query(self, performer_id: str, time: float) -> "StrikeQuery | None":
        """Search query of a performer's pose at ``time`` and the chosen target; None if one of them is missing."""
        project, panel = self.bench.document.project, self.panel
        target, posed = panel.target.value, self._posed(performer_id, time)
        if not isinstance(target, StrikeTarget) or target.id == performer_id or posed is None:
            return None
        centre = target.place(project, self.bench.live.result, time)
        if centre is None:
            return None
        place = Placement.of(project.performers[performer_id]).to_motion(centre)
        limbs = [panel.limb.value] if isinstance(panel.limb.value, Limb) else []
        kinds = [panel.kind.value] if isinstance(panel.kind.value, Kind) else []
        return replace(posed, place=place, limbs=limbs, kinds=kinds)


def show_strikes(bench: Workbench) -> None:
    """Show the Strikes panel, and search strikes for the active performer if a target is chosen."""
    bench.window.striking.search()
    bench.window.show_dock("Strikes")


def strike_chosen(bench: Workbench) -> bool:
    """True if a strike of the list is selected."""
    return bench.window.striking.panel.place is not None


def label_strike(bench: Workbench) -> None:
    """Open the form of the selected strike, to correct its label."""
    bench.window.show_dock("Strikes")
    striking = bench.window.striking
    if striking.panel.place is not None:
        striking.label(striking.panel.place)


def _unused_files(report: "IndexReport | None", folder: Path) -> str:
    """Sentence about the files that could not be indexed; empty if all could."""
    if report is None:
        return f"Adding {folder.name} was cancelled. Clips indexed by then are in the library."
    if not report.problems:
        return ""
    name, problem = next(iter(report.problems.items()))
    others = len(report.problems) - 1
    more = f" {others} other file{'s' if others > 1 else ''} could not be used either." if others else ""
    named = problem if problem.startswith(Path(name).name) else f"{Path(name).name}: {problem}"
    return (
        f"{named}{more} Everything else was added."
        if report.read + report.kept > len(report.problems)
        else named + more
    )


def _state(clip: "LibraryClip") -> str:
    label = clip.label
    seconds = (label.last - label.first) / clip.take.motion.frame_rate
    said = "confirmed" if label.confirmed else "proposed"
    return ", ".join([f"{seconds:.2f} s", f"hits with the {label.segment}", said, *label.tags])
