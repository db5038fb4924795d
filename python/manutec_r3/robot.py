"""The robot and its load: what is simulated."""

from collections.abc import Mapping, Sequence
from dataclasses import KW_ONLY, dataclass, fields
from functools import cached_property
from typing import Any, Literal

import numpy as np

from . import _core, html
from .arguments import Floats, PerAxis, floats, number, per_axis
from .motion import Motion
from .tables import TABLES, Rows, replaced

# Arguments of a robot that are options of its model.
_OPTIONS = (
    "controller",
    "rotor_coupling",
    "gear_damping",
    "stiction",
    "stiffness",
    "arm",
    "creep_rate",
    "voltage_limit",
)
# What they are if nothing is given is up to the model.
_OPTIONS_OF_MODEL = ("rotor_coupling", "arm", "voltage_limit")


@dataclass(frozen=True)
class Load:
    """A point mass at the tip.

    Parameters
    ----------
    mass : float
        0 to 15 kg; the default is no load.
    position : (float, float, float)
        Where it is, in the frame of arm 6 [m]: at most 0.1 m off the axis, 0.15 to 0.25 m along it.
    bounds : bool
        False to accept any position and any mass that is not negative.

    Raises
    ------
    ValueError, TypeError
        What was wrong (argument, unit), what was expected, what arrived.

    Examples
    --------
    >>> r3.Load(15.0)
    Load(mass=15.0, position=(0.0, 0.0, 0.25), bounds=True)
    >>> r3.Load(20.0)
    Traceback (most recent call last):
    ValueError: load.mass: expected 0 to 15 kg, got 20 kg
    """

    mass: float
    position: tuple[float, float, float]
    bounds: bool

    def __init__(
        self, mass: float = 0.0, position: Floats = (0.0, 0.0, 0.25), bounds: bool = True
    ) -> None:
        kilograms = number("load.mass", mass, "kg")
        coordinates = floats("load.position", position, "m")
        if coordinates.shape != (3,):
            raise ValueError(
                f"load.position: expected three coordinates [m], got shape {coordinates.shape}"
            )
        if not isinstance(bounds, bool):
            raise TypeError(f"load.bounds: expected True or False, got {bounds!r}")
        object.__setattr__(self, "mass", kilograms)
        object.__setattr__(self, "position", tuple(coordinates.tolist()))
        object.__setattr__(self, "bounds", bounds)
        _ = self._compiled

    @cached_property
    def _compiled(self) -> _core.Load:
        return _core.Load(self.mass, self.position, self.bounds)

    def __getstate__(self) -> dict:
        return {name: value for name, value in self.__dict__.items() if name != "_compiled"}


