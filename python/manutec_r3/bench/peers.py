"""The same plain arm in other programs: Pinocchio, MuJoCo, straight-line C from CasADi.

Their loops over poses are compiled, so that no time spent in Python hides theirs. Those of the last
two are compiled here, by ``cc`` or what the environment variable ``CC`` names.
"""

import ctypes
import os
import subprocess
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, partial
from importlib.metadata import version
from importlib.resources import as_file, files
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from ..robot import Robot
from .timing import many, one

ForwardDynamics = Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray]

_OPTIMISED = ("-O3", "-march=native", "-fPIC", "-shared")


class Unavailable(Exception):
    """A peer cannot be compiled."""


@dataclass(frozen=True)
class Peer:
    """A program that computes forward dynamics.

    Attributes
    ----------
    name : str
        What it is, with its version.
    measured : str
        What exactly is timed, or why nothing is.
    forward_dynamics : callable or None
        Joint accelerations (n, 6) [rad/s^2] of angles, rates and torques (n, 6), for ``n`` as in
        `timing`; None if it is not there.
    """

    name: str
    measured: str
    forward_dynamics: ForwardDynamics | None = None


@dataclass(frozen=True)
class PlainArm:
    """Six bodies on revolute joints, with armatures: what all programs can simulate.

    Attributes
    ----------
    robot : Robot
        Model 1 with all rotors simplified: then they are armatures, ``p^2 rJ``. Data of arms and
        gear ratios are read from it.
    """

    robot: Robot

    @property
    def arms(self) -> list[dict]:
        """Rows of Table 3."""
        return self.robot.parameters["table_3"]["arms"]

    @cached_property
    def gravity(self) -> float:
        """[m/s^2], downward."""
        return self.robot.parameters["table_3"]["gravity"]

    @cached_property
    def about_x(self) -> np.ndarray:
        """Whether a joint turns about x, else about z (6,)."""
        return np.array([arm["axis"] == "x" for arm in self.arms])

    @cached_property
    def offset(self) -> np.ndarray:
        """Joints in the frame of the preceding arm (6, 3) [m]."""
        return np.array([arm["offset"] for arm in self.arms])

    @cached_property
    def armature(self) -> np.ndarray:
        """Inertia of the rotors, joint side (6,) [kg m^2]."""
        tables = self.robot.parameters
        return np.square(tables["table_1"]["p"]) * tables["table_3"]["rJ"]

    @cached_property
    def bodies(self) -> list[tuple[float, np.ndarray, np.ndarray]]:
        """Mass [kg], centre of mass (3,) [m], inertia about it (3, 3) [kg m^2]; 6 with the load."""
        bodies = [(arm["mass"], np.array(arm["centre_of_mass"]), _tensor(arm)) for arm in self.arms]
        load = (self.robot.load.mass, np.array(self.robot.load.position), np.zeros((3, 3)))
        bodies[-1] = _joined(bodies[-1], load)
        return bodies


def _tensor(arm: dict) -> np.ndarray:
    i11, i22, i33, i13 = (arm[name] for name in ("I11", "I22", "I33", "I13"))
    return np.array([[i11, 0.0, i13], [0.0, i22, 0.0], [i13, 0.0, i33]])


def _joined(*bodies: tuple[float, np.ndarray, np.ndarray]) -> tuple[float, np.ndarray, np.ndarray]:
    """One rigid body of several."""
    mass = sum(m for m, _, _ in bodies)
    centre = np.sum([m * c for m, c, _ in bodies], axis=0) / mass
    about_centre = [
        i + m * ((c - centre) @ (c - centre) * np.eye(3) - np.outer(c - centre, c - centre))
        for m, c, i in bodies
    ]
    return mass, centre, np.sum(about_centre, axis=0)


def peers(arm: PlainArm) -> list[Peer]:
    """All of them, those that are not there with the reason."""
    found = []
    for name, make in _PEERS:
        try:
            found += make(arm)
        except ImportError as missing:
            install = 'pip install "manutec-r3[bench]"'
            found.append(Peer(name, f"not measured: {missing}; {install}"))
        except Unavailable as reason:
            found.append(Peer(name, f"not measured: {reason}"))
    return found


# --- compiling ----------------------------------------------------------------------------------


def _compiled(source: Path, *options: str) -> ctypes.CDLL:
    """Compile a C source for this processor and load it."""
    compiler = os.environ.get("CC", "cc")
    with TemporaryDirectory() as folder:
        library = Path(folder) / "loop.so"
        command = [compiler, *_OPTIMISED, str(source), "-o", str(library), *options]
        try:
            subprocess.run(command, check=True, capture_output=True, text=True)
        except FileNotFoundError:
            raise Unavailable(f"there is no C compiler {compiler!r}") from None
        except subprocess.CalledProcessError as failed:
            raise Unavailable(f"{compiler}: {failed.stderr.strip()}") from None
        return ctypes.CDLL(str(library))


