"""The core's inverse dynamics as a formula: the recursion, run on numbers that are recorded."""

import numpy as np
import pytest

import manutec_r3 as r3
from manutec_r3 import _core
from manutec_r3.planning.optimal.dynamics import inverse_dynamics

LOAD = r3.Load(15.0, (0.1, 0.0, 0.2))
ROBOTS = {
    "model 1": r3.Robot(1),
    "model 1 with a load": r3.Robot(1, load=LOAD),
    "model 2": r3.Robot(2),
    "model 2 with a load": r3.Robot(2, load=LOAD),
    "model 2, six arms' data": r3.Robot(2, arm="six-arm"),
    "model 3": r3.Robot(3, load=LOAD),
    "model 4": r3.Robot(4, load=LOAD),
    "one rotor simplified": r3.Robot(1, rotor_coupling=["full", "simplified", *["full"] * 4]),
    "another layout": r3.Robot(
        1, table_3={"rn": {2: "y"}, "arms": {3: {"offset": [0.1, 0.2, 0.4]}}}
    ),
    "full robot": r3.Robot("full-robot"),
    "one axis": r3.Robot("one-axis"),
}


@pytest.mark.parametrize("robot", ROBOTS.values(), ids=ROBOTS)
def test_the_formula_gives_the_torques_of_the_core(robot):
    rng = np.random.default_rng(1)
    q, qd, qdd = rng.uniform(-3.0, 3.0, (3, 100, robot.n_axes))
    formula = inverse_dynamics(robot).map(100)(q.T, qd.T, qdd.T).full().T
    expected = robot.inverse_dynamics(q, qd, qdd)
    # Terms that vanish are left out, so sums round otherwise; measured 4e-16 of the largest.
    np.testing.assert_allclose(formula, expected, rtol=0, atol=5e-15 * np.abs(expected).max())


def operations(robot):
    lines, _ = _core.inverse_dynamics_tape(robot._compiled)
    return [line for line in lines if line[0] not in ("input", "constant")]


def test_the_formula_is_as_short_as_one_written_by_hand():
    # Measured 247 and 569, sines and cosines included.
    assert len(operations(r3.Robot(2))) <= 250
    assert len(operations(r3.Robot(1))) <= 575


def test_each_line_is_new_and_none_does_nothing():
    lines, _ = _core.inverse_dynamics_tape(r3.Robot(1, load=LOAD)._compiled)
    written = [line for line in lines if line[0] != "input"]
    assert len(set(written)) == len(written)
    constants = {place for place, line in enumerate(lines) if line[0] == "constant"}
    for operation, first, second, _ in operations(r3.Robot(1, load=LOAD)):
        operands = {first} if operation in ("negate", "sine", "cosine") else {first, second}
        assert not operands <= constants, operation
        values = [lines[place][3] for place in operands & constants]
        assert 0.0 not in values
        assert operation != "multiply" or 1.0 not in values
