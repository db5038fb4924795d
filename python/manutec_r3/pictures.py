"""What results draw of themselves; Matplotlib is loaded when the first picture is asked for."""

from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    import numpy as np
    from matplotlib.axes import Axes


class Pictures:
    """The pictures of `manutec_r3.plot` as methods; those functions say what they show."""

    def plot(self, axes: "np.ndarray | None" = None) -> "np.ndarray":
        """Draw angle, error and torque of each axis; see `manutec_r3.plot.figure9`."""
        from . import plot

        return plot.figure9(self, axes)

    def plot_events(self, axes: "Axes | None" = None) -> "Axes":
        """Draw which element is in which branch when; see `manutec_r3.plot.events`."""
        from . import plot

        return plot.events(self, axes)

    def plot_friction(self, axis: int = 1, axes: "Axes | None" = None) -> "Axes":
        """Draw friction over rotor rate; see `manutec_r3.plot.friction`."""
        from . import plot

        return plot.friction(self, axis, axes)

    def plot_backlash(self, axis: int = 1, axes: "Axes | None" = None) -> "Axes":
        """Draw the deflection of a gear and its gap; see `manutec_r3.plot.backlash`."""
        from . import plot

        return plot.backlash(self, axis, axes)

    def plot_phase(
        self,
        axis: int = 1,
        of: Literal["angle", "error"] = "angle",
        axes: "Axes | None" = None,
    ) -> "Axes":
        """Draw the rate over the angle, or of the error; see `manutec_r3.plot.phase`."""
        from . import plot

        return plot.phase(self, axis, of, axes)

    def plot_stroboscope(
        self, n: int = 11, view: Literal["side", "top"] = "side", axes: "Axes | None" = None
    ) -> "Axes":
        """Draw the arm at equal intervals of time; see `manutec_r3.plot.stroboscope`."""
        from . import plot

        return plot.stroboscope(self, n, view, axes)
