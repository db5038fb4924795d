"""Draws the pictures of the README: `python notebooks/draw_pictures.py`.

`blocks.svg` shows the parts of which every axis is made (report, section 3), with the symbols of
the report: a left superscript `a` means the side of the arm, `r` the side of the rotor.
`figure9.png` is what `manutec-r3 run figure9` draws, with fewer pixels.
`precision.png` shows what a tolerance means and what it costs, for each method; its times are those
of the machine that draws it, relative to each other.
`animation.png` is what `Result.animate` writes, as Chromium shows it; without one it is left out.
`icon.png`, in the package, is what importers show of an exported robot.
"""

import shutil
import subprocess
from pathlib import Path
from tempfile import TemporaryDirectory

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, FancyBboxPatch
from matplotlib.ticker import LogLocator, NullLocator

import manutec_r3 as r3
from manutec_r3.bench.precision import Point, work_precision
from manutec_r3.comparison.accuracy import PROMISED
from manutec_r3.plot import figure9, new_figure

PICTURES = Path(__file__).parent / "pictures"
ICON = Path(__file__).parents[1] / "python/manutec_r3/export/fmu/icon.png"

TEXT = "#333a42"
LINE = "#5d6771"
FAINT = "#b4bcc4"
CONTROLLER, MOTOR, MECHANICS = "#e3eefa", "#fdefd8", "#e6f0e4"
SWITCHES = "#c0392b"  # the characteristics whose branches make events
COLOURS = {"erk": "#0b3c6f", "bdf": "#e08a1e", "exponential": "#2e7d4f"}  # of methods

# Corners of the characteristics, both coordinates from -1 to 1.
DEAD_ZONE = [(-1.0, -0.75), (-0.3, 0.0), (0.3, 0.0), (1.0, 0.75)]
SATURATION = [(-1.0, -0.6), (-0.5, -0.6), (0.5, 0.6), (1.0, 0.6)]
FRICTION = [(-1.0, -0.85), (0.0, -0.45), (0.0, 0.45), (1.0, 0.85)]
BACKLASH = [(-1.0, -0.9), (-0.4, 0.0), (0.4, 0.0), (1.0, 0.9)]


class Block:
    """A box with a heading and, below it, lines of text; knows where arrows end."""

    def __init__(
        self,
        panel: Axes,
        centre: tuple[float, float],
        size: tuple[float, float],
        colour: str,
        heading: str,
        *lines: str,
    ) -> None:
        self.x, self.y = centre
        self.width, self.height = size
        self.left, self.right = self.x - size[0] / 2, self.x + size[0] / 2
        self.bottom, self.top = self.y - size[1] / 2, self.y + size[1] / 2
        panel.add_patch(
            FancyBboxPatch(
                (self.left, self.bottom),
                *size,
                boxstyle="round,pad=0,rounding_size=0.07",
                facecolor=colour,
                edgecolor=LINE,
                linewidth=1.0,
            )
        )
        panel.text(
            self.x,
            self.top - 0.1,
            heading,
            ha="center",
            va="top",
            fontsize=10.5,
            fontweight="bold",
            color=TEXT,
        )
        gap = (self.height - 0.36) / max(len(lines), 1)
        for k, line in enumerate(lines):
            write(panel, self.x, self.top - 0.34 - (k + 0.45) * gap, line)


def write(
    panel: Axes, x: float, y: float, words: str, ha: str = "center", size: float = 11
) -> None:
    """Write words, or a formula, around a point."""
    panel.text(x, y, words, ha=ha, va="center", fontsize=size, color=TEXT)


def arrow(panel: Axes, *corners: tuple[float, float]) -> None:
    """Draw a line along corners, with an arrowhead at its end."""
    xs, ys = zip(*corners[:-1], strict=True)
    panel.plot(xs, ys, color=LINE, linewidth=1.3, solid_capstyle="butt")
    panel.annotate(
        "",
        xy=corners[-1],
        xytext=corners[-2],
        arrowprops={
            "arrowstyle": "-|>",
            "color": LINE,
            "linewidth": 1.3,
            "shrinkA": 0,
            "shrinkB": 0,
        },
    )


