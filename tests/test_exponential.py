"""The exponential method against SUNDIALS, which knows nothing of linear blocks.

Other tests run it with all the rest: every option against independent implementations
(`test_models.py`), accuracy and repeatability (`test_accuracy.py`).
"""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import manutec_r3 as r3
from manutec_r3.comparison.accuracy import PROMISED, inside_steps, largest_errors, sequence

LOAD = r3.Load(10.0, (0.03, -0.05, 0.2))
ROBOTS = {
    "1": r3.Robot(1, LOAD),
    "2": r3.Robot(2, LOAD),
    "3": r3.Robot(3, LOAD),
    "3 sampled": r3.Robot(3, LOAD, controller="sampled"),
    "3 full, contact": r3.Robot(3, LOAD, rotor_coupling="full", gear_damping="contact"),
    "3 limited": r3.Robot(3, LOAD, voltage_limit=6.0),
    "4": r3.Robot(4, LOAD),
    "full-robot": r3.Robot("full-robot"),
}


@st.composite
def motions(draw, n):
    """Motions that start, stop and turn: short and long, small and large."""
    angle = st.floats(-1.0, 1.0)
    duration = draw(st.floats(0.15, 0.6))
    times = [0.0, draw(st.floats(0.3, 0.7)) * duration, duration]
    angles = draw(st.lists(st.lists(angle, min_size=n, max_size=n), min_size=3, max_size=3))
    size = draw(st.sampled_from([0.02, 0.2, 1.0]))
    return r3.Spline(times, size * np.array(angles) * duration)


@pytest.mark.parametrize("name", ROBOTS)
@settings(max_examples=6, deadline=None)
@given(data=st.data())
def test_every_event_that_short_explicit_steps_find_is_found(name, data):
    # Grazing contacts, short sticking, double crossings: whatever random motions bring. Explicit
    # steps at this tolerance are some 0.1 ms; those judged here are up to 8 ms.
    robot = ROBOTS[name]
    motion = data.draw(motions(robot.n_axes))
    exact = r3.simulate(robot, motion, motion.duration + 0.1, method="erk", rtol=1e-11)
    result = r3.simulate(robot, motion, motion.duration + 0.1, method="exponential", rtol=1e-10)
    assert sequence(result.events) == sequence(exact.events)
    # Ten times the 3e-9 s that are measured where a rate passes zero slowly.
    times = [event.time for event in result.events], [event.time for event in exact.events]
    np.testing.assert_allclose(*times, rtol=0, atol=3e-8)


@pytest.mark.parametrize("name", ROBOTS)
def test_it_takes_a_fraction_of_the_evaluations_for_the_same_accuracy(name):
    robot = ROBOTS[name]
    n = robot.n_axes
    motion = r3.Quintic([0.1] * n, [0.8, -0.5, 0.6, 0.4, -0.3, 0.5][:n], 0.8)
    runs = {
        method: r3.simulate(robot, motion, 1.0, method=method) for method in ("exponential", "erk")
    }
    exact = r3.simulate(robot, motion, 1.0, method="erk", rtol=1e-11)
    for result in runs.values():
        for signal, error in largest_errors(result.at(inside_steps(result)), exact).items():
            assert error <= PROMISED, signal
    work = {method: result.statistics.evaluations for method, result in runs.items()}
    # Measured are a ninth to a quarter, the latter with sampled controllers.
    assert work["exponential"] < 0.4 * work["erk"]


def test_the_error_follows_the_tolerance_down_to_roundoff():
    motion = r3.Quintic([0.0] * 6, [1.0, 1.0, 0.6, -0.2, -0.15, -0.1], 1.2)
    robot = r3.Robot(3, LOAD)
    exact = r3.simulate(robot, motion, 1.5, method="erk", rtol=1e-13)

    def error(rtol):
        result = r3.simulate(robot, motion, 1.5, method="exponential", rtol=rtol)
        assert sequence(result.events) == sequence(exact.events)
        return max(largest_errors(result.at(inside_steps(result)), exact).values())

    # In parts of a signal's range, after some thousand steps; measured is 1.4 rtol at most. (If the
    # propagator doubled its roundoff with its length, 1e-9 would be left.)
    for rtol in (1e-7, 1e-9, 1e-11):
        assert error(rtol) <= 3 * rtol


def test_functions_of_a_user_are_not_asked_beyond_their_knots():
    # A step of the reference's rate at its knot: beyond it, the function is another.
    asked = []

    def rate(t):
        asked.append(t)
        return np.full(3, 1.0 if t < 0.1 else -1.0)

    def angle(t):
        return np.full(3, t if t < 0.1 else 0.2 - t)

    motion = r3.FunctionMotion(angle, rate, 0.2, [0.1])
    runs = [
        r3.simulate(r3.Robot(4, LOAD), motion, 0.19, method=method, rtol=1e-9)
        for method in ("exponential", "erk")
    ]
    assert sequence(runs[0].events) == sequence(runs[1].events)
    assert len(runs[0].events) > 10
    for signal, error in largest_errors(runs[0].at(np.linspace(0, 0.19, 500)), runs[1]).items():
        assert error <= 1e-7, signal  # a hundred times the tolerance; 2e-9 is measured
    assert 0.1 in asked


def test_torques_as_functions_of_time_without_a_controller():
    torque = r3.Input(lambda t: np.sin([7.0 * t, 5.0 * t, 3.0 * t]), knots=[0.05])
    robot = r3.Robot(4, LOAD, controller=None)
    exponential, erk = (
        r3.simulate(robot, None, 0.3, motor_torque=torque, method=method, rtol=1e-9)
        for method in ("exponential", "erk")
    )
    assert sequence(exponential.events) == sequence(erk.events)
    deviation = np.abs(exponential.at(0.3).joint_angle - erk.at(0.3).joint_angle)
    assert deviation.max() <= 1e-8  # radians of about one; 1e-10 is measured


def test_robots_with_different_loads_have_most_blocks_in_common():
    # Nothing but time tells; but results must not depend on what was computed before.
    motion = r3.Quintic([0.0] * 6, [0.3, 0.2, -0.2, 0.1, 0.2, 0.1], 0.3)
    first = r3.simulate(ROBOTS["3"], motion, 0.3)
    for mass in (0.0, 5.0, 9.9, 15.0):
        r3.simulate(r3.Robot(3, r3.Load(mass)), motion, 0.3)
    again = r3.simulate(ROBOTS["3"], motion, 0.3)
    np.testing.assert_array_equal(first.state, again.state)
    assert first.events == again.events
