"""3D viewport: the adapted performers of the document, for picking and dragging."""

from collections.abc import Callable, Container
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QEvent, QPoint, QPointF, QRect, QRectF, Qt, Signal
from PySide6.QtGui import QKeyEvent, QMouseEvent, QPainter, QResizeEvent, QWheelEvent
from PySide6.QtWidgets import QWidget

from studio.core.body.sticks import bone_pairs
from studio.core.constraints.base import BodyPoint
from studio.core.constraints.kinds import CONSTRAINT_KINDS
from studio.core.stage.saved_camera import CameraPlacement
from studio.document import colours
from studio.document.document import Document
from studio.document.dragging import POSE_MIME, STRIKE_MIME
from studio.engine.empty_stage import empty_words
from studio.engine.live_interface import Live
from studio.engine.posed_performer import PosedPerformer, displayed_stage, has_new_frames, pose_of, resting_performers
from studio.engine.prop_places import PropPose, props_at
from studio.engine.target_context import TargetContext
from studio.viewport import mouse
from studio.viewport.auto_framing import AutoFraming
from studio.viewport.body_points import body_joints, place_of_joint
from studio.viewport.camera import NAMED_VIEWS, FloatArray, OrbitCamera
from studio.viewport.camera_animation import CameraAnimation
from studio.viewport.canvas import Canvas
from studio.viewport.chips import Chips
from studio.viewport.corrected_joint import CorrectedJoint
from studio.viewport.dropping import BodyDrops
from studio.viewport.follow_camera import FollowCamera
from studio.viewport.frame_stats import FrameStats
from studio.viewport.framing import selected_points
from studio.viewport.gizmo import ARROW_PIXELS, Space, arrow_pixels
from studio.viewport.gizmo_painting import GizmoPainter
from studio.viewport.handles import Handle, constraint_handles
from studio.viewport.mouse_gestures import ViewportGesture, nudge
from studio.viewport.movables import Movable
from studio.viewport.navigation import DEFAULT_NAVIGATION
from studio.viewport.new_constraints import NewConstraintContext, constraint_here
from studio.viewport.nudge_keys import nudge_by_key
from studio.viewport.onion_skins import Ghost, OnionSkins, kept_ghosts, onion_ghosts
from studio.viewport.opening import clear_of_overlays, is_another_size, opening_camera
from studio.viewport.optical_recording import MarkerFrame, RecordingView, recorded_of
from studio.viewport.overlay import Overlay, twin_heads
from studio.viewport.paths import StagePath, prop_paths, selection_rings, stage_paths, trail_keys
from studio.viewport.picking import PickedJoint
from studio.viewport.preview import Preview
from studio.viewport.problem import Problem, worst_problem
from studio.viewport.selected_movable import AnyGizmo, gizmo_of, selected_movable
from studio.viewport.shots import View
from studio.viewport.snap_steps import DEFAULT_STEPS
from studio.viewport.turntable import TURN_RATE, Turntable

if TYPE_CHECKING:
    from studio.viewport.stage_picture import StageScene

WHEEL_ZOOM = 1.15
SKIN_NOTICE = "Click a point on the skin of a character. Esc cancels."


