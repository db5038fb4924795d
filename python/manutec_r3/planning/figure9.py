"""The motion of the benchmark experiment, computed anew: ``python -m manutec_r3.planning.figure9``.

The report's own was never published (specification section 9): from the vertical position to a
point near the ground, a compromise between least time and least effort under limits on motor
torques and rotor rates, computed with the multibody part of model 2, followed by model 3 with
15 kg. Ours is made by the same rules. The command prints the file of the scenario `figure9`.

What the optimisation does not know is kept in reserve:

* of the motor torques 2 of 9 N m: up to 1 N m for the friction of the gears, the rest for the
  controllers, which wind up at the limit;
* of the rotor rates 3 %: elastic gears let them overshoot;
* accelerations are continuous, and pieces are as long as half of the motion: with the same weight
  four pieces make it faster by 0.2 s, and the controllers miss it by twice as much as in the
  report.

Weight and end are chosen so that duration, angles, control errors and motor torques fall into the
ranges of the report's Figure 9.
"""

import numpy as np

from ..robot import Load, Robot
from .optimal import OptimalMotion, optimal_motion

_LOAD = Load(15.0)
_END = (1.0, 0.92, 0.8)  # [rad]
_EFFORT_WEIGHT = 0.01  # [s / (N^2 m^2 s)]
_TORQUE_RESERVE = 2.0  # [N m], motor side
_RATE_RESERVE = 0.03  # of the limits
_N_PIECES = 2

# Of the file; the last ones differ from machine to machine, as IPOPT stops within its tolerance.
_DECIMALS = 12

_FILE = """\
description = "The report's Figure 9 on an optimal motion: load 15 kg"
t_end = 1.5 # s

[robot]
model = 3

[robot.load]
mass = {mass} # kg
position = {position} # m, in the frame of arm 6

# From the stretched vertical position to a point near the ground: a compromise between least time
# and least effort by the rules of the report, whose own motion was never published. Motor torques
# keep 2 N m, rotor rates 3 % of their limits in reserve for friction and control; axes 4 to 6 rest.
# Computed by: python -m manutec_r3.planning.figure9
[motion]
type = "piecewise-polynomial"
times = {times} # s
# For each piece a row for each power of the normalised time, from x^0 to x^4.
coefficients = [ # rad
{pieces}
]

# What the report's Figure 9 shows for all axes, read off the plots.
[published]
joint_angle = [-0.21, 1.05] # rad: from about -0.2 to just above 1
control_error = [-1.2e-2, 1.2e-2] # rad
motor_torque = [-7.5, 7.5] # N m
"""


def motion() -> OptimalMotion:
    """Return the optimal motion of the three axes of model 2."""
    robot = Robot(model=2, load=_LOAD)
    motors = robot.parameters["table_1"]
    rates = np.divide(motors["rotor_rate_max"], np.abs(motors["p"]))
    return optimal_motion(
        robot,
        start=(0.0, 0.0, 0.0),
        end=_END,
        effort_weight=_EFFORT_WEIGHT,
        torque_limit=np.subtract(motors["rF_max"], _TORQUE_RESERVE)[:3],
        rate_limit=(1.0 - _RATE_RESERVE) * rates[:3],
        smooth=True,
        n_pieces=_N_PIECES,
    )


def file() -> str:
    """Return the scenario's file: model 3 follows the motion, axes 4 to 6 rest."""
    optimum = motion()
    on_three = np.array(optimum.coefficients)
    on_six = np.concatenate((on_three, np.zeros_like(on_three)), axis=2)
    pieces = (
        "\n".join(f"    {row}," for row in piece)
        for piece in (np.round(on_six, _DECIMALS) + 0.0).tolist()
    )
    return _FILE.format(
        mass=_LOAD.mass,
        position=list(_LOAD.position),
        times=np.round(optimum.times, _DECIMALS).tolist(),
        pieces="\n".join(f"  [\n{piece}\n  ]," for piece in pieces),
    )


if __name__ == "__main__":
    print(file(), end="")
