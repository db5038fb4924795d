"""A simulator that is stepped by hand, seen in a browser while it is stepped."""

from collections.abc import Callable
from threading import RLock

import numpy as np

from ..arguments import number
from ..errors import SimulationError
from ..events import Event
from ..shapes import colour, floor_height, rgb
from ..simulation import Simulator
from . import meshes
from .elements import FRICTION_COLOURS, REFERENCE_COLOUR, WORDS, in_words
from .poses import arm_names, arm_poses

_INSIDE = 0.002  # the reference is smaller: where both are at one place the robot is seen [m]
_LOOK = 1.0  # without a motion, how far to look for the next event [s]


class LiveView:
    """A page that shows a simulator as it is now; buttons on it step the simulator.

    The page is served on this machine: open `url`. Whoever steps the simulator itself calls
    `update` then.

    Parameters
    ----------
    simulator : Simulator
        What is shown and stepped.
    dt : float
        Step of the button [s]; it can be changed on the page.
    port : int
        Where to serve; if it is taken, the next free one.

    Attributes
    ----------
    simulator : Simulator
    url : str

    Raises
    ------
    ValueError, TypeError
        What was wrong, what was expected, what arrived.
    ImportError
        If viser is not installed.
    """

    def __init__(self, simulator: Simulator, *, dt: float = 0.01, port: int = 8080) -> None:
        if not isinstance(simulator, Simulator):
            raise TypeError(f"simulator: expected a Simulator, got {simulator!r}")
        dt = number("dt", dt, "s")
        if dt <= 0.0:
            raise ValueError(f"dt: expected a positive time, got {dt:g} s")
        if isinstance(port, bool) or not isinstance(port, int):
            raise TypeError(f"port: expected a number from 0 to 65535, got {port!r}")
        if not 0 <= port <= 65535:
            raise ValueError(f"port: expected a number from 0 to 65535, got {port}")
        try:
            import viser
        except ImportError as error:
            raise ImportError('a live view needs viser: pip install "manutec-r3[live]"') from error
        self.simulator = simulator
        self._lock = RLock()  # buttons are pressed in threads of their own
        self._server = viser.ViserServer("127.0.0.1", port, "Manutec r3", verbose=False)
        self.url = f"http://127.0.0.1:{self._server.get_port()}"
        self._build_scene()
        self._build_controls(dt)
        self.update()

    def _build_scene(self) -> None:
        scene, robot = self._server.scene, self.simulator.robot
        scene.set_up_direction("+z")
        self._server.initial_camera.position = (3.9, 2.75, 1.1)
        self._server.initial_camera.look_at = (0.0, -0.1, 0.15)
        self._server.initial_camera.fov = 0.6
        scene.add_grid(
            "/floor",
            infinite_grid=True,
            cell_size=0.25,
            cell_color=(226, 230, 234),
            section_color=(196, 203, 210),
            position=(0, 0, floor_height(robot)),
        )
        names = ["robot"] if self.simulator.motion is None else ["robot", "reference"]
        self._arms = {
            name: [scene.add_frame(f"/{name}/{arm}", show_axes=False) for arm in arm_names(robot)]
            for name in names
        }
        self._joints = []
        for arm, parts in meshes.arms(robot).items():
            place = "arm_6/load" if arm == "load" else arm
            for material, mesh in parts:
                node = f"{place}/{material}"
                handle = scene.add_mesh_simple(
                    f"/robot/{node}", mesh.vertices, mesh.faces, color=colour(material)
                )
                if material == "branch":
                    self._joints.append(handle)
                if "reference" in names and arm != "base":
                    scene.add_mesh_simple(
                        f"/reference/{node}",
                        mesh.vertices - _INSIDE * mesh.vertex_normals,
                        mesh.faces,
                        color=rgb(REFERENCE_COLOUR),
                        opacity=0.35,
                        cast_shadow=False,
                    )

    def _build_controls(self, dt: float) -> None:
        gui = self._server.gui
        gui.configure_theme(show_logo=False)
        gui.main_panel.dock_right()
        self._said = gui.add_markdown("")
        self._dt = gui.add_number("step [s]", dt, min=1e-6, step=1e-3)
        gui.add_button("step").on_click(lambda _: self._try(lambda: self.step(self._dt.value)))
        gui.add_button("to the next event").on_click(lambda _: self._try(self._next_event))
        self._table = gui.add_markdown("")

    def _next_event(self) -> None:
        soon = None if self.simulator.motion is not None else self.simulator.time + _LOOK
        if self.step_to_event(soon) is None:
            self._said.content = "No more events."

    def _try(self, action: Callable[[], object]) -> None:
        """Do what a button asks for; the page says why, if it cannot be done."""
        try:
            action()
        except (SimulationError, ValueError) as error:
            self.update()
            self._said.content = f"**{error}**"

    def step(self, dt: float) -> list[Event]:
        """Advance the simulator by `dt` [s], and show it; see `Simulator.step`."""
        with self._lock:
            events = self.simulator.step(dt)
            self.update(events)
            return events

    def step_to_event(self, t_end: float | None = None) -> Event | None:
        """Advance the simulator to the next event, and show it; see `Simulator.step_to_event`."""
        with self._lock:
            event = self.simulator.step_to_event(t_end)
            self.update([event] if event else [])
            return event

    def update(self, events: list[Event] | None = None) -> None:
        """Show the simulator as it is now, and the events [Event, ...] that it has met."""
        with self._lock, self._server.atomic():
            now = self.simulator
            angles = {"robot": now.joint_angle, "reference": now.reference_angle}
            for name, arms in self._arms.items():
                (poses,) = arm_poses(now.robot, angles[name][None])
                for arm, pose in zip(arms, poses, strict=True):
                    arm.position, arm.wxyz = pose[:3], np.roll(pose[3:], 1)
            if now.robot.has_real_gears:
                for joint, branch in zip(self._joints, now.branches["friction"], strict=False):
                    joint.color = rgb(FRICTION_COLOURS[branch + 1])
            told = [f"{event.time:.6f} s: {in_words(event)}" for event in events or ()]
            self._said.content = "\n".join(f"* {line}" for line in told)
            self._table.content = self._axes()

    def _axes(self) -> str:
        """Return a table of the axes in Markdown."""
        now = self.simulator
        real = now.robot.has_real_gears
        rows = [
            f"**{now.time:.6f} s**",
            "",
            "| axis | torque [N m] | error [mrad] | friction |",
            "|---|---|---|---|",
        ]
        for axis in range(now.robot.n_axes):
            error = 1e3 * now.control_error[axis]
            friction = WORDS["friction"][now.branches["friction"][axis] + 1] if real else "none"
            told = "none" if np.isnan(error) else f"{error:.2f}"
            rows.append(f"| {axis + 1} | {now.motor_torque[axis]:.3f} | {told} | {friction} |")
        return "\n".join(rows)

    def close(self) -> None:
        """Stop serving."""
        self._server.stop()

    def __enter__(self) -> "LiveView":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
