"""Pictures of results; they need Matplotlib: ``pip install "manutec-r3[plot]"``.

Every function takes the axes to draw on and returns them; without axes it makes a figure of its
own in the size of print, a column (85 mm) or a page (170 mm) wide. Lines connect what the result
has recorded. Results offer the same pictures as methods: ``result.plot()`` is ``figure9(result)``,
``result.plot_events()`` is ``events(result)`` and so on; a `Comparison`
and `ParetoMotions` have ``plot()``.

    result.plot_friction(axis=2).figure.savefig("friction.pdf")
"""

from .backlash import backlash
from .comparison import comparison
from .events import events
from .figure9 import figure9
from .friction import friction
from .panels import new_figure
from .pareto import pareto
from .phase import phase
from .stays import sticking
from .stroboscope import stroboscope

__all__ = [
    "backlash",
    "comparison",
    "events",
    "figure9",
    "friction",
    "new_figure",
    "pareto",
    "phase",
    "sticking",
    "stroboscope",
]
