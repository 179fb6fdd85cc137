"""The library's strikes in the window: folders are indexed, a strike is searched for the active body, and played."""

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from PySide6.QtCore import Qt

from studio.app.file_dialogs import ask_folder
from studio.app.importing import ReadMotion, add_motion, read_motion
from studio.app.workbench import Workbench
from studio.cli.library_options import library_folder
from studio.core.constraints.activation import ActivationCurve
from studio.core.constraints.follow import FollowProp
from studio.core.constraints.position import PositionConstraint
from studio.core.errors import StudioError
from studio.core.placement import Placement
from studio.core.project import Clip, Performer, new_id
from studio.core.scope import Scope
from studio.core.solver.rows import timing_of
from studio.engine.performance import posed_performers
from studio.engine.props import prop_at
from studio.io.importing import GUESS_ALL
from studio.library.clips import Kind, Limb, hit_point
from studio.panels.strikes import EMPTY, NO_TARGET, NOTHING, READY, Strikes
from studio.resources_folder import bundled_strikes_folder

# Here and below: what searches loads the solver, which takes longer than a window.
if TYPE_CHECKING:
    from studio.library.indexing import IndexReport
    from studio.library.library import Library
    from studio.library.searching import Asked, Result


class Striking:
    """Stands between the panel, the library on disk and the document."""

    def __init__(self, bench: Workbench, folder: Path | None = None) -> None:
        self.bench, self.folder = bench, folder or library_folder()
        limbs = [(limb, limb.words.capitalize()) for limb in Limb]
        self.panel = Strikes(bench.document, limbs, [(kind, kind.capitalize()) for kind in Kind])
        self.library: Library | None = None
        self.found: list[Result] = []
        self._sought: tuple[Asked, Placement] | None = None
        self.panel.folder_wanted.connect(lambda: ask_folder(bench, "Add to the motion library", self.add_folder))
        self.panel.wanted.connect(self.search)
        self.panel.chosen.connect(self.play)
        self.panel.looked_at.connect(self.look_at)

    def add_folder(self, folder: Path) -> int:
        """Index a folder in the background; returns the task."""

        def work(progress: Any) -> "tuple[IndexReport, Library]":
            from studio.library.catalogue import Catalogue
            from studio.library.indexing import index
            from studio.library.library import Library

            with Catalogue(self.folder) as catalogue:
                return index(catalogue, [folder], progress), Library.of(catalogue)

        def done(answer: "tuple[IndexReport, Library]") -> None:
            report, self.library = answer
            self._show()
            if report.problems:
                name, problem = next(iter(report.problems.items()))
                more = (
                    f" {len(report.problems) - 1} others could not be used either." if len(report.problems) > 1 else ""
                )
                self.bench.said.emit(f"{Path(name).name}: {problem}{more} All else was taken.")

        task: int = self.bench.runner.run(f"Indexing {folder.name}", work, done)
        return task

    def search(self) -> None:
        """Look for strikes; the library is read from disk the first time."""
        if self.library is not None:
            self._search(self.library)
            return

        def work(progress: Any) -> "Library":
            from studio.library.catalogue import Catalogue
            from studio.library.indexing import index
            from studio.library.library import Library

            with Catalogue(self.folder) as catalogue:
                if not catalogue.files():  # a new library begins with the strikes that come with the studio
                    index(catalogue, [bundled_strikes_folder()], progress)
                return Library.of(catalogue)

        def done(library: "Library") -> None:
            self.library = library
            self._search(library)

        self.bench.runner.run("Opening the motion library", work, done)

    def play(self, place: int) -> None:
        """Play a result from the playhead on, driven to the target: one undo step."""
        self.look_at(-1)
        document, found = self.bench.document, self.found[place]
        performer_id, prop_id = document.active_performer_id, self.panel.target_id
        known = [key for key, path in self.bench.sources.items() if str(path) == found.clip.take.path]
        if performer_id is None or prop_id is None:
            return
        capture_id = next((key for key in known if key in document.project.captures), None)
        if capture_id is not None:
            self._put(found, performer_id, prop_id, capture_id)
            return
        path = Path(found.clip.take.path)

        def done(read: ReadMotion) -> None:
            self._put(found, performer_id, prop_id, read)

        self.bench.runner.run(f"Opening {path.name}", lambda progress: read_motion(path, GUESS_ALL, progress), done)

    def look_at(self, place: int) -> None:
        """Show a result as a ghost where the body was when it was searched for; none when ``place`` is below 0."""
        if self.bench.viewport is None:  # the window has no 3D view
            return
        if not 0 <= place < len(self.found) or self._sought is None:
            self.bench.viewport.preview.show(None)
            return
        from studio.library.searching import outline
        from studio.viewport.figure import bone_pairs

        asked, where = self._sought
        points = where.to_stage(outline(self.found[place], asked))
        self.bench.viewport.preview.show(points, bone_pairs(asked.body.layout))

    def _search(self, library: "Library") -> None:
        from studio.library.searching import find

        asked, active = self._asked(), self.bench.document.active_performer_id
        self.found = [] if asked is None else find(library, asked)
        if asked is not None and active is not None:
            self._sought = asked, Placement.of(self.bench.document.project.performers[active])
        self._show(NO_TARGET if asked is None else READY if self.found else NOTHING)

    def _show(self, hint: str = READY) -> None:
        texts = [(each.clip.name, ", ".join(each.reasons)) for each in self.found]
        self.panel.show_results(texts, hint if self.library and self.library.clips else EMPTY)

    def _asked(self) -> "Asked | None":
        """The active body as it is at the playhead, and the target; None while one of them is missing."""
        from studio.core.normalized.encode import encode
        from studio.library.searching import Asked

        document, panel = self.bench.document, self.panel
        performer_id, prop = document.active_performer_id, document.project.props.get(panel.target_id or "")
        adapted = self.bench.live.result(performer_id) if performer_id else None
        if prop is None or performer_id is None or adapted is None:
            return None
        performer = document.project.performers[performer_id]
        frame = round(timing_of(document.project, performer).frame_at(document.playhead.time)) - adapted.first_frame
        row = slice(frame, frame + 1)
        body = adapted.morphology
        pose = encode(adapted.positions[row], adapted.rotations[row], body, adapted.frame_rate)
        time = document.playhead.time
        posed = posed_performers(document.project, self.bench.live.result, time)
        centre = prop_at(document.project, posed, panel.target_id or "", time)
        place = Placement.of(performer).to_motion(centre.place)
        limbs = [panel.limb.value] if isinstance(panel.limb.value, Limb) else []
        kinds = [panel.kind.value] if isinstance(panel.kind.value, Kind) else []
        return Asked(pose, body, place, limbs, kinds)

    def _put(self, found: "Result", performer_id: str, prop_id: str, source: ReadMotion | str) -> None:
        from studio.library.striking import EASED_IN

        document, now = self.bench.document, self.bench.document.playhead.time
        if performer_id not in document.project.performers or prop_id not in document.project.props:
            raise StudioError("The body or the target is gone meanwhile. Search again.")
        text = f"Strike {document.project.props[prop_id].name}"
        with document.group(text):
            if isinstance(source, ReadMotion):
                capture_id = add_motion(document, source, text)
                self.bench.sources[capture_id] = Path(found.clip.take.path)
            else:
                capture_id = source
            motions = document.project.motions.items()
            motion_id = next(key for key, motion in motions if motion.capture_id == capture_id)
            performer = document.project.performers[performer_id]
            clip = Clip(motion_id, found.start, found.clip.label.last, now, id=new_id(), ease=EASED_IN * found.seconds)
            kept = clips_until(
                performer, now, {each.motion_id: document.project.frame_rate_of(each) for each in performer.clips}
            )
            document.replace("performers", performer_id, replace(performer, clips=(*kept, clip)), text)
            document.add("constraints", aimed(found, clip, prop_id, self._body(performer)), text)

    def _body(self, performer: Performer) -> Any:
        return self.bench.document.project.characters[performer.character_id].morphology