def characteristic(
    panel: Axes, x: float, y: float, corners: list[tuple[float, float]], size: float = 0.32
) -> None:
    """Draw a piecewise linear characteristic on its own small axes."""
    panel.plot([x - 1.15 * size, x + 1.15 * size], [y, y], color=FAINT, linewidth=0.9)
    panel.plot([x, x], [y - size, y + size], color=FAINT, linewidth=0.9)
    panel.plot(
        [x + size * u for u, _ in corners],
        [y + size * v for _, v in corners],
        color=SWITCHES,
        linewidth=2.0,
        solid_joinstyle="round",
    )


def blocks() -> Figure:
    """Draw the blocks of an axis and what flows between them."""
    width, height = 10.4, 5.75
    figure = Figure(figsize=(width, height))
    panel = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    panel.set(xlim=(0.0, width), ylim=(0.0, height))
    panel.axis("off")
    card = FancyBboxPatch(
        (0.03, 0.03),
        width - 0.06,
        height - 0.06,
        boxstyle="round,pad=0,rounding_size=0.15",
        facecolor="white",
        edgecolor=FAINT,
        linewidth=0.8,
    )
    panel.add_patch(card)

    top, middle, bottom, tall = 4.72, 2.95, 1.05, 1.3

    # --- from the reference to the torque of the motor, left to right -----------------------------
    reference = Block(
        panel, (0.85, top), (1.1, tall), CONTROLLER, "reference", r"${}^a q_d$", r"${}^a \dot q_d$"
    )
    position = Block(
        panel,
        (2.72, top),
        (1.72, tall),
        CONTROLLER,
        "position controller",
        r"$K_V\,(p\;{}^a q_d - {}^r q)$",
        r"$+\;K_D\;p\;{}^a \dot q_d$",
    )
    rate = Block(
        panel,
        (5.28, top),
        (1.5, tall),
        CONTROLLER,
        "rate controller",
        r"$\dfrac{K_S\,(T_0 s + 1)}{s\,(T_e s + 1)}$",
    )
    dead_zone = Block(panel, (6.98, top), (1.02, tall), MOTOR, "NL1")
    characteristic(panel, dead_zone.x, top - 0.13, DEAD_ZONE)
    motor = Block(
        panel, (8.28, top), (0.98, tall), MOTOR, "motor", r"$K_M$,  PT2", r"$\omega_i,\;D_i$"
    )
    limit = Block(panel, (9.6, top), (1.02, tall), MOTOR, "NL2")
    characteristic(panel, limit.x, top - 0.13, SATURATION)
    for block, caption in ((dead_zone, r"dead zone $\pm a$"), (limit, r"limit $\pm b$")):
        write(panel, block.x, block.bottom - 0.17, caption, size=10)

    junction = (4.12, top)
    radius = 0.11
    panel.add_patch(Circle(junction, radius, facecolor="white", edgecolor=LINE, linewidth=1.2))
    arrow(panel, (reference.right, top), (position.left, top))
    arrow(panel, (position.right, top), (junction[0] - radius, top))
    arrow(panel, (junction[0] + radius, top), (rate.left, top))
    arrow(panel, (rate.right, top), (dead_zone.left, top))
    arrow(panel, (dead_zone.right, top), (motor.left, top))
    arrow(panel, (motor.right, top), (limit.left, top))
    above = top + 0.18
    write(panel, 3.78, above, "$u_c$")
    write(panel, 4.38, above, "$e$")
    write(panel, 6.25, above, "$U$")
    write(panel, 7.64, above, "$v$")
    write(panel, 8.93, above, "$m$")

    # --- back from the rate of the rotor, right to left -------------------------------------------
    low = 0.98
    tacho = Block(
        panel,
        (7.45, middle),
        (1.62, low),
        CONTROLLER,
        "tachogenerator",
        r"$K_T,\;\omega_e,\;\omega_p,\;D_p$",
    )
    filtered = Block(
        panel, (5.28, middle), (1.5, low), CONTROLLER, "filter", r"$\dfrac{T_a s + 1}{T_b s + 1}$"
    )
    arrow(panel, (tacho.left, middle), (filtered.right, middle))
    arrow(panel, (filtered.left, middle), (junction[0], middle), (junction[0], top - radius))
    write(panel, 6.34, middle + 0.18, "$u_t$")
    write(panel, 4.3, middle + 0.18, "$y$")
    write(panel, junction[0] - 0.17, top - 0.28, r"$-$")

    # --- rotor, gear and arm, right to left -------------------------------------------------------
    rotor = Block(panel, (8.7, bottom), (2.4, tall), MECHANICS, "rotor")
    write(panel, 8.1, bottom + 0.0, r"${}^r J\;{}^r \ddot q =$")
    write(panel, 8.1, bottom - 0.35, r"${}^r F - \tau - {}^r M$")
    characteristic(panel, 9.35, bottom - 0.06, FRICTION)
    gear = Block(panel, (5.42, bottom), (2.5, tall), MECHANICS, "gear")
    write(panel, 4.83, bottom + 0.0, r"$\delta = {}^r q - p\;{}^a q$")
    write(panel, 4.83, bottom - 0.35, r"$\tau = c\,s + d\,\dot\delta$")
    characteristic(panel, 6.13, bottom - 0.06, BACKLASH)
    arm = Block(
        panel,
        (1.55, bottom),
        (2.5, tall),
        MECHANICS,
        "six arms and load",
        r"$M({}^a q)\;{}^a \ddot q$",
        r"$=\;{}^a h({}^a q,\;{}^a \dot q) + {}^a F$",
    )
    write(panel, 9.35, rotor.bottom + 0.13, "NL3 friction", size=9.5)
    write(panel, 6.13, gear.bottom + 0.13, "NL4 backlash", size=9.5)

    forward, back = bottom + 0.2, bottom - 0.25
    arrow(panel, (limit.right, top), (10.24, top), (10.24, bottom), (rotor.right, bottom))
    write(panel, 10.06, 3.6, r"${}^r F$")
    arrow(panel, (rotor.left, forward), (gear.right, forward))
    arrow(panel, (gear.right, back), (rotor.left, back))
    write(panel, 7.08, forward + 0.2, r"${}^r q,\;{}^r \dot q$")
    write(panel, 7.08, back - 0.2, r"$\tau$")
    arrow(panel, (gear.left, forward), (arm.right, forward))
    arrow(panel, (arm.right, back), (gear.left, back))
    write(panel, 3.48, forward + 0.2, r"${}^a F = p\,\tau$")
    write(panel, 3.48, back - 0.2, r"${}^a q,\;{}^a \dot q$")

    arrow(panel, (8.7, rotor.top), (8.7, middle), (tacho.right, middle))
    write(panel, 8.88, 2.42, r"${}^r \dot q$")
    arrow(panel, (7.75, rotor.top), (7.75, 2.05), (position.x, 2.05), (position.x, position.bottom))
    write(panel, 7.58, 1.87, r"${}^r q$")

    # --- explanation ------------------------------------------------------------------------------
    write(panel, 0.3, 3.3, "one chain for each axis", ha="left", size=10)
    write(panel, 0.3, 3.05, "axes 1 to 3: elastic gear", ha="left", size=10)
    write(panel, 0.3, 2.8, "axes 4 to 6: rigid gear", ha="left", size=10)
    panel.plot([0.3, 0.52], [2.55, 2.55], color=SWITCHES, linewidth=2.0)
    write(panel, 0.6, 2.55, "switches: events", ha="left", size=10)
    return figure