@dataclass(frozen=True, eq=False, repr=False)
class Robot:
    """One of the models of the Manutec r3, with its load and its options.

    The models are the four of DLR (report section 4, Table 4) and the two of the robot's descendant
    in the Modelica Standard Library. Immutable, picklable, comparable.

    Parameters
    ----------
    model : {1, 2, 3, 4, "full-robot", "one-axis"}
        1: six arms, ideal gears; 2: three moving arms, ideal gears; 3: six arms, gears with
        elasticity, damping and backlash (axes 1 to 3) and friction (all axes); 4: the same with
        three moving arms. Each with controllers and motors. ``"full-robot"``: the Modelica variant
        with six arms, other data, simpler controllers and motors, gears without backlash;
        ``"one-axis"``: its axis 2 with a load inertia at the joint.
    load : Load, optional
        Default: none; of ``"full-robot"`` its own, 15 kg.
    controller : {"continuous", "sampled", "external", None}
        Position controllers that are evaluated at every instant; or every 8 ms, with their output
        held; or the user's own, whose output is the input `Simulator.command`; or neither
        controllers nor motor dynamics: then motor torques are inputs.
    rotor_coupling : {"full", "simplified"} or a sequence of n_axes of them
        Rotors are carried by the preceding arm and spin there, with all inertial and gyroscopic
        terms; or they are inertias about axes fixed in space (specification section 6). Default:
        full, behind the elastic gears of axes 1 to 3 in models 3 and 4 simplified; the Modelica
        variant: simplified.
    gear_damping : {"parallel", "contact"}
        The damper of an elastic gear acts also inside the backlash, or in contact only.
    stiction : {"exact", "stiff-spring", "stiff-damper"}
        What holds sticking axes 4 to 6: a constraint torque, or, as the report approximates it, a
        stiff spring or damper on the rotor (specification section 11).
    stiffness : float
        Of these springs [N m/rad] or dampers [N m s/rad], motor side.
    arm : {"lumped", "six-arm"}
        Models 2 and 4: the rounded data of R3M2SI for arm 3 with the blocked wrist (default), or
        the data of the six arms.
    creep_rate : float
        A rotor of axes 1 to 3 that slides more slowly than this counts as sticking if friction can
        hold it [rad/s]; 0 switches that off.
    voltage_limit : float, optional
        Limit on the output of the rate controllers [V]: it stays there while it would go further,
        and the integral of the controller follows it. Default: none, as in the report.
    table_1, table_2, table_3 : mapping, optional
        Numbers that take the place of those of Tables 1 to 3, by the names that `parameters` shows:
        ``table_1={"K_V": 0.35}`` for all axes, ``table_2={"b": {2: 0.05}}`` for axis 2,
        ``table_3={"arms": {6: {"I33": 0.01}}}``.

    Raises
    ------
    ValueError, TypeError
        What was wrong, what was expected, what arrived: argument, or table, symbol and axis.

    Examples
    --------
    >>> robot = r3.Robot(model=3, load=r3.Load(mass=15.0), controller="sampled")
    >>> robot.n_axes, robot.n_states, robot.n_indicators
    (6, 66, 42)
    >>> robot.state_names[0], robot.state_units[0], robot.indicator_names[0]
    ('joint_angle[1]', 'rad', 'dead_zone_upper[1]')

    Other numbers than those of the tables, and the arm alone:

    >>> robot.replace(table_2={"b": {2: 0.05}}).parameters["table_2"]["b"][1]
    0.05
    >>> r3.Robot(model=2).inverse_dynamics([0.0, 0.5, 0.0], np.zeros(3), np.zeros(3)).round(1)
    array([   0. , -253.6,  -57.3])
    """

    model: int | str = 3
    load: Load = None  # type: ignore[assignment] # becomes that of the model
    controller: Literal["continuous", "sampled", "external"] | None = "continuous"
    _: KW_ONLY
    rotor_coupling: str | Sequence[str] = None  # type: ignore[assignment] # as the load
    gear_damping: Literal["parallel", "contact"] = "parallel"
    stiction: Literal["exact", "stiff-spring", "stiff-damper"] = "exact"
    stiffness: float = 1e7
    arm: Literal["lumped", "six-arm"] | None = None
    creep_rate: float = 1e-9
    voltage_limit: float | None = None
    table_1: Mapping[str, Any] | None = None
    table_2: Mapping[str, Any] | None = None
    table_3: Mapping[str, Any] | None = None

    def __post_init__(self) -> None:
        if isinstance(self.model, np.integer):
            object.__setattr__(self, "model", int(self.model))
        default_load = _core.default_load(self.model)  # refuses what is no model
        if self.load is None:
            load = Load(default_load.mass, default_load.position, default_load.bounds)
            object.__setattr__(self, "load", load)
        if not isinstance(self.load, Load):
            raise TypeError(f"load: expected a Load, got {self.load!r}")
        for name, unit in (("stiffness", "N m/rad, N m s/rad"), ("creep_rate", "rad/s")):
            object.__setattr__(self, name, number(name, getattr(self, name), unit))
        if self.voltage_limit is not None:
            limit = number("voltage_limit", self.voltage_limit, "V")
            object.__setattr__(self, "voltage_limit", limit)
        for name in TABLES:
            if isinstance(rows := getattr(self, name), Mapping):
                object.__setattr__(self, name, Rows(rows))
        for name in _OPTIONS_OF_MODEL:
            object.__setattr__(self, name, self._compiled.options[name])

    @cached_property
    def _compiled(self) -> _core.Robot:
        options = {name: getattr(self, name) for name in _OPTIONS}
        given = {k: v for k, v in options.items() if v is not None or k not in _OPTIONS_OF_MODEL}
        changes = {name: getattr(self, name) for name in TABLES}
        tables = replaced(_core.default_tables(self.model), changes, _core.table_units(self.model))
        return _core.Robot(self.model, self.load._compiled, given, tables)

    def __getstate__(self) -> dict:
        return {name: value for name, value in self.__dict__.items() if name != "_compiled"}

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Robot) and self._compiled == other._compiled

    def __hash__(self) -> int:
        return hash((self.model, self.load, self.controller))

    def __repr__(self) -> str:
        usual = Robot(self.model)
        shown = [f"model={self.model!r}"]
        shown += [
            f"{option.name}={getattr(self, option.name)!r}"
            for option in fields(self)[1:]
            if getattr(self, option.name) != getattr(usual, option.name)
        ]
        return f"Robot({', '.join(shown)})"

    def _repr_html_(self) -> str:
        load = self.load
        place = ", ".join(f"{x:g}" for x in load.position)
        soft = {"stiffness": f"{self.stiffness:g} N m/rad, N m s/rad"}
        tables = {name: getattr(self, name) for name in TABLES}
        return html.facts(
            self.title,
            {
                "moving axes": self.n_axes,
                "states": self.n_states,
                "indicators": self.n_indicators,
                "load": f"{load.mass:g} kg at ({place}) m" if load.mass else "none",
                "controller": self.controller or "none",
                "rotor coupling": ", ".join(np.atleast_1d(self.rotor_coupling)),
                "gear damping": self.gear_damping,
                "stiction": self.stiction,
                **(soft if self.stiction != "exact" else {}),
                "arm": self.arm,
                "creep rate": f"{self.creep_rate:g} rad/s",
                "voltage limit": f"{self.voltage_limit:g} V" if self.voltage_limit else "none",
                **{f"own {name.replace('_', ' ')}": rows for name, rows in tables.items() if rows},
            },
        )

    @property
    def title(self) -> str:
        """What it is called in pictures and tables."""
        variants = {"full-robot": "full robot", "one-axis": "one axis"}
        if self.model in variants:
            return f"Manutec r3, {variants[self.model]} of the Modelica variant"
        return f"Manutec r3, model {self.model}"

    def replace(self, **changes: Any) -> "Robot":
        """Return a robot that differs in some arguments of the constructor.

        Parameters
        ----------
        **changes
            Those arguments. Entries of tables are added to those that this robot has replaced
            already.

        Raises
        ------
        ValueError, TypeError
            As the constructor.
        """
        names = [option.name for option in fields(self)]
        for name in changes:
            if name not in names:
                raise TypeError(f"replace: expected one of {', '.join(names)}, got {name!r}")
        same = {name: getattr(self, name) for name in names}
        if "model" in changes and changes["model"] != self.model:
            # What belongs to a model does not outlive it.
            for name in ("rotor_coupling", "arm", *TABLES):
                same[name] = None
            if self.load == Robot(self.model).load:
                same["load"] = None
        else:
            # What is replaced on one axis leaves the others as they are.
            rows = {name: changes[name] for name in TABLES if changes.get(name) is not None}
            tables = replaced(self.parameters, rows, _core.table_units(self.model))
            for name in rows:
                whole = {symbol: tables[name][symbol] for symbol in rows[name]}
                changes[name] = {**(same[name] or {}), **whole}
        return Robot(**(same | changes))

    # --- sizes and names ------------------------------------------------------------------------

    @property
    def n_axes(self) -> int:
        """Number of moving axes: 6, 3 or 1."""
        return self._compiled.n_axes

    @property
    def has_real_gears(self) -> bool:
        """Friction on all axes, elasticity on axes 1 to 3: all but models 1 and 2."""
        return self._compiled.has_real_gears

    @property
    def n_states(self) -> int:
        """Order of the dynamic system."""
        return self._compiled.n_states

    @property
    def n_indicators(self) -> int:
        """Number of indicator functions, as Table 4 counts them."""
        return self._compiled.n_indicators

    @property
    def state_names(self) -> tuple[str, ...]:
        """Name of each state, such as ``joint_angle[1]``: quantity by quantity, axis fastest."""
        return tuple(
            f"{name}[{axis + 1}]"
            for name, _, _, _, size in self._compiled.state_groups
            for axis in range(size)
        )

    @property
    def state_units(self) -> tuple[str, ...]:
        """Unit of each state."""
        return tuple(u for _, u, _, _, size in self._compiled.state_groups for _ in range(size))

    @property
    def state_nominals(self) -> np.ndarray:
        """Magnitude of each state, by which tolerances are scaled."""
        return np.concatenate([nominals for _, _, nominals, _, _ in self._compiled.state_groups])

    @property
    def indicator_names(self) -> tuple[str, ...]:
        """Name of each indicator function, such as ``dead_zone_upper[1]``."""
        return tuple(
            f"{name}_{side}[{axis + 1}]"
            for name, size in self._compiled.indicator_groups
            for axis in range(size // 2)
            for side in ("upper", "lower")
        )

    @property
    def parameters(self) -> dict[str, dict[str, Any]]:
        """Tables 1 to 3 of this robot as data.

        ``table_1``: controllers and motors, ``table_2``: gears, ``table_3``: arms and rotors. Keys
        are the report's symbols, values are in SI units, one per axis. The Modelica variant has
        other controllers and motors in ``table_1``.
        """
        return self._compiled.tables

    # --- states ---------------------------------------------------------------------------------

    def rest_state(self, motion: Motion | None = None, start: str | None = None) -> np.ndarray:
        """State at rest at the beginning of a motion (specification section 4).

        Parameters
        ----------
        motion : Motion, optional
            Default: rest at zero angles.
        start : {"rotor", "arm"}, optional
            What is on the reference: the rotors, as the controllers demand, so that arms 1 to 3
            sag; or the arms. Default: the rotors; in the Modelica variant the arms.

        Returns
        -------
        ndarray (n_states,)

        Raises
        ------
        ValueError
            If a motor would need more than its torque limit, or the motion does not fit the robot.
        """
        if start is None:
            start = _core.default_start(self._compiled)
        if not isinstance(start, str):
            raise TypeError(f"start: expected 'rotor' or 'arm', got {start!r}")
        return self._compiled.rest_state(self._core_motion(motion), start)

    def state_from(
        self,
        joint_angle: Floats,
        joint_rate: Floats | None = None,
        rotor_angle: Floats | None = None,
        rotor_rate: Floats | None = None,
        motor_torque: Floats | None = None,
    ) -> np.ndarray:
        """State vector from quantities of the axes; all other states are zero.

        Parameters
        ----------
        joint_angle, joint_rate : sequence of n_axes floats
            Joint side [rad, rad/s]; rates default to zero.
        rotor_angle, rotor_rate : sequence of n_axes floats, optional
            Motor side [rad, rad/s]; default: gear ratio times the joint. Where the gear is rigid
            nothing else is accepted.
        motor_torque : sequence of n_axes floats, optional
            Torque of the motors [N m], motor side; default zero.

        Returns
        -------
        ndarray (n_states,)

        Raises
        ------
        ValueError, TypeError
            What was wrong (argument, axis, unit), what was expected, what arrived.
        """
        given = {
            "joint_rate": (joint_rate, "rad/s"),
            "rotor_angle": (rotor_angle, "rad"),
            "rotor_rate": (rotor_rate, "rad/s"),
            "motor_torque": (motor_torque, "N m"),
        }
        arrays = [
            None if value is None else per_axis(name, value, unit, self.n_axes)
            for name, (value, unit) in given.items()
        ]
        angle = per_axis("joint_angle", joint_angle, "rad", self.n_axes)
        return self._compiled.state_from(angle, *arrays)

    def _core_motion(self, motion: Motion | None) -> _core.Motion | None:
        """Return the core's motion, if this robot can follow it."""
        if motion is None:
            return None
        if not isinstance(motion, Motion):
            raise TypeError(f"motion: expected a Motion, say a Quintic or Hold, got {motion!r}")
        self._compiled.check_motion(motion._compiled)
        return motion._compiled

    # --- the arm alone: ideal gears, rotors coupled as the robot says -----------------------------

    def forward_dynamics(
        self,
        q: PerAxis,
        qd: PerAxis,
        tau: PerAxis,
        *,
        algorithm: Literal["composite", "articulated"] = "composite",
    ) -> np.ndarray:
        """Joint accelerations of the arm with ideal gears and without friction (spec section 6).

        Parameters
        ----------
        q, qd, tau : array_like (..., n_axes)
            Angles [rad], rates [rad/s] and torques at the joints [N m].
        algorithm : {"composite", "articulated"}
            Composite inertias and a linear solve, or the report's articulated bodies, O(n). Both
            agree to roundoff.

        Returns
        -------
        ndarray (..., n_axes)
            Accelerations [rad/s^2].
        """
        functions = {
            "composite": _core.forward_dynamics,
            "articulated": _core.articulated_forward_dynamics,
        }
        if algorithm not in tuple(functions):
            raise ValueError(f"algorithm: expected 'composite' or 'articulated', got {algorithm!r}")
        return self._per_pose(
            functions[algorithm], q=(q, "rad"), qd=(qd, "rad/s"), tau=(tau, "N m")
        )

    def inverse_dynamics(self, q: PerAxis, qd: PerAxis, qdd: PerAxis) -> np.ndarray:
        """Torques at the joints of the arm with ideal gears and without friction (spec section 6).

        Parameters
        ----------
        q, qd, qdd : array_like (..., n_axes)
            Angles [rad], rates [rad/s] and accelerations [rad/s^2].

        Returns
        -------
        ndarray (..., n_axes)
            Torques [N m].
        """
        return self._per_pose(
            _core.inverse_dynamics, q=(q, "rad"), qd=(qd, "rad/s"), qdd=(qdd, "rad/s^2")
        )

    def mass_matrix(self, q: PerAxis) -> np.ndarray:
        """Mass matrix of the arm with ideal gears, rotors included (spec section 6).

        Parameters
        ----------
        q : array_like (..., n_axes)
            Angles [rad].

        Returns
        -------
        ndarray (..., n_axes, n_axes)
            Inertias at the joints [kg m^2].
        """
        angles = per_axis("q", q, "rad", self.n_axes)
        matrices = _core.mass_matrix(self._compiled, angles.reshape(-1, self.n_axes))
        return matrices.reshape(*angles.shape, self.n_axes)

    def link_poses(self, q: PerAxis) -> np.ndarray:
        """Frames of the world (z up, origin on axes 1 to 3) and of arms 1 to 6.

        Parameters
        ----------
        q : array_like (..., n_axes)
            Angles [rad]; axes that are braked are at zero.

        Returns
        -------
        ndarray (..., 7, 4, 4)
            Homogeneous transformations, frame to world [m].
        """
        angles = per_axis("q", q, "rad", self.n_axes)
        all_axes = np.zeros((*angles.shape[:-1], 6))
        all_axes[..., : self.n_axes] = angles
        return _core.link_poses(self._compiled, all_axes.reshape(-1, 6)).reshape(
            *angles.shape[:-1], 7, 4, 4
        )

    def load_position(self, q: PerAxis) -> np.ndarray:
        """Where the load is in the world.

        Parameters
        ----------
        q : array_like (..., n_axes)
            Angles [rad].

        Returns
        -------
        ndarray (..., 3)
            Positions [m].
        """
        arm_6 = self.link_poses(q)[..., 6, :, :]
        return arm_6[..., :3, :3] @ np.array(self.load.position) + arm_6[..., :3, 3]

    # --- the gears alone --------------------------------------------------------------------------

    def sliding_friction(self, rotor_rate: PerAxis) -> np.ndarray:
        """Friction of the gears while they slide (NL3, spec section 5.1, Table 2).

        Also of a robot with ideal gears: what those of Table 2 would take.

        Parameters
        ----------
        rotor_rate : array_like (..., n_axes)
            Motor side [rad/s].

        Returns
        -------
        ndarray (..., n_axes)
            Torques against the rate, motor side [N m]; none at rate zero, where friction is what it
            takes to stick.
        """
        rate = per_axis("rotor_rate", rotor_rate, "rad/s", self.n_axes)
        torque = np.empty_like(rate)
        for axis, points in enumerate(self.parameters["table_2"]["friction"][: self.n_axes]):
            rates, levels = np.transpose(points)
            size = np.abs(rate[..., axis])
            last_slope = (levels[-1] - levels[-2]) / (rates[-1] - rates[-2])
            beyond = np.maximum(size - rates[-1], 0.0)
            torque[..., axis] = np.interp(size, rates, levels) + last_slope * beyond
        return np.sign(rate) * torque

    def _per_pose(self, function: Any, **arguments: tuple[PerAxis, str]) -> np.ndarray:
        arrays = [
            per_axis(name, value, unit, self.n_axes) for name, (value, unit) in arguments.items()
        ]
        try:
            fitting = np.broadcast_arrays(*arrays)
        except ValueError:
            shapes = ", ".join(
                f"{name} {a.shape}" for name, a in zip(arguments, arrays, strict=True)
            )
            raise ValueError(f"expected shapes that fit each other, got {shapes}") from None
        flat = [np.reshape(array, (-1, self.n_axes)) for array in fitting]
        return function(self._compiled, *flat).reshape(fitting[0].shape)
