"""Next and previous problem of the stage: the playhead goes to each one, the worst first."""

from PySide6.QtCore import QObject

from studio.app.workbench import Workbench
from studio.engine.problem_search import ProblemSearch
from studio.engine.quality_summary import FoundProblem, SummaryRow
from studio.panels.message_strip import Lifetime

NO_PROBLEMS_MESSAGE = "No problems: all constraints are met; no foot sliding, penetration or pops."


class ProblemTour(QObject):
    """Controller that goes from problem to problem. A solved problem leaves the list, and the worst remaining one is
    next.
    """

    def __init__(self, bench: Workbench, search: ProblemSearch, parent: QObject) -> None:
        super().__init__(parent)
        self._bench, self._search = bench, search
        self._at: tuple[str, str | None, str] | None = None
        self._step = 0
        search.found.connect(self._found)

    def go(self, step: int) -> None:
        """Go to the next problem (``step`` 1) or the previous one (-1), as soon as the stage is measured."""
        self._step = step
        if self._search.request_summary():
            self._found()

    def show(self, row: SummaryRow, aspect: str) -> None:
        """Go to the worst frame of one aspect of a row of the problem table; without such a frame, to the row's
        constraint.
        """
        finding = row.findings.get(aspect)
        if finding is not None:
            self._bench.document.playhead.pause()
            self._bench.document.playhead.set_time(finding.time)
        items = [("performers", row.performer_id)]
        if row.constraint_id is not None:
            items.append(("constraints", row.constraint_id))
        if all(self._bench.document.project.get(*item) is not None for item in items):
            self._bench.document.selection.set(*items)

    def _found(self) -> None:
        step, self._step = self._step, 0
        problems = self._search.problems
        if step == 0:
            return
        if not problems:
            self._at = None
            self._bench.inform(NO_PROBLEMS_MESSAGE, until=Lifetime.EDITED)
            return
        places = {each.key: index for index, each in enumerate(problems)}
        at = places.get(self._at) if self._at is not None else None
        self._go_to(problems, 0 if at is None else (at + step) % len(problems))

    def _go_to(self, problems: tuple[FoundProblem, ...], index: int) -> None:
        problem = problems[index]
        self._at = problem.key
        self.show(problem.row, problem.aspect)
        self._bench.post_message(
            f"Problem {index + 1} of {len(problems)}. {problem.sentence}.", until=Lifetime.SELECTED
        )
