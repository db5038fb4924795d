"""Scenarios: an experiment in one TOML file, the robot, its motion and how it is simulated."""

import tomllib
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field, replace
from functools import cached_property
from importlib.resources import files
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import Any, Self

from . import html, plain
from .arguments import hint
from .errors import SimulationError
from .experiment import Method
from .motion import Motion
from .result import Result
from .robot import Load, Robot
from .simulation import Simulator, simulate
from .tables import Rows

_FOLDER = files(__package__) / "scenarios"


def scenarios() -> list[str]:
    """Return the names of the scenarios that come with the package."""
    return sorted(file.name.removesuffix(".toml") for file in _FOLDER.iterdir())


@dataclass(frozen=True)
class Scenario:
    """An experiment with the robot.

    Attributes
    ----------
    name : str
        What it is called. Two scenarios that differ in nothing else are equal.
    robot : Robot
        What is simulated.
    motion : Motion
        The reference of its joint angles. In a file: any but a `FunctionMotion`.
    t_end : float
        End of the simulation [s]; it begins at 0.
    description : str
        One line about it.
    start : {"rotor", "arm"} or tuple of float, optional
        What rests on the reference at first, or the state to start from; see `simulate`.
    rtol : float, optional
        Tolerance relative to the states' nominal values; default: the method's own.
    method : {"exponential", "erk", "bdf"}, optional
        Integration method; default: the robot's own.
    inputs : mapping
        What acts from outside: ``motor_torque``, ``command``, ``tip_force``, ``brakes``; see
        `simulate`.
    record : mapping
        What the result has, and where it ends: ``times``, ``list_samples``, ``list_limits``,
        ``enforce_limits``; see `simulate`.
    published : mapping of str to (float, float)
        Lowest and highest value of ``joint_angle`` [rad], ``control_error`` [rad] and
        ``motor_torque`` [N m] over all axes, as far as they are published.
    source : str
        The TOML text that it was loaded from.

    Notes
    -----
    It cannot be changed, and may be hashed, pickled and compared.

    Examples
    --------
    >>> scenario = r3.Scenario.load("figure9")
    >>> scenario.robot.load.mass, round(scenario.motion.duration, 3), scenario.t_end
    (15.0, 1.279, 1.5)
    >>> result = scenario.run(rtol=1e-8)
    >>> result.status
    'completed'

    One of one's own, written to a file:

    >>> lighter = scenario.replace(robot=scenario.robot.replace(load=r3.Load(5.0)))
    >>> lighter.save("lighter.toml")
    >>> r3.Scenario.load("lighter.toml") == lighter
    True
    """

    name: str = field(compare=False)
    robot: Robot
    motion: Motion | None
    t_end: float
    description: str = ""
    start: str | Sequence[float] | None = None
    rtol: float | None = None
    method: Method | None = None
    inputs: Mapping[str, Any] = field(default_factory=dict)
    record: Mapping[str, Any] = field(default_factory=dict)
    published: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    source: str = field(default="", repr=False, compare=False)

    def __post_init__(self) -> None:
        for name in ("inputs", "record", "published"):
            object.__setattr__(self, name, Rows(getattr(self, name)))
        if self.start is not None and not isinstance(self.start, str):
            object.__setattr__(self, "start", tuple(map(float, self.start)))

    @classmethod
    def load(cls, name_or_path: str | Path) -> Self:
        """Load a scenario of the package by its name, or any other from its TOML file.

        Parameters
        ----------
        name_or_path : str or Path
            One of `scenarios()`, or a path that ends in ``.toml``.

        Returns
        -------
        Scenario

        Raises
        ------
        ValueError
            If no scenario has this name, or if the file does not describe one: the message names
            the file, the key, what was expected and what arrived.
        OSError
            If the file cannot be read.
        """
        name, file = _find(name_or_path)
        content = file.read_bytes()
        with _at(file):
            scenario = cls._of(name, content.decode())
            with suppress(SimulationError):  # a start that no run can begin with is left to `run`
                Simulator(**scenario._arguments)
        return scenario

    @classmethod
    def _of(cls, name: str, source: str) -> Self:
        return cls(name, **_settings(tomllib.loads(source)), source=source)

    @cached_property
    def toml(self) -> str:
        """Its file: the text that it was loaded from, or one that says the same of what it is now.

        Raises
        ------
        TypeError
            If a motion or an input is a function: a file cannot hold it.
        """
        if self.source and self._of(self.name, self.source) == self:
            return self.source
        import tomli_w

        return tomli_w.dumps(_data(self))

    def save(self, path: str | Path) -> None:
        """Write its TOML file: loaded again, it is equal.

        Parameters
        ----------
        path : str or Path
            A path that ends in ``.toml``.

        Raises
        ------
        ValueError
            If the path ends otherwise.
        TypeError
            If a motion or an input is a function: a file cannot hold it.
        OSError
            If the file cannot be written.
        """
        path = Path(path)
        if path.suffix != ".toml":
            raise ValueError(f"path: expected one that ends in .toml, got {str(path)!r}")
        path.write_text(self.toml, encoding="utf-8")

    def replace(self, **changes: Any) -> Self:
        """Return a scenario that differs in some attributes.

        Parameters
        ----------
        **changes
            These attributes.
        """
        return replace(self, **changes)

    def run(self, **overrides: Any) -> Result:
        """Simulate.

        Parameters
        ----------
        **overrides
            Arguments of `simulate` that take the place of the scenario's own, such as ``rtol``,
            or that it does not have, such as ``times``.

        Returns
        -------
        Result

        Raises
        ------
        ValueError, TypeError, SimulationError
            As `simulate`.
        """
        arguments = {"t_end": self.t_end} | self._arguments | dict(self.record) | overrides
        try:
            text = self.toml
        except TypeError:  # there are functions that no file can hold
            text = ""
        return simulate(**arguments, _scenario=text)

    def _repr_html_(self) -> str:
        given = {
            "end": f"{self.t_end:g} s",
            "start": self.start,
            "rtol": self.rtol,
            "method": self.method,
            **self.inputs,
        }
        about = {name: value for name, value in given.items() if value is not None}
        motion = self.motion._repr_html_() if self.motion else ""
        return (
            html.facts(f"{self.name}: {self.description}", about)
            + self.robot._repr_html_()
            + motion
        )

    @property
    def _arguments(self) -> dict[str, Any]:
        """What a `Simulator` is made of."""
        names = ("robot", "motion", "rtol", "method", "start")
        return {name: getattr(self, name) for name in names} | dict(self.inputs)


