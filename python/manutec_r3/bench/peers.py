"""The same plain arm in other programs: Pinocchio, MuJoCo, straight-line C from CasADi.

Their loops over poses are compiled, so that no time spent in Python hides theirs. Those of the last
two are compiled here, by ``cc`` or what the environment variable ``CC`` names.
"""

import ctypes
import os
import subprocess
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from importlib.metadata import version
from importlib.resources import as_file, files
from pathlib import Path
from tempfile import TemporaryDirectory
from xml.etree import ElementTree

import numpy as np

from ..export.arm import mjcf
from ..export.arm.tree import ArmTree
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


def peers(arm: ArmTree) -> list[Peer]:
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


def _pinocchio(arm: ArmTree) -> list[Peer]:
    import pinocchio as pin

    model = pin.Model()
    model.gravity.linear = np.array([0.0, 0.0, -arm.gravity])
    parent = 0
    for joint, body in zip(arm.joints, arm.bodies, strict=True):
        turn = pin.JointModelRX() if joint.about_x else pin.JointModelRZ()
        place = pin.SE3(np.eye(3), joint.offset)
        parent = model.addJoint(parent, turn, place, joint.name)
        model.appendBodyToJoint(parent, pin.Inertia(*body), pin.SE3.Identity())
    model.armature = np.array([joint.armature for joint in arm.joints])
    pool = pin.ModelPool(model, 1)

    def forward_dynamics(q: np.ndarray, qd: np.ndarray, tau: np.ndarray) -> np.ndarray:
        qdd = np.empty(q.T.shape, order="F")
        pin.abaInParallel(1, pool, q.T, qd.T, tau.T, qdd)
        return qdd.T

    measured = "abaInParallel of the wheel, one thread"
    return [Peer(f"Pinocchio {pin.__version__}", measured, forward_dynamics)]


# --- MuJoCo -------------------------------------------------------------------------------------


def _mujoco(arm: ArmTree) -> list[Peer]:
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


def _mjcf(arm: ArmTree) -> str:
    """Write the arm as MuJoCo's XML, without what is not measured: shapes and motors."""
    bare = replace(arm, links=[link._replace(shapes=[]) for link in arm.links])
    root = mjcf.document(bare)
    root[:] = [element for element in root if element.tag != "actuator"]
    return ElementTree.tostring(root, encoding="unicode")


# --- CasADi -------------------------------------------------------------------------------------


def _casadi(arm: ArmTree) -> list[Peer]:
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
