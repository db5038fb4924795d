"""The documentation that lies in an FMU."""

from html import escape

from ... import html
from ...scenario import Scenario
from .model_description import Model

_USE = """
<p>Model Exchange: the FMU has its branches frozen between events. All indicators are positive on
the present branches; right after an event those that stand at zero are lifted by 1e-11 of their
magnitude until the next one. Rates of what sticks are exactly zero. Indicators and states are named
variables; derivatives by direction are differences of the order of 1e-10 of what they are.</p>
<p>Co-Simulation: the FMU integrates itself and locates its events within roundoff. Inputs are held
between communication points, and a reference goes on with its rate. With event mode and early
return a step ends at each event.</p>
<p>Simulations begin at 0 s. Parameters can be set until initialisation ends; options are fixed. The
log category logEvents tells every event.</p>
"""


def page(scenario: Scenario, model: Model, fmi: str) -> str:
    """Return the page: what the robot is, what can be set, what can be read."""
    groups = {
        "Inputs": ("input",),
        "Outputs": ("signal", "energy", "branch", "n_events"),
        "Parameters": ("parameter",),
        "States": ("state",),
    }
    tables = "".join(
        html.table(
            title,
            ("name", "unit", "size", "meaning"),
            [
                (v.name, v.unit, " x ".join(map(str, v.shape)) or "1", v.text)
                for v in model.variables
                if v.group in members
            ],
        )
        for title, members in groups.items()
    )
    return f"""<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>{escape(model.name)}</title>
<style>body {{ font-family: sans-serif; max-width: 60em; margin: 2em auto }}
td, th {{ padding: 0.1em 0.6em; text-align: left !important; vertical-align: top }}
table {{ margin: 1.5em 0 }}</style></head>
<body><h1>{escape(model.name)}</h1><p>{escape(model.text)}</p>
<p>FMI {fmi}, by manutec_r3 {escape(model.version)}: the robot Manutec r3 with its drives and
controllers (Franke, Otter: The Manutec r3 Benchmark Models for the Dynamic Simulation of Robots,
DLR TR R 101-93, 1993).</p>
{_USE}{scenario._repr_html_()}{tables}</body></html>
"""