def circle(panel: Axes, x: float, y: float, colour: str, label: str | None = None) -> None:
    """Draw a circle around a point of a curve."""
    panel.plot(
        *(x, y),
        color=colour,
        marker="o",
        markersize=11,
        markerfacecolor="none",
        markeredgewidth=1.8,
        linestyle="none",
        label=label,
    )


def precision(points: list[Point]) -> Figure:
    """Draw errors over tolerance, over evaluations and over time, a curve for each method."""
    default = next(point for point in points if point.is_default)
    panels_of = {
        "rtol": lambda point: point.rtol,
        "evaluations, thousands": lambda point: point.outcome.evaluations / 1e3,
        f"time, {default.method} by default = 1": lambda point: (
            point.time.minimum / default.time.minimum
        ),
    }
    figure = Figure(figsize=(10.4, 3.9), layout="constrained")
    panels = figure.subplots(1, len(panels_of), sharey=True)
    for panel, (label, place) in zip(panels, panels_of.items(), strict=True):
        for method, colour in COLOURS.items():
            curve = [point for point in points if point.method == method]
            if not curve:
                continue
            x = [place(point) for point in curve]
            y = [point.outcome.error for point in curve]
            panel.plot(x, y, color=colour, linewidth=1.6, marker="o", markersize=3.5, label=method)
            k = next(k for k, point in enumerate(curve) if point.is_default)
            circle(panel, x[k], y[k], colour)
        panel.axhline(PROMISED, color=SWITCHES, linewidth=1.0, linestyle="--", zorder=0)
        panel.set(xscale="log", yscale="log")
        panel.set_xlabel(label, fontsize=10, color=TEXT)
        panel.grid(color=FAINT, linewidth=0.4, alpha=0.6)
        panel.tick_params(colors=TEXT, labelsize=9)
        for side in ("top", "right"):
            panel.spines[side].set_visible(False)
    panels[0].invert_xaxis()
    panels[0].set_ylabel("error, parts of an axis' range", fontsize=10, color=TEXT)
    panels[0].text(
        *(1e-11, 1.3 * PROMISED), "promised", fontsize=9, color=SWITCHES, ha="right", va="bottom"
    )
    panels[0].xaxis.set_minor_locator(NullLocator())
    for panel in panels[1:]:
        panel.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        panel.xaxis.set_major_formatter("{x:g}")
        panel.xaxis.set_minor_locator(NullLocator())
    circle(panels[0], np.nan, np.nan, TEXT, label="default")
    panels[0].legend(frameon=False, fontsize=9, labelcolor=TEXT, loc="lower left")
    return figure


