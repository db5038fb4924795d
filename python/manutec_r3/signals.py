"""The signals that results and simulators offer under the same names.

Their names, units and descriptions are those of the core; the list below tells readers and type
checkers of the attributes.
"""

from typing import Any, NamedTuple, Never, Self, overload

import numpy as np

from . import _core


class SignalDescription(NamedTuple):
    """What a signal is.

    Attributes
    ----------
    unit : str
        Its SI unit.
    text : str
        What it means, with the report's symbol and the side on which it is measured.
    """

    unit: str
    text: str


# In two groups: energies take more work than the others, and are evaluated when they are asked for.
_OF_MOTION = {name: SignalDescription(*row) for name, *row in _core.signals}
descriptions = _OF_MOTION | {name: SignalDescription(*row) for name, *row in _core.energies}
signal_names: tuple[str, ...] = tuple(descriptions)


def signal_unit(name: str) -> str:
    """Return the unit of a signal."""
    return descriptions[name].unit


class _Signal:
    """An attribute that is a signal of this name."""

    def __set_name__(self, owner: type, name: str) -> None:
        self._name = name
        unit, text = descriptions[name]
        self.__doc__ = f"{text} [{unit}]."

    @overload
    def __get__(self, instance: None, owner: type) -> Self: ...
    @overload
    def __get__(self, instance: "Signals", owner: type | None = None) -> np.ndarray: ...
    def __get__(self, instance: Any, owner: type | None = None) -> Any:
        return self if instance is None else instance._signal(self._name)

    def __set__(self, instance: object, value: Never) -> None:
        raise AttributeError(f"{self._name}: it is computed and cannot be set")


class Signals:
    """Signals of all axes: the last dimension is n_axes.

    A signal that the robot does not have is NaN: references without a motion, voltages without a
    controller; in the Modelica variant commands, rate errors and tachogenerators.

    Energies, powers and losses of all axes are in balance: the sum of the energies changes by
    motor powers less friction and damping losses, and by what a force on the tip does.
    """

    __slots__ = ()

    joint_angle = _Signal()
    joint_rate = _Signal()
    joint_acceleration = _Signal()
    rotor_angle = _Signal()
    rotor_rate = _Signal()
    reference_angle = _Signal()
    reference_rate = _Signal()
    control_error = _Signal()
    motor_torque = _Signal()
    gear_torque = _Signal()
    friction_torque = _Signal()
    joint_torque = _Signal()
    command = _Signal()
    tachogenerator_voltage = _Signal()
    rate_error = _Signal()
    voltage = _Signal()
    kinetic_energy = _Signal()
    potential_energy = _Signal()
    elastic_energy = _Signal()
    motor_power = _Signal()
    gear_power = _Signal()
    joint_power = _Signal()
    friction_loss = _Signal()
    damping_loss = _Signal()

    @property
    def _signals(self) -> np.ndarray:
        """Motion, torques and voltages, in the order of the core."""
        raise NotImplementedError

    @property
    def _energies(self) -> np.ndarray:
        """Energies, powers and losses, in the order of the core."""
        raise NotImplementedError

    def _signal(self, name: str) -> np.ndarray:
        index = signal_names.index(name)
        n = len(_OF_MOTION)
        return self._signals[index] if index < n else self._energies[index - n]
