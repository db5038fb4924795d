"""How long one evaluation takes: right-hand sides of the models, forward dynamics beside peers."""

from collections.abc import Callable
from functools import partial

import numpy as np

from .. import _core
from ..export.arm.tree import arm_tree
from ..inputs import gather
from ..motion import Quintic
from ..robot import Load, Robot
from ..simulation import simulate
from .peers import ForwardDynamics, Peer, peers
from .report import Row, Table
from .timing import each_of_many, many

# Roundoff of programs that order their operations differently, and of the condition of M.
_AGREEMENT = 1e-12

# Six bodies on revolute joints with armatures: what all programs can simulate. Engines need a mass
# for every body and an inertia for the last one; arm 6 of the report has none.
PLAIN_ARM = Robot(
    model=1,
    load=Load(15.0, (0.06, -0.05, 0.18)),
    rotor_coupling="simplified",
    table_3={
        "arms": {
            1: {"mass": 1.0, "I11": 1.16, "I22": 1.16},
            6: {"mass": 1.0, "centre_of_mass": [0.0, 0.0, 0.05], "I11": 0.01, "I22": 0.01},
        },
        "joint_limits": np.inf,  # poses are random
    },
)


def right_hand_sides(repeats: int) -> Table:
    """Time the right-hand side of each model at states along a run."""
    robots = {f"model {model}": Robot(model=model) for model in (3, 1, 2, 4)}
    robots["full-robot"] = Robot(model="full-robot")
    timings = each_of_many({name: _loop(robot) for name, robot in robots.items()}, repeats)
    return Table(
        "right-hand-side",
        "Right-hand side: rates of all states from states",
        "ns",
        [Row(name, timings[name], f"{robots[name].n_states} states") for name in robots],
        f"One evaluation, branches frozen; a compiled loop over {many} states of a run.",
    )


def _loop(robot: Robot) -> Callable[[int], np.ndarray]:
    """Evaluate the right-hand side at so many states of a run, between two of its events."""
    end = [0.6, 0.5, -0.4, 0.3, -0.5, 0.4][: robot.n_axes]
    motion = Quintic([0.0] * robot.n_axes, end, duration=1.0)
    result = simulate(robot, motion, 0.6)
    edges = np.array([0.0, *np.unique(result.events.time), result.t_end])
    longest = np.argmax(np.diff(edges))
    t = np.linspace(edges[longest], edges[longest + 1], many + 2)[1:-1]
    x = result.at(t).state
    inputs, _ = gather(robot, motion, {})
    system = _core.System(robot._compiled, inputs._compiled)
    system.initialise(t[0], x[0])
    return lambda n: system.derivatives(t[:n], x[:n])


def forward_dynamics(repeats: int) -> Table:
    """Time forward dynamics of six arms, ours and others', after a look whether all agree."""
    rng = np.random.default_rng(1)
    q, qd = rng.uniform(-3.0, 3.0, (2, many, 6))
    tau = rng.uniform(-500.0, 500.0, (many, 6))
    composite = partial(_core.forward_dynamics, PLAIN_ARM._compiled)
    articulated = partial(_core.articulated_forward_dynamics, PLAIN_ARM._compiled)
    programs = [
        Peer("manutec_r3", "mass matrix, bias, solution", composite),
        Peer("manutec_r3", "articulated bodies, O(n)", articulated),
        *peers(arm_tree(PLAIN_ARM)),
    ]
    expected = composite(q, qd, tau)
    errors = [
        float((np.abs(peer.forward_dynamics(q, qd, tau) - expected) / _largest(expected)).max())
        if peer.forward_dynamics
        else None
        for peer in programs
    ]

    def of_poses(forward_dynamics: ForwardDynamics) -> Callable[[int], np.ndarray]:
        return lambda n: forward_dynamics(q[:n], qd[:n], tau[:n])

    timings = each_of_many(
        {
            str(k): of_poses(peer.forward_dynamics)
            for k, (peer, error) in enumerate(zip(programs, errors, strict=True))
            if peer.forward_dynamics and error is not None and error <= _AGREEMENT
        },
        repeats,
    )
    rows = [
        Row(
            peer.name,
            timings.get(str(k)),
            peer.measured,
            errors[k],
            _AGREEMENT if peer.forward_dynamics else None,
        )
        for k, peer in enumerate(programs)
    ]
    return Table(
        "forward-dynamics",
        "Forward dynamics of six arms: accelerations from angles, rates and torques",
        "ns",
        rows,
        f"One evaluation; compiled loops over {many} random poses of a plain arm with 15 kg, whose "
        "rotors are armatures. Error: difference of accelerations from ours, in parts of the "
        "largest of a pose; a program that disagrees is not timed.",
    )


def _largest(accelerations: np.ndarray) -> np.ndarray:
    """Largest magnitude of each pose (n, 1)."""
    return np.abs(accelerations).max(axis=1, keepdims=True)
