"""Base class of the forms of states and transitions, the parts of a behaviour."""

from collections.abc import Callable
from typing import Generic, TypeVar

from studio.core.constraints.base import BodyPoint
from studio.core.constraints.follow import FollowPerformer, FollowProp
from studio.core.errors import StudioError
from studio.core.stage.behaviour import Behaviour, State, Transition
from studio.core.stage.behaviour_target import PELVIS_POINT, BehaviourTarget, FollowPartner
from studio.core.stage.project import Project
from studio.document.behaviour_commands import BehaviourEdit, behaviour_with, edit_behaviour
from studio.panels.behaviour.words import point_choices, point_name
from studio.panels.editor import Editor
from studio.panels.fields import Choice, Section

PartT_co = TypeVar("PartT_co", State, Transition, covariant=True)


class PartEditor(Editor[PartT_co], Generic[PartT_co]):
    """Form of a state or transition of a behaviour."""

    @property
    def behaviour_id(self) -> str:
        """Id of the behaviour that contains the part; empty if the part was deleted."""
        return behaviour_with(self.document.project, self.collection, self.entity_id) or ""

    @property
    def behaviour(self) -> Behaviour:
        """Behaviour that contains the part, in the current project."""
        return self.document.project.behaviours[self.behaviour_id]

    def edit(self, edit: BehaviourEdit, text: str) -> bool:
        """Change the behaviour by ``edit``; False if the edit is invalid, which is reported as a message."""
        try:
            edit_behaviour(self.document, self.behaviour_id, edit, text, self._gesture)
        except StudioError as error:
            self.document.problem_reported.emit(str(error))
            self.refresh()
            return False
        return True

    def depends_on(self, collection: str, entity_id: str) -> bool:
        """True for behaviours, and for performers, props and motions, whose names the form shows."""
        return collection in ("behaviours", "performers", "props", "motions")


class PointChoice(Choice):
    """List of the points of a body; a point that is not in the list is added when it is shown."""

    def __init__(self, name: str, put: Callable[[BodyPoint], None]) -> None:
        super().__init__(name, point_choices())
        self.value_chosen.connect(put)

    def show_point(self, point: BodyPoint) -> None:
        """Select ``point`` in the list."""
        if not self.offers(point):
            self.add(point, point_name(point).capitalize())
        self.show_value(point)


class TargetChoiceRows:
    """Form rows for the target of a condition or reaction and the followed point on it; choices are passed to
    ``put``.
    """

    def __init__(self, section: Section, label: str, put: Callable[[BehaviourTarget], None]) -> None:
        self._whom: BehaviourTarget = FollowPartner()
        self._put = put
        self._choice = Choice(label, ())
        self._choice.value_chosen.connect(self._chosen)
        section.add_row(label, self._choice)
        self._point = PointChoice("Followed point", lambda point: put(_at(self._whom, point)))
        self._caption = section.add_row("Followed point", self._point)

    def show_whom(self, whom: BehaviourTarget, project: Project, with_point: bool = True) -> None:
        """Show a target and its point. Props have no points, and ``with_point`` False hides the row."""
        self._whom = whom
        point = getattr(whom, "point", PELVIS_POINT)
        choices: list[tuple[object, str]] = [(("partner", ""), "Partner")]
        choices += [(("performers", key), each.name) for key, each in project.performers.items()]
        choices += [(("props", key), each.name) for key, each in project.props.items()]
        self._choice.offer(choices)
        self._choice.show_value(_who(whom))
        self._point.show_point(point)
        for widget in (self._point, self._caption):
            widget.setVisible(with_point and not isinstance(whom, FollowProp))

    def _chosen(self, value: tuple[str, str]) -> None:
        kind, key = value
        point = getattr(self._whom, "point", PELVIS_POINT)
        made: dict[str, BehaviourTarget] = {
            "partner": FollowPartner(point),
            "performers": FollowPerformer(key, point),
            "props": FollowProp(key),
        }
        self._put(made[kind])


def _who(whom: BehaviourTarget) -> tuple[str, str]:
    match whom:
        case FollowPerformer():
            return "performers", whom.performer_id
        case FollowProp():
            return "props", whom.prop_id
    return "partner", ""


def _at(whom: BehaviourTarget, point: BodyPoint) -> BehaviourTarget:
    return FollowPerformer(whom.performer_id, point) if isinstance(whom, FollowPerformer) else FollowPartner(point)