def _find(name_or_path: str | Path) -> tuple[str, Traversable]:
    """Name and file of a scenario."""
    path = Path(name_or_path)
    if path.suffix == ".toml":
        return path.stem, path
    name = str(name_or_path)
    if name not in scenarios():
        raise ValueError(
            f"no scenario {name!r} comes with the package{hint(name, scenarios())}; "
            "one of your own is a path that ends in .toml"
        )
    return name, _FOLDER / f"{name}.toml"


# --- from and to TOML ---------------------------------------------------------------------------

_SOLVER = ("rtol", "method")


def _settings(data: dict[str, Any]) -> dict[str, Any]:
    """Attributes of a scenario from the data of its file."""
    from . import scenario_file  # pydantic takes its time to import

    scenario_file.check(data)
    settings: dict[str, Any] = {
        key: data[key] for key in ("t_end", "description", "start") if key in data
    }
    settings["robot"] = _robot(data["robot"])
    with _at("[motion]"):
        settings["motion"] = plain.motion(data["motion"]) if "motion" in data else None
    for table in ("inputs", "record"):
        settings[table] = data.get(table, {})
    published = data.get("published", {})
    settings["published"] = {signal: tuple(ends) for signal, ends in published.items()}
    return settings | data.get("solver", {})


def _robot(table: dict[str, Any]) -> Robot:
    if "load" in table:
        with _at("[robot.load]"):
            table = table | {"load": Load(**table["load"])}
    with _at("[robot]"):
        return plain.robot(table)


def _data(scenario: Scenario) -> dict[str, Any]:
    """Return what its file says."""
    for name, value in scenario.inputs.items():
        if callable(value):
            raise TypeError(f"inputs {name}: expected numbers, a file holds no function: {value!r}")
    data = {
        "description": scenario.description,
        "t_end": scenario.t_end,
        "start": scenario.start,
        "robot": plain.of_robot(scenario.robot),
        "motion": None if scenario.motion is None else plain.of_motion(scenario.motion),
        "inputs": plain.of_value(scenario.inputs),
        "solver": {
            name: value for name in _SOLVER if (value := getattr(scenario, name)) is not None
        },
        "record": plain.of_value(scenario.record),
        "published": plain.of_value(scenario.published),
    }
    return {key: value for key, value in data.items() if value not in (None, "", {})}


@contextmanager
def _at(place: object) -> Iterator[None]:
    """Say in the errors of this block where they come from."""
    try:
        yield
    except (TypeError, ValueError) as error:
        raise ValueError(f"{place}: {error}") from error
