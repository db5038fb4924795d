"""The whole robot as an FMU: what the report called the neutral model format has become FMI.

The binary is made when the package is built, and is the same for all robots; an export adds the
model description and, as resources, the robot with its motion.
"""

import platform
import sys
from importlib.resources import files
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import Literal, NamedTuple, get_args
from uuid import NAMESPACE_URL, uuid5
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

import numpy as np

from ... import _core
from ...build_info import build_info
from ...scenario import Scenario
from ...simulation import Setup, set_up
from .model_description import (
    MODEL_IDENTIFIER,
    Model,
    Variable,
    description_2,
    description_3,
    terminals_and_icons,
)
from .page import page

FmiVersion = Literal["2.0", "3.0"]
ReferenceOf = Literal["motion", "input"]

_FOLDER = files(__package__)


def export_fmu(
    scenario: Scenario | str | Path,
    path: str | Path,
    *,
    fmi: FmiVersion = "3.0",
    reference: ReferenceOf = "motion",
) -> None:
    """Write a scenario as an FMU, for Model Exchange and for Co-Simulation.

    Parameters
    ----------
    scenario : Scenario, str or Path
        What to export: with the options, the motion and the start of the scenario. Load, tables,
        torques, commands and a force on the tip are its values at the start, to be changed by the
        importer.
    path : str or Path
        The file to write, ``.fmu``.
    fmi : {"3.0", "2.0"}
        Version of the standard. In 3.0 signals are arrays, in 2.0 each axis has its own variable.
    reference : {"motion", "input"}
        Whether the position controllers follow the motion of the scenario, or inputs
        ``input.reference_angle`` [rad] and ``input.reference_rate`` [rad/s], which begin with the
        start of that motion.

    Raises
    ------
    ValueError
        If the scenario cannot be exported, because functions are part of it or because nothing
        follows a reference; if the file is not to end in ``.fmu``.
    OSError
        If the file cannot be written, or the package has been built without the binary.

    Notes
    -----
    Co-Simulation integrates by the method and tolerance of the scenario, unless the importer asks
    for another tolerance. Between its communication points inputs are held, and a reference goes
    on with its rate.

    Examples
    --------
    >>> r3.export_fmu("figure9", "robot.fmu")
    """
    if not isinstance(scenario, Scenario):
        scenario = Scenario.load(scenario)
    path = Path(path)
    if path.suffix != ".fmu":
        raise ValueError(f"path: expected one that ends in .fmu, got {str(path)!r}")
    for name, value, expected in (
        ("fmi", fmi, get_args(FmiVersion)),
        ("reference", reference, get_args(ReferenceOf)),
    ):
        if value not in expected:
            raise ValueError(f"{name}: expected one of {', '.join(expected)}, got {value!r}")

    setup = set_up(**scenario._arguments)
    recipe = _recipe(scenario, setup, reference == "input")
    resources = recipe.text
    release = build_info().version
    # Who instantiates it names the token: it stands for this very content.
    stands_for = f"manutec_r3 {release} FMI {fmi}\n{resources}"
    token = f"{{{uuid5(NAMESPACE_URL, stands_for)}}}"
    model = Model(
        name=scenario.name,
        text=scenario.description or scenario.robot.title,
        token=token,
        version=release,
        stop_time=scenario.t_end,
        tolerance=setup.rtol,
        variables=tuple(Variable(*variable) for variable in recipe.variables),
    )
    binary, place = _binary(fmi)
    icon = (_FOLDER / "icon.png").read_bytes()
    documentation = page(scenario, model, fmi).encode()
    members = {
        binary: place.read_bytes(),
        "resources/robot.txt": f"{token}\n{resources}".encode(),
    }
    if fmi == "3.0":
        members |= {
            "modelDescription.xml": description_3(model),
            "documentation/index.html": documentation,
            "terminalsAndIcons/icon.png": icon,
            "terminalsAndIcons/terminalsAndIcons.xml": terminals_and_icons(),
        }
    else:
        members |= {
            "modelDescription.xml": description_2(model),
            "documentation/index.html": documentation,
            "model.png": icon,
        }
    with ZipFile(path, "w", ZIP_DEFLATED) as archive:
        for name, content in sorted(members.items()):
            # The same scenario gives the same bytes.
            info = ZipInfo(name)
            info.compress_type = ZIP_DEFLATED
            info.external_attr = 0o644 << 16
            archive.writestr(info, content)


def _recipe(scenario: Scenario, setup: Setup, reference_is_input: bool) -> _core.FmuRecipe:
    """Return what the core makes an FMU of."""
    robot, motion = scenario.robot, scenario.motion
    if setup.inputs.of_axes is not None or setup.inputs.tip_force is not None:
        raise ValueError("inputs: expected values that are held, got a function of time")
    if reference_is_input and robot.controller not in ("continuous", "sampled"):
        raise ValueError(
            "reference: expected 'motion', because no position controller follows an input, "
            f"got 'input' for controller={robot.controller!r}"
        )
    of_axes = setup.held.of_axes
    force = setup.held.tip_force
    return _core.FmuRecipe(
        robot._compiled,
        robot._core_motion(motion),
        reference_is_input,
        setup.start,
        np.zeros(robot.n_axes) if of_axes is None else of_axes,
        [0.0] * 3 if force is None else force.tolist(),
        setup.brakes,
        _core.Method[setup.method],
        setup.rtol,
    )


class _Platform(NamedTuple):
    """Of binaries, as the versions of FMI call it."""

    fmi_2: str
    fmi_3: str
    suffix: str


def _platform() -> _Platform:
    machine = {"amd64": "x86_64", "arm64": "aarch64"}.get(
        platform.machine().lower(), platform.machine().lower()
    )
    system, suffix = {"win32": ("windows", "dll"), "darwin": ("darwin", "dylib")}.get(
        sys.platform, ("linux", "so")
    )
    tuple_of_3 = f"{machine}-{system}"
    of_2 = {"x86_64-linux": "linux64", "x86_64-windows": "win64", "x86_64-darwin": "darwin64"}
    return _Platform(of_2.get(tuple_of_3, tuple_of_3), tuple_of_3, suffix)


def _binary(fmi: FmiVersion) -> tuple[str, Traversable]:
    """Return the binary's name in the archive, and where it lies."""
    here = _platform()
    name = f"{MODEL_IDENTIFIER}.{here.suffix}"
    place = _FOLDER / name
    if not place.is_file():
        raise OSError(f"{name}: expected it beside {__name__}; build with MANUTEC_R3_FMU=ON")
    return f"binaries/{here.fmi_2 if fmi == '2.0' else here.fmi_3}/{name}", place