def _address(array: np.ndarray) -> ctypes.c_void_p:
    return ctypes.c_void_p(array.ctypes.data)


# --- Pinocchio ----------------------------------------------------------------------------------


def _pinocchio(arm: PlainArm) -> list[Peer]:
    import pinocchio as pin

    model = pin.Model()
    model.gravity.linear = np.array([0.0, 0.0, -arm.gravity])
    parent = 0
    for j, (mass, centre, inertia) in enumerate(arm.bodies):
        joint = pin.JointModelRX() if arm.about_x[j] else pin.JointModelRZ()
        place = pin.SE3(np.eye(3), arm.offset[j])
        parent = model.addJoint(parent, joint, place, f"joint {j + 1}")
        model.appendBodyToJoint(parent, pin.Inertia(mass, centre, inertia), pin.SE3.Identity())
    model.armature = arm.armature
    pool = pin.ModelPool(model, 1)

    def forward_dynamics(q: np.ndarray, qd: np.ndarray, tau: np.ndarray) -> np.ndarray:
        qdd = np.empty(q.T.shape, order="F")
        pin.abaInParallel(1, pool, q.T, qd.T, tau.T, qdd)
        return qdd.T

    measured = "abaInParallel of the wheel, one thread"
    return [Peer(f"Pinocchio {pin.__version__}", measured, forward_dynamics)]


# --- MuJoCo -------------------------------------------------------------------------------------


def _mujoco(arm: PlainArm) -> list[Peer]:
    import mujoco

    model = mujoco.MjModel.from_xml_string(_mjcf(arm))
    data = mujoco.MjData(model)
    folder = Path(mujoco.__file__).parent
    (shared,) = folder.glob("libmujoco.so.*")
    with as_file(files(__package__) / "mujoco_loop.c") as source:
        options = (f"-I{folder / 'include'}", str(shared), f"-Wl,-rpath,{folder}")
        library = _compiled(source, *options)

    def run(only_smooth: bool, q: np.ndarray, qd: np.ndarray, tau: np.ndarray) -> np.ndarray:
        qdd = np.empty_like(q)
        at = (ctypes.c_void_p(thing._address) for thing in (model, data))
        library.forward_dynamics(*at, only_smooth, len(q), *map(_address, (q, qd, tau, qdd)))
        return qdd

    name = f"MuJoCo {version('mujoco')}"
    return [
        Peer(name, "mj_forward", partial(run, False)),
        Peer(name, "its smooth part, mj_fwd*", partial(run, True)),
    ]


def _mjcf(arm: PlainArm) -> str:
    """Write the arm as MuJoCo's XML."""

    def numbers(*values: float) -> str:
        return " ".join(repr(float(value)) for value in values)

    opened = []
    for j, (mass, centre, inertia) in enumerate(arm.bodies):
        i11, i22, i33 = np.diag(inertia)
        full = numbers(i11, i22, i33, inertia[0, 1], inertia[0, 2], inertia[1, 2])
        opened.append(
            f'<body pos="{numbers(*arm.offset[j])}">'
            f'<joint axis="{"1 0 0" if arm.about_x[j] else "0 0 1"}" '
            f'armature="{numbers(arm.armature[j])}"/>'
            f'<inertial pos="{numbers(*centre)}" mass="{numbers(mass)}" fullinertia="{full}"/>'
        )
    bodies = "".join(opened) + "</body>" * len(opened)
    return (
        f'<mujoco><compiler angle="radian"/><option gravity="0 0 {-arm.gravity!r}"/>'
        f"<worldbody>{bodies}</worldbody></mujoco>"
    )


# --- CasADi -------------------------------------------------------------------------------------


def _casadi(arm: PlainArm) -> list[Peer]:
    import casadi as ca

    from .symbolic_arm import forward_dynamics as symbolic

    function = symbolic(arm)
    loops = {n: function.map(n) for n in (one, many)}
    generator = ca.CodeGenerator("straight_line")
    for loop in loops.values():
        generator.add(loop)
    with TemporaryDirectory() as folder:
        generator.generate(f"{folder}/")
        library = _compiled(Path(folder) / "straight_line.c")

    def forward_dynamics(q: np.ndarray, qd: np.ndarray, tau: np.ndarray) -> np.ndarray:
        qdd = np.empty_like(q)
        loop = loops[len(q)]
        given = (ctypes.c_void_p * loop.sz_arg())(*map(_address, (q, qd, tau)))
        wanted = (ctypes.c_void_p * loop.sz_res())(_address(qdd))
        scratch = np.empty(loop.sz_w())
        getattr(library, loop.name())(given, wanted, None, _address(scratch), 0)
        return qdd

    options = " ".join(_OPTIMISED[:2])
    measured = f"straight-line C, {function.n_instructions()} operations, {options}"
    return [Peer(f"CasADi {ca.__version__}", measured, forward_dynamics)]


_PEERS = (
    ("Pinocchio", _pinocchio),
    ("MuJoCo", _mujoco),
    ("CasADi", _casadi),
)
