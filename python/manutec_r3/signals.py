"""The signals that results and simulators offer under the same names."""

import re

import numpy as np

from . import _core

signal_names: tuple[str, ...] = _core.signal_names


def _property(name: str, description: str) -> property:
    return property(lambda self: self._signal(name), doc=description)


class Signals:
    """Signals of all axes: the last dimension is n_axes.

    A signal that the robot does not have is NaN: references without a motion, voltages without a
    controller.
    """

    __slots__ = ()

    def _signal(self, name: str) -> np.ndarray:
        raise NotImplementedError

    joint_angle = _property("joint_angle", "Joint angles `aq` [rad].")
    joint_rate = _property("joint_rate", "Joint rates `aq'` [rad/s].")
    joint_acceleration = _property("joint_acceleration", "Joint accelerations `aq''` [rad/s^2].")
    rotor_angle = _property("rotor_angle", "Rotor angles `rq` [rad], motor side.")
    rotor_rate = _property("rotor_rate", "Rotor rates `rq'` [rad/s], motor side.")
    reference_angle = _property("reference_angle", "Desired joint angles `aq_d` [rad].")
    reference_rate = _property("reference_rate", "Desired joint rates `aq_d'` [rad/s].")
    control_error = _property("control_error", "Desired minus actual joint angles [rad].")
    motor_torque = _property("motor_torque", "Motor torques `rF` after NL2 [N m], motor side.")
    gear_torque = _property(
        "gear_torque",
        "Torques that gears take from rotors, `tau` or, rigid, `rF - rM` [N m], motor side.",
    )
    friction_torque = _property("friction_torque", "Friction torques `rM` [N m], motor side.")
    joint_torque = _property("joint_torque", "Torques at the joints `aF` [N m], joint side.")
    voltage = _property("voltage", "Output of the rate controllers `U` [V].")


def signal_unit(name: str) -> str:
    """Return the unit of a signal, as its description says in brackets."""
    return re.search(r"\[(.+?)\]", getattr(Signals, name).__doc__)[1]
