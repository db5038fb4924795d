"""The style of all pictures: colours, sizes of print, and what every panel looks like.

Colours differ in lightness as well as in hue: they are told apart in grey print and with any colour
vision. What is expected is broad and pale and lies behind; what came out is thin and dark.
"""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SIMULATED = "#0b3c6f"
REFERENCE = "#f2a541"
EMPHASIS = "#c8501e"  # moments of a curve
SHADE = "#e3e7eb"  # intervals of time
LINE = "#9aa2ab"
TEXT = "#333a42"
TUBE = "#fbe3c0"
OUTSIDE = "#f3c6c9"
DIFFERENT = "#b3202c"
BRANCHES = {-1: "#2878b5", 0: "#c3cad1", 1: "#e58a1f"}

# Widths in print [mm].
COLUMN = 85.0
PAGE = 170.0

# Sizes of letters [pt].
HEADING = 9.0
TITLE = 8.0
LABEL = 7.5
SMALL = 6.5

# Line widths [pt].
BROAD = 2.8
THIN = 0.9
HAIR = 0.5

# A range as small as this is roundoff of something that rests, which is not to be magnified: it is
# shown in the middle of a range to be seen, in any unit.
_ROUNDOFF = 1e-9
_AROUND_REST = 0.05

# A moment of a curve.
POINT: dict[str, Any] = {
    "color": EMPHASIS,
    "marker": "o",
    "markersize": 3.6,
    "markeredgewidth": 0.9,
    "linestyle": "none",
}


def tidy(panel: "Axes") -> None:
    """Give a panel its frame, ticks and margins."""
    panel.spines[["top", "right"]].set_visible(False)
    panel.spines[["left", "bottom"]].set_color(LINE)
    panel.spines[["left", "bottom"]].set_linewidth(HAIR)
    panel.tick_params(labelsize=SMALL, color=LINE, labelcolor=TEXT, width=HAIR, length=2.5, pad=2.0)
    panel.locator_params("x", nbins=6, steps=(1, 2, 3, 5, 10))
    panel.locator_params("y", nbins=5, steps=(1, 2, 5, 10))
    panel.margins(x=0.0, y=0.1)
    for low, high, put in (
        (*panel.get_xlim(), panel.set_xlim),
        (*panel.get_ylim(), panel.set_ylim),
    ):
        if high - low < _ROUNDOFF:
            middle = 0.5 * (low + high)
            put(middle - _AROUND_REST, middle + _AROUND_REST)


def label(panel: "Axes", x: str = "", y: str = "") -> None:
    """Say what the axes of a panel are, with units."""
    if x:
        panel.set_xlabel(x, fontsize=LABEL, color=TEXT, labelpad=2.0)
    if y:
        panel.set_ylabel(y, fontsize=LABEL, color=TEXT, labelpad=3.0)


def entitle(panel: "Axes", title: str, pad: float = 4.0) -> None:
    """Write a title above a panel, on the left, so many points away."""
    panel.set_title(title, loc="left", fontsize=TITLE, fontweight="bold", color=TEXT, pad=pad)


def note(panel: "Axes", text: str) -> None:
    """Write above a panel, on the right."""
    panel.annotate(
        typeset(text),
        xy=(1.0, 1.0),
        xycoords="axes fraction",
        xytext=(0.0, 2.5),
        textcoords="offset points",
        horizontalalignment="right",
        fontsize=SMALL,
        color=TEXT,
    )


def typeset(text: str) -> str:
    """Return a text with the signs of print."""
    return text.replace("-", "\N{MINUS SIGN}").replace("^2", "\N{SUPERSCRIPT TWO}")