class Viewport(Canvas):
    """3D view and editor of a document's stage; its methods are called by menus and shortcuts."""

    picked_changed = Signal()
    options_changed = Signal()
    """Emitted when a chip is switched on or off."""

    def __init__(self, document: Document, live: Live, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._document, self._live = document, live
        self.tool = "move"
        self.gizmo_space = Space.WORLD
        self.snap_steps = DEFAULT_STEPS
        self.navigation = DEFAULT_NAVIGATION
        self.onion_skins = OnionSkins()
        self.fits_activation = True
        """True if new constraints act while the body stays, False if for the whole clip."""
        self._kept: list[tuple[str, float]] = []
        self._nudged = "z"
        self.posed: dict[str, PosedPerformer] = {}
        self.resting: dict[str, PosedPerformer] = {}
        self.props: dict[str, PropPose] = {}
        self._progress = ("", 0.0)
        self.joint_picked: PickedJoint | None = None
        self.joint_hovered: PickedJoint | None = None
        self.picks_skin = False
        """True if the next click picks a point on a skin."""
        self.gizmo_part_hovered: str | None = None
        self.body_hovered: str | None = None
        """The performer under the mouse, whose joints can be seen."""
        self.gesture: ViewportGesture | None = None
        self.recording = RecordingView(self.redraw)
        self._recorded: MarkerFrame | None = None
        self._bones = False
        self._framed = False
        self._opening: OrbitCamera | None = None
        self._opening_size = self.view_size
        self.covered_below: Callable[[], float] = lambda: 0.0
        """Pixels along the lower edge that a sentence covers; the camera frames bodies above it."""
        self._played = document.project.motions_played
        self._posed_in = document.project
        self._follower, self._newcomers = FollowCamera(), AutoFraming()
        self._pace = FrameStats()
        self.preview = Preview(self)
        self.strike_drops, self.pose_drops = (BodyDrops(self, document, kind) for kind in (STRIKE_MIME, POSE_MIME))
        self._problem: Problem | None = None
        self._glide = CameraAnimation(self.set_camera, self)
        self._turntable = Turntable(self._turn, self)
        self._chips = Chips(
            self,
            {
                "view": self.toggle_parallel,
                "shading": self.toggle_bones,
                "space": self.next_gizmo_space,
                "correct": self._correcting_changed,
                "ghost": self.redraw,
                "onion": self.redraw,
                "trails": self.redraw,
                "follow": self.redraw,
                "markers": self.redraw,
                "problem": self.go_to_problem,
                "constrain": self.add_constraint_at_pick,
            },
        )
        self._chips.connect_toggles(self.options_changed.emit)
        self._links = self._connect()
        self._tell_problem()
        self.setAccessibleName("3D viewport")
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setMouseTracking(True)
        self.setFocus()

    def stop(self) -> None:
        """Release VTK, and disconnect from document and solver. May be called twice."""
        self.cancel_gesture()
        self._glide.stop()
        self._turntable.stop()
        self.preview.show(None)
        for link in self._links:
            link()
        self._links = []
        super().stop()

    # What menus, shortcuts and chips call

    def frame_all(self) -> None:
        """Frame all performers."""
        points = [pose.points for pose in (self.posed | self.resting).values()]
        points += [self._recorded.points] if self._recorded else []
        if points:
            self._frame(np.concatenate(points))

    def frame_selection(self) -> None:
        """Frame the selection; without one, all performers."""
        points = selected_points(self._document, self.posed, self.props, self.handles())
        self._frame(np.concatenate(points)) if points else self.frame_all()

    def set_view(self, name: str) -> None:
        """Animate the camera to a named view: ``perspective``, ``front``, ``side`` or ``top``."""
        azimuth, elevation = NAMED_VIEWS[name]
        self._glide.start(self.camera, replace(self.camera, azimuth=azimuth, elevation=elevation))

    def set_tool(self, name: str) -> None:
        """Set the tool: ``select`` hides the gizmo; ``move``, ``rotate`` and ``scale`` show it on the selection."""
        self.tool = name
        self._chips.show_gizmo_space(self.gizmo_space.value, name in ("move", "rotate"))
        self.update()

    def next_gizmo_space(self) -> None:
        """Switch the gizmo to the next orientation."""
        spaces = list(Space)
        self.gizmo_space = spaces[(spaces.index(self.gizmo_space) + 1) % len(spaces)]
        self.set_tool(self.tool)

    def choose_nudged_axis(self, axis: str) -> None:
        """Set the axis of the gizmo along or about which the selection is nudged."""
        self._nudged = axis
        self.gizmo_part_hovered = axis
        self.update()

    def nudge(self, sign: float) -> None:
        """Move, rotate or resize the selection along the chosen axis by one snapping step in the direction ``sign``."""
        movable, gizmo = self.movable(), self.gizmo()
        if movable is not None and gizmo is not None and self.gesture is None:
            nudge(self._document, movable, gizmo, self._nudged, sign, self.snap_steps)

    def toggle_parallel(self) -> None:
        """Toggle between perspective and orthographic projection."""
        self.set_camera(replace(self.camera, parallel=not self.camera.parallel))
        self._chips.show_parallel(self.camera.parallel)

    @property
    def placement(self) -> CameraPlacement:
        """Placement of the camera, to be saved."""
        return self.camera.placement

    def look_through(self, placement: CameraPlacement) -> None:
        """Animate the camera to a placement."""
        self._glide.start(self.camera, OrbitCamera.at(placement))
        self._chips.show_parallel(placement.parallel)

    def set_turntable(self, on: bool) -> None:
        """Start or stop the turntable."""
        if on:
            self._turntable.start()
        else:
            self._turntable.stop()
        self.redraw()

    def _turn(self, angle: float) -> None:
        self.set_camera(replace(self.camera, azimuth=self.camera.azimuth + angle))

    @property
    def turntable(self) -> bool:
        """True while the turntable runs."""
        return self._turntable.running

    def toggle_bones(self) -> None:
        """Toggle between skin and bones."""
        self._bones = not self._bones
        self._chips.shading.set_text("Bones" if self._bones else "Skin")
        self.redraw()

    def set_ghost_shown(self, shown: bool) -> None:
        """Show or hide the ghost of the active performer's source motion."""
        self._chips.ghost.setChecked(shown)
        self.redraw()

    @property
    def ghost_shown(self) -> bool:
        """True if the source ghost is on."""
        return self._chips.ghost.isChecked()

    @property
    def correcting(self) -> bool:
        """True if the gizmo poses the picked joint on a correction layer."""
        return self._chips.correct.isChecked()

    def set_correcting(self, correcting: bool) -> None:
        """Turn pose correction on, so that the gizmo poses the picked joint, or off."""
        self._chips.correct.setChecked(correcting)
        self._correcting_changed()

    def _correcting_changed(self) -> None:
        if self.correcting and self.tool not in ("move", "rotate"):
            self.set_tool("rotate")
        self.redraw()

    def set_onion_shown(self, shown: bool) -> None:
        """Show or hide the onion skins of the selected performers."""
        self._chips.onion.setChecked(shown)
        self.redraw()

    @property
    def onion_shown(self) -> bool:
        """True if onion skins are on."""
        return self._chips.onion.isChecked()

    def set_onion_skins(self, skins: OnionSkins) -> None:
        """Set the number of skins and their distance in frames."""
        self.onion_skins = skins
        self.redraw()

    def keep_ghosts(self) -> None:
        """Add ghosts of the selected performers, or of the active one, at the playhead."""
        now = self._document.playhead.time
        self._kept += [(key, now) for key in self._ghosted() if (key, now) not in self._kept]
        self.redraw()

    @property
    def kept_ghosts(self) -> tuple[tuple[str, float], ...]:
        """Performer id and stage time in seconds of each added ghost."""
        return tuple(self._kept)

    def clear_ghosts(self) -> None:
        """Remove all added ghosts."""
        self._kept.clear()
        self.redraw()

    def set_following(self, following: bool) -> None:
        """Turn following of the active performer by the camera on or off."""
        self._chips.follow.setChecked(following)
        self.redraw()

    @property
    def following(self) -> bool:
        """True if the camera follows a character."""
        return self._chips.follow.isChecked()

    def set_markers_shown(self, shown: bool) -> None:
        """Show or hide the recorded markers, force plates and forces of the active performer."""
        self._chips.markers.setChecked(shown)
        self.redraw()

    @property
    def markers_shown(self) -> bool:
        """True if recorded markers are on."""
        return self._chips.markers.isChecked()

    def go_to_problem(self) -> None:
        """Go to the frame of the worst problem, and select its performer and constraint."""
        if self._problem is not None:
            self._document.playhead.set_time(self._problem.residual.time)
            performer, constraint = self._problem.performer_id, self._problem.constraint_id
            self._document.selection.set(("performers", performer), ("constraints", constraint))

    def pick(self, picked: PickedJoint | None) -> None:
        """Highlight a joint and select its performer; None removes the highlight."""
        self._set_picks_skin(False)
        if picked != self.joint_picked:
            self.joint_picked = picked
            self.picked_changed.emit()
        if picked is not None:
            self._document.selection.set(("performers", picked.performer_id))
        self.redraw()

    def begin_skin_pick(self) -> None:
        """Let the next click pick a point on the skin."""
        self.cancel_gesture()
        self._set_picks_skin(True)

    def _set_picks_skin(self, on: bool) -> None:
        if on != self.picks_skin:
            self.picks_skin = on
            self.setCursor(Qt.CursorShape.CrossCursor if on else Qt.CursorShape.ArrowCursor)
            self.update()

    def add_constraint_at_pick(self, kind: str = "position") -> str | None:
        """Add and select a constraint of ``kind`` that keeps the current state of the picked joint, or of the
        performer. Returns its id, or None if a joint is needed and none is picked.
        """
        picked = self.joint_picked
        performer_id = picked.performer_id if picked else self._document.active_performer_id or ""
        pose = self.posed.get(performer_id)
        project = self._document.project  # the motion may have gone from it since the last picture
        if (
            pose is None
            or pose.motion_id not in project.motions
            or (picked is None and CONSTRAINT_KINDS[kind].value.shown.picks)
        ):
            return None
        context, joint = TargetContext(project, self.posed, pose), picked.joint if picked else None
        constraint = constraint_here(NewConstraintContext(context, joint, self.fits_activation), kind)
        shown = context.as_played(constraint)
        constraint_id = self._document.add("constraints", constraint, f"Add '{shown.name}'")
        self.pick(None)
        self._document.selection.set(("performers", performer_id), ("constraints", constraint_id))
        return constraint_id

    def show_progress(self, words: str, share: float) -> None:
        """Show the text and progress (0 to 1) of a task; an empty text if none runs."""
        self._progress = (words, share)
        if not self.posed:
            self.update()

    @property
    def notice(self) -> str:
        """Text over the view: while a skin point is to be picked, or on an empty stage the running task or what to do
        next.
        """
        if self.picks_skin:
            return SKIN_NOTICE
        if self.posed or self._recorded is not None:
            return ""
        return self._progress[0] or empty_words(self._document.project)

    def cancel_gesture(self) -> bool:
        """Cancel the current drag, or picking on the skin; False if there is none."""
        if self.picks_skin:
            self._set_picks_skin(False)
            return True
        gesture, self.gesture = self.gesture, None
        if gesture is not None:
            gesture.cancel()
            self.redraw()
        return gesture is not None

    def finish_gesture(self) -> None:
        """Finish the current drag, if any, and keep its edit."""
        gesture, self.gesture = self.gesture, None
        if gesture is not None:
            gesture.finish()
            self.redraw()

    def set_camera(self, camera: OrbitCamera) -> None:
        """Set the camera; automatic framing ends."""
        self._framed = self._framed or bool(self.posed)
        super().set_camera(camera)

    # Places on the widget

    def widget_point(self, position: FloatArray) -> QPointF:
        """Position on the widget of a stage point (3,)."""
        return QPointF(*self.camera.project(position, self.view_size)[0][0])

    def gizmo(self) -> AnyGizmo | None:
        """Gizmo on the selection for the current camera; None if there is none."""
        movable = self.movable()
        if movable is None:
            return None
        pose = self.posed.get(self._document.active_performer_id or "")
        pixels = arrow_pixels(self.camera.height(pose.points, self.view_size)) if pose else ARROW_PIXELS
        return gizmo_of(self.tool, movable, self.gizmo_space, self.camera, self.view_size, pixels)

    def movable(self) -> Movable | None:
        """Object that the gizmo edits; None if there is none."""
        picked = self.joint_picked
        pose = self.posed.get(picked.performer_id) if picked else None
        if self.correcting and picked is not None and pose is not None and pose.motion_id is not None:
            return CorrectedJoint(self._document, picked.performer_id, pose, picked.joint)
        return selected_movable(self._document, self.posed, picking=picked is not None)

    def handles(self, only: Container[str] | None = None) -> list[Handle]:
        """Constraint handles; with ``only``, of some constraints."""
        return constraint_handles(self._document.project, self.posed, self._document.active_performer_id, only)

    # Drawing

    @property
    def moving(self) -> bool:
        """True while something moves, so that images are not anti-aliased."""
        return (
            self._document.playhead.playing
            or self._live.play.running
            or self.is_interacting
            or self._glide.moving
            or self.turntable
        )

    @property
    def is_interacting(self) -> bool:
        """True during a drag."""
        return self.gesture is not None or self._live.interactive

    def bring_up_to_date(self, scene: "StageScene") -> None:
        """Pose every visible performer at the playhead."""
        self._live.solve_frame(self._document.playhead.time)
        project, time, self.posed = displayed_stage(self._document, self._live)
        self._posed_in = project
        self.resting = resting_performers(project, self.posed)
        if not self._framed and (self.posed or self.resting):
            # Results come one by one: the view is settled when every body is there.
            expected = (key for key, one in project.performers.items() if one.visible and one.clips)
            self._framed = bool(self.posed) and all(self._live.reported_motion(key) is not None for key in expected)
            self._open()
        bodies, size = self.posed | self.resting, self.view_size
        self._glide.start(self.camera, self._newcomers.camera_for(project.performers, bodies, self.camera, size))
        self._recorded = self.recording.at(self._document, self.posed, shown=self.markers_shown)
        active = self._document.active_performer_id or ""
        pose = self.posed.get(active)
        self.camera = self._follower.moved(self.camera, active, pose if self.following else None)
        self._chips.show_recorded(recorded_of(self._document, pose) is not None)
        self.props = props_at(project, self.posed, time)
        scene.sync(
            project,
            bodies,
            self.props,
            self._bones,
            self._paths(),
            self.moving and not self._glide.moving,
            self._ghosts(time),
        )
        self._pace.note_posed(self._live.asked_at(active) if self._live.interactive else None)
        self._chips.show_work(len(self.posed), self._pace.text, all(map(self._live.is_eased, self.posed)))

    def _ghosted(self) -> list[str]:
        """Ids of the visible selected performers; without any, of the active one."""
        selected = self._document.selection.of("performers") or (self._document.active_performer_id or "",)
        return [key for key in selected if key in self.posed]

    def _ghosts(self, time: float) -> list[Ghost]:
        if self._live.play.running:
            return []  # its motion is not known ahead
        project, rate = self._posed_in, self._document.playhead.frame_rate
        poses = {key: self.posed[key] for key in self._ghosted()} if self.onion_shown else {}
        return [
            *onion_ghosts(project, poses, self.onion_skins, time, rate),
            *kept_ghosts(project, self.posed, self._kept),
        ]

    def _reported_changed(self) -> None:
        if not self._live.interactive:
            self._tell_problem()
        if not self._framed:
            self.schedule_redraw()

    def _tell_problem(self) -> None:
        """Show the worst problem, from the same results as the error strips of the timeline."""
        self._problem = worst_problem(self._document.project, self._live.reported_motion)
        self._chips.show_problem(self._problem.sentence if self._problem else None)

    def _open(self) -> None:
        self._opening_size = self.view_size
        posed, parallel = self.posed or self.resting, self.camera.parallel
        self.camera = self._opening = opening_camera(
            posed, self.view_size, parallel, self._document.project.ground, self.covered_below()
        )
        self._newcomers.note_performers(self._document.project.performers)

    def paint_over(self, painter: QPainter) -> None:
        """Paint handles, joints and gizmo."""
        self._pace.note_painted(self.moving)
        overlay = Overlay(painter, self.camera, self.view_size)
        ghost = self._ghost()
        if ghost is not None:
            overlay.ghost(ghost.points, bone_pairs(ghost.motion.morphology.layout))
        self.preview.paint(overlay)
        point, constraints = self._trail_point(), self._document.selection.of("constraints")
        if point is not None and constraints:
            overlay.trail_keys(trail_keys(self._posed_in, self.posed, point, constraints[-1]))
        if self._recorded is not None:
            overlay.markers(self._recorded, self.recording.marked, self.recording.named)
        chosen = set(self._document.selection.of("constraints"))
        gazes = {key for key, each in self._document.project.constraints.items() if each.kind == "look_at"}
        only = chosen | gazes if self.moving else None  # more cost pictures and hide bodies
        overlay.handles(self.handles(only), chosen)
        overlay.names(twin_heads(self.posed), self._chips.view.geometry().bottom())
        under = self.posed.get(self.body_hovered or "") if self.gesture is None else None
        if under is not None:
            overlay.joints(under.points[[joint.index for joint in body_joints(under.motion.morphology.layout)]])
        for picked, strong in ((self.joint_hovered, False), (self.joint_picked, True)):
            pose = self.posed.get(picked.performer_id) if picked else None
            if picked is not None and pose is not None:
                overlay.joint(place_of_joint(pose, picked.joint), colours.STAGE_SELECTED_HANDLE, strong)
        gizmo = self.gizmo()
        room = QRect()
        if gizmo is not None and gizmo.in_sight:
            GizmoPainter(painter).paint(gizmo, self.gizmo_part_hovered, self.gesture)
            low, high = gizmo.extent
            room = QRectF(QPointF(*low), QPointF(*high)).toAlignedRect()
        self._chips.make_room(room)
        if self.notice:
            overlay.notice(self.notice, self._progress[1] if self._progress[0] else None)
        self._place_constrain_chip()

    def _place_constrain_chip(self) -> None:
        picked, chip = self.joint_picked, self._chips.constrain
        pose = self.posed.get(picked.performer_id) if picked else None
        chip.setVisible(pose is not None and self.gesture is None and not self.correcting)
        if picked is not None and pose is not None:
            chip.set_text(f"Constrain {picked.joint.name}  (C)")
            beside_gizmo = QPoint(16, -34 if self.gizmo() is None else 26)
            chip.stand_at(self.widget_point(place_of_joint(pose, picked.joint)).toPoint() + beside_gizmo)

    def _ghost(self) -> PosedPerformer | None:
        performer_id = self._document.active_performer_id or ""
        pose = self.posed.get(performer_id)
        if not self.ghost_shown or pose is None or pose.motion_id is None:
            return None
        source = self._live.source(pose.motion_id)
        return pose_of(self._posed_in, performer_id, source, self._document.playhead.time) if source else None

    def _paths(self) -> list[StagePath]:
        project, selection = self._posed_in, self._document.selection  # live, an edit may be ahead of the picture
        paths = stage_paths(project, self.posed, self._trail_point(), smooth=not self.moving)
        paths += selection_rings(project, self.posed, selection.of("performers"))
        paths += prop_paths(project, selection.of("props"), self._document.playhead.time)
        return [*paths, *(self._recorded.paths if self._recorded else ())]

    @property
    def view(self) -> View:
        """Display settings of the current view, without what serves only editing."""
        active, now = self._document.active_performer_id, self._document.playhead.time
        ghost_of, followed = active if self.ghost_shown else None, active if self.following else None
        turning = TURN_RATE if self.turntable else 0.0
        return View(self.camera, self.view_size[1], self._bones, self._trail_point(), ghost_of, followed, now, turning)

    def _trail_point(self) -> BodyPoint | None:
        """Point whose motion trails are drawn: that of the selected constraint, else the picked joint; None without
        either.
        """
        if not self._chips.trails.isChecked():
            return None
        selected = self._document.selection.of("constraints")
        constraint = self._document.shown_project.constraints.get(selected[-1]) if selected else None
        if constraint is not None:
            return constraint.point
        return self.joint_picked.joint.point if self.joint_picked else None

    def _frame(self, points: FloatArray) -> None:
        framed = self.camera.framing(points, self.view_size)
        self._glide.start(self.camera, clear_of_overlays(framed, points, self.view_size, self.covered_below()))

    # What changes elsewhere

    def _connect(self) -> list[Callable[[], object]]:
        document = self._document
        links = (
            (document.entity_changed, self._entity_changed),
            (document.project_opened, self._project_opened),
            (document.selection.changed, self._selection_changed),
            (document.playhead.changed, self._playhead_moved),
            (document.playhead.playing_changed, self.redraw),
            (self._live.adapted, self._adapted),
            (self._live.reported_changed, self._reported_changed),
            (self._live.interactive_changed, self.redraw),
            (self._live.play.stepped, self.redraw),
            (self._live.play.running_changed, self.redraw),
        )
        for signal, slot in links:
            signal.connect(slot)
        return [partial(signal.disconnect, slot) for signal, slot in links]

    def _entity_changed(self, collection: str, entity_id: str) -> None:
        if self._document.project.get(collection, entity_id) is None:
            self.finish_gesture()  # what was dragged may be gone
        before, self._played = self._played, self._document.project.motions_played
        if any(motions.isdisjoint(before.get(key, motions)) for key, motions in self._played.items()):
            self._framed = False  # all that plays now is new, and may be elsewhere
        if not self._live.interactive:
            self._tell_problem()  # what was told before this edit is not known any more
        self.redraw()

    def _project_opened(self) -> None:
        self._played, self._framed = self._document.project.motions_played, False
        self._kept.clear()
        self._tell_problem()
        self.finish_gesture()  # there is nothing left to take back
        self.pick(None)
        self.set_correcting(False)

    def _selection_changed(self) -> None:
        picked = self.joint_picked
        if picked is not None and ("performers", picked.performer_id) not in self._document.selection:
            self.pick(None)
        self.redraw()

    def _playhead_moved(self, time: float) -> None:
        """Redraw only if another frame or project is shown, since playback ticks faster than captures."""
        project = self._document.project
        if project is not self._posed_in or not self.posed or has_new_frames(project, self.posed, time):
            self.redraw()

    def _adapted(self, performer_id: str) -> None:
        shown, newer = self.posed.get(performer_id), self._live.shown_frame(performer_id)
        # While dragging, the rest of the clip comes after the frame on show.
        if not self._live.interactive or shown is None or newer is None or not shown.has_same_pose(newer):
            self.schedule_redraw()

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Lay out the chips again."""
        super().resizeEvent(event)
        self._chips.fit(event.size().width())
        if self.camera == self._opening and self.posed and is_another_size(self.view_size, self._opening_size):
            self._open()
        self._chips.show_problem(self._problem.sentence if self._problem else None)

    # Mouse and keys

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Start a drag, or select."""
        self.setFocus(Qt.FocusReason.MouseFocusReason)
        self._glide.stop()
        self._turntable.stop()
        mouse.begin_gesture(self, self._document, self._live, event)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Continue the drag, or update the highlight."""
        mouse.update_hover(self, event)

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """Finish the drag."""
        self.finish_gesture()

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        """Constrain the joint under the mouse."""
        self.mousePressEvent(event)
        if self.gesture is None and self.joint_picked is not None and not self.correcting:
            self.add_constraint_at_pick()

    def leaveEvent(self, event: QEvent) -> None:
        """Remove the highlight."""
        self.joint_hovered = self.gizmo_part_hovered = self.body_hovered = None
        self.update()

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Zoom about the mouse."""
        self._glide.stop()
        where, turn = event.position(), event.angleDelta().y() / 120.0
        self.set_camera(self.camera.zoomed_at(WHEEL_ZOOM**turn, where.x(), where.y(), self.view_size))
        event.accept()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Cancel a drag or the picked joint with Esc; nudge the selection."""
        if event.key() == Qt.Key.Key_Escape and (self.cancel_gesture() or self.joint_picked is not None):
            self.pick(None)
        elif not self.nudge_by_key(event):
            super().keyPressEvent(event)

    def nudge_by_key(self, event: QKeyEvent) -> bool:
        """Choose an axis, or nudge along it; returns False for other keys."""
        return nudge_by_key(self, event)