def icon() -> Figure:
    """Draw the arm, as exported FMUs show it."""
    figure = Figure(figsize=(1.0, 1.0))
    panel = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    robot = r3.Robot(model=1)
    places = robot.link_poses([0.0, -0.7, -1.1, 0.0, -0.5, 0.0])[:, [1, 2], 3]
    tip = places[-1] + 1.4 * (places[-1] - places[-2]) * 0.25
    height = robot.parameters["table_3"]["shoulder_height"]
    chain = np.array([[0.0, 0.15 - height], *places[1:], tip])
    panel.plot(*chain.T, color=COLOURS["erk"], linewidth=7.0, solid_capstyle="round")
    panel.plot(*chain[1:-1].T, "o", color=COLOURS["bdf"], markersize=5.0)
    panel.plot([-0.4, 0.4], [-height, -height], color=TEXT, linewidth=4.0)
    panel.set_aspect("equal", adjustable="datalim")
    panel.margins(0.12)
    panel.set_axis_off()
    return figure


def photograph(result: r3.Result, time: float, path: Path) -> None:
    """Write how the page of a run looks at an instant [s]."""
    with TemporaryDirectory() as folder:
        page = Path(folder) / "run.html"
        result.animate(page)
        browser = [
            "chromium",
            "--headless",
            "--no-sandbox",
            "--use-angle=swiftshader",  # WebGL without a graphics card
            "--enable-unsafe-swiftshader",
            "--hide-scrollbars",
            "--window-size=1280,800",
            "--virtual-time-budget=20000",  # until all is drawn [ms]
        ]
        address = f"{page.as_uri()}#{time}"
        subprocess.run([*browser, f"--screenshot={path}", address], check=True, capture_output=True)


def main(folder: Path = PICTURES, repeats: int = 15) -> None:
    """Write all pictures; times are the least of so many repeats."""
    icon().savefig(ICON, dpi=128, transparent=True)
    # Words as outlines look the same everywhere; without salt and date so does the file.
    with mpl.rc_context({"svg.fonttype": "path", "svg.hashsalt": "blocks", "path.simplify": True}):
        blocks().savefig(folder / "blocks.svg", transparent=True, metadata={"Date": None})
        figure = new_figure()
        figure9(r3.Scenario.load("figure9").run(), figure)
        figure.savefig(folder / "figure9.png", dpi=200)
        points = work_precision(r3.Scenario.load("figure9-quintic"), repeats=repeats)
        precision(points).savefig(folder / "precision.png", dpi=110)
    if shutil.which("chromium"):
        photograph(r3.Scenario.load("figure9-quintic").run(), 0.9, folder / "animation.png")


if __name__ == "__main__":
    main()
