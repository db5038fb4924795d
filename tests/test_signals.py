"""Signals: what there is, its unit, and what controllers and tachogenerators put out."""

import numpy as np
import pytest

import manutec_r3 as r3
from manutec_r3.signals import Signals, descriptions, signal_names

EPS = np.finfo(float).eps
END = [0.3, -0.2, 0.4]
MOTION = r3.Quintic([0.0] * 3, END, 0.4)
VOLTAGES = ("command", "tachogenerator_voltage", "rate_error", "voltage")


def states(result, quantity):
    """A quantity of the states (n, n_axes)."""
    names = [name.split("[")[0] for name in result.robot.state_names]
    return result.state[:, [name == quantity for name in names]]


def row(result, symbol):
    """A row of Table 1."""
    return np.array(result.robot.parameters["table_1"][symbol])[: result.robot.n_axes]


def test_attributes_are_the_signals_of_the_core():
    listed = [name for name in vars(Signals) if not name.startswith("_")]
    assert tuple(listed) == signal_names


@pytest.mark.parametrize("name", signal_names)
def test_every_signal_says_what_it_is_and_in_which_unit(name):
    unit, text = descriptions[name]
    assert unit in ("rad", "rad/s", "rad/s^2", "N m", "V", "J", "W")
    assert getattr(r3.Result, name).__doc__ == f"{text} [{unit}]."


def test_signals_cannot_be_set():
    simulator = r3.Simulator(r3.Robot(model=4), MOTION)
    with pytest.raises(AttributeError, match="joint_power: it is computed and cannot be set"):
        simulator.joint_power = [0.0] * 3


def test_energies_are_computed_for_those_only_who_ask():
    result = r3.simulate(r3.Robot(model=4), MOTION, 0.1)
    assert result.motor_torque.any() and "_energies" not in vars(result)
    assert result.motor_power.any() and "_energies" in vars(result)


@pytest.mark.parametrize("signal", signal_names)
def test_a_simulator_shows_what_a_result_has(signal):
    robot = r3.Robot(model=4, load=r3.Load(10.0))
    simulator = r3.Simulator(robot, MOTION)
    simulator.step(0.1)
    result = r3.simulate(robot, MOTION, 0.4, times=[0.1])
    # The same steps, the last of which is not cut short.
    now = getattr(result.at(0.1), signal)[0]
    np.testing.assert_array_equal(getattr(simulator, signal), now)


def test_voltages_are_those_of_the_block_diagram():
    """Spec 4, report Figure 3: u_c, u_t, e = u_c - y with y = f + T_a/T_b (u_t - f)."""
    result = r3.simulate(r3.Robot(model=4), MOTION, 0.6)
    p, K_V, K_D = (row(result, symbol) for symbol in ("p", "K_V", "K_D"))
    error = p * result.reference_angle - result.rotor_angle
    command = K_V * error + K_D * p * result.reference_rate
    # Angles of 60 rad are subtracted.
    np.testing.assert_allclose(result.command, command, rtol=0, atol=1e2 * EPS)
    u_t, f = states(result, "tachogenerator_2"), states(result, "filter")
    np.testing.assert_array_equal(result.tachogenerator_voltage, u_t)
    y = f + row(result, "T_a") / row(result, "T_b") * (u_t - f)
    np.testing.assert_allclose(result.rate_error, result.command - y, rtol=0, atol=1e2 * EPS)
    np.testing.assert_array_equal(result.voltage, states(result, "voltage"))


def test_the_command_of_a_sampled_controller_is_held_between_samples():
    sampling_time = 0.008
    result = r3.simulate(r3.Robot(model=4, controller="sampled"), MOTION, 0.1)
    k = np.arange(12)
    early, late = (result.at((k + part) * sampling_time) for part in (0.1, 0.9))
    np.testing.assert_array_equal(early.command, late.command)
    assert (np.diff(early.command, axis=0) != 0.0).all()
    sampled = result.at(k * sampling_time)
    np.testing.assert_array_equal(early.command, sampled.command)


def test_the_command_of_an_external_controller_is_what_it_got():
    robot = r3.Robot(model=4, controller="external")
    held = r3.simulate(robot, None, 0.02, command=[0.1, -0.2, 0.3])
    np.testing.assert_array_equal(held.command, np.tile([0.1, -0.2, 0.3], (len(held), 1)))
    swinging = r3.simulate(robot, None, 0.02, command=lambda t: [np.sin(90.0 * t)] * 3)
    np.testing.assert_array_equal(swinging.command[:, 1], np.sin(90.0 * swinging.time))


def test_voltages_that_a_robot_does_not_have_are_not_numbers():
    without = r3.simulate(r3.Robot(model=4, controller=None), None, 0.01)
    for signal in VOLTAGES:
        assert np.isnan(getattr(without, signal)).all()
    modelica = r3.Scenario.load("one-axis").run(t_end=0.01)
    for signal in VOLTAGES[:-1]:
        assert np.isnan(getattr(modelica, signal)).all()
    np.testing.assert_array_equal(modelica.voltage, states(modelica, "voltage"))
