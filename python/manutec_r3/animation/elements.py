"""What switches in an axis, in the words and colours of the page and of the live view."""

from ..events import Event

# Branches -1, 0, +1 of each element.
WORDS = {
    "friction": ("slides backward", "sticks", "slides forward"),
    "dead_zone": ("below the dead zone", "in the dead zone", "above the dead zone"),
    "torque_limit": (
        "at its lower torque limit",
        "within its torque limits",
        "at its torque limit",
    ),
    "voltage_limit": (
        "at its lower voltage limit",
        "within its voltage limits",
        "at its voltage limit",
    ),
    "backlash": ("in contact \N{MINUS SIGN}", "in the gap", "in contact +"),
    "limit": ("beyond its lower limit", "within its limits", "beyond its limit"),
}
# Of a joint as its friction is: told apart with any colour vision.
FRICTION_COLOURS = ("#2878b5", "#8d97a1", "#e58a1f")
REFERENCE_COLOUR = "#f2a541"


def in_words(event: Event) -> str:
    """Return what an event has led to."""
    if event.element in WORDS:
        return f"axis {event.axis} {WORDS[event.element][event.after + 1]}"
    return {"reference": "knot of the reference", "sample": "sample"}[event.element]