def show_strikes(bench: Workbench) -> None:
    """Open the panel, and look for strikes of the active body if there is a target."""
    docks = bench.window.docks
    opening = not docks["Strikes"].isVisible()
    docks["Strikes"].show()
    docks["Strikes"].raise_()
    if opening:
        both = [docks["Strikes"], docks["Inspector"]]
        bench.window.resizeDocks(both, [3, 1], Qt.Orientation.Vertical)
    bench.window.striking.search()


def clips_until(performer: Performer, time: float, frame_rates: dict[str, float]) -> tuple[Clip, ...]:
    """What a performer plays before ``time`` (seconds): clips that go on are cut there."""
    kept = []
    for clip in performer.clips:
        if clip.start >= time:
            continue
        rate = frame_rates[clip.motion_id] * clip.speed
        once = (clip.last - clip.first) / rate
        whole = int((time - clip.start) / once) if once > 0.0 else clip.repeats
        if whole >= clip.repeats or clip.repeats > 1:
            kept.append(replace(clip, repeats=max(min(whole, clip.repeats), 1)))
        else:
            kept.append(replace(clip, last=clip.first + int((time - clip.start) * rate)))
    return tuple(kept)


def aimed(found: "Result", clip: Clip, prop_id: str, body: Any) -> PositionConstraint:
    """What drives a clip to a prop: nothing at its start, all of it at the hit, in seconds of its motion."""
    from studio.library.striking import CHAIN, HOLD

    label, rate = found.clip.label, found.clip.take.motion.frame_rate
    hit = found.hit / rate
    end = max(min(hit + found.seconds, label.last / rate), hit + 2 * HOLD)
    curve = ActivationCurve(found.start / rate, hit - HOLD, hit + HOLD, end)
    point = hit_point(label.limb, label.segment, body)
    name = f"{label.limb.words.capitalize()} {label.kind}"
    return PositionConstraint(
        clip.motion_id, name, point, CHAIN, 0, curve, target=FollowProp(prop_id), scope=Scope(clip_id=clip.id)
    )
