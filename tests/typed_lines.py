"""What type checkers know of the public names; never run, `test_types` has mypy read it.

An error that is expected is ignored by its name, and mypy tells of one that it does not see.
"""

from pathlib import Path
from typing import assert_type

import numpy as np

import manutec_r3 as r3

robot = r3.Robot(model=3, load=r3.Load(mass=15.0, position=[0.0, 0.0, 0.2]))
motion = r3.Quintic(start=[0] * 6, end=np.full(6, 0.3), duration=1.2)
result = r3.simulate(robot, motion, t_end=1.5, times=np.linspace(0.0, 1.5), start="arm")

# What a constructor has filled in is there, and is what it has made of what was given.
assert_type(robot.load, r3.Load)
assert_type(robot.load.position, tuple[float, float, float])
assert_type(motion.end, tuple[float, ...])
assert_type(r3.Trapezoid([0], [1], rate=[2], acceleration=[3]).duration, float)
assert_type(r3.Sequence([motion, r3.Hold(motion.end)]).motions, tuple[r3.Motion, ...])

# Signals are attributes of all that has them.
assert_type(result.joint_angle, np.ndarray)
assert_type(result.at([0.1, 0.2]).motor_power, np.ndarray)
assert_type(r3.Simulator(robot, motion).friction_torque, np.ndarray)
print(result.joint_angel)  # type: ignore[attr-defined]
result.joint_angle = np.zeros(6)  # type: ignore[assignment]

# Inputs of a simulator can be set, to more than they are read as.
free = r3.Simulator(r3.Robot(model=2, controller=None))
free.motor_torque = [1.0, 2.0, 0.5]
assert_type(free.motor_torque, np.ndarray)
assert_type(free.step(1e-3), list[r3.Event])
assert_type(free.step_to_event(t_end=1.0), r3.Event | None)

# Events are rows, and columns.
assert_type(result.events[0], r3.Event)
assert_type(result.events[:3], tuple[r3.Event, ...])
assert_type(result.events.time[0:2], np.ndarray)

# Where many runs go says what comes back.
assert_type(r3.simulate_many([(robot, motion)], t_end=1.5, record="peaks"), r3.Results)
assert_type(r3.simulate_many([], record="peaks", to_parquet="runs"), Path)
r3.simulate_many([(robot, motion)], t_end=1.5, tolerance=1e-8)  # type: ignore[call-overload]

assert_type(r3.export_urdf(robot, "r3.urdf"), tuple[str, ...])

# Choices are known by their names.
r3.simulate(robot, motion, t_end=1.5, method="rk4")  # type: ignore[arg-type]
r3.Robot(controller="pid")  # type: ignore[arg-type]
r3.Quintic(start="here", end=[1.0], duration=1.0)  # type: ignore[arg-type]

# Planned motions are motions, with more to tell.
planned = r3.optimal_motion(robot, [0] * 6, motion.end, effort="voltage", torque_per_volt=1.2)
assert_type(planned, r3.OptimalMotion)
assert_type(planned.torque_margins, np.ndarray)
assert_type(planned.end_error, float)
assert_type(r3.simulate(robot, planned, t_end=1.5), r3.Result)
assert_type(r3.pareto_motions(robot, [0] * 6, motion.end, [1e-3, 1e-2]).plot(), np.ndarray)
assert_type(r3.fastest_along(robot, np.zeros((3, 6))), r3.PiecewisePolynomial)
r3.optimal_motion(robot, [0] * 6, motion.end, effort="power")  # type: ignore[arg-type]
