"""The model description of an FMU, in FMI 2.0 and 3.0: what an importer reads before it begins.

Every variable comes from the core (`cpp/fmu/variables.hpp`), which also serves it later.
"""

from collections.abc import Iterator, Sequence
from itertools import product
from math import prod
from typing import NamedTuple
from xml.etree import ElementTree as ET

# The binary's name; it is the same for every robot.
MODEL_IDENTIFIER = "manutec_r3"


class Variable(NamedTuple):
    """A variable as the core describes it; arrays in one piece.

    `derivative_of` is the value reference of the state that it is the derivative of.
    """

    name: str
    unit: str
    text: str
    group: str
    shape: tuple[int, ...]
    value_reference: int
    start: Sequence[float]
    nominal: Sequence[float]
    derivative_of: int | None

    @property
    def is_integer(self) -> bool:
        """Whether its values are whole numbers."""
        return self.group in ("branch", "n_events")

    @property
    def initial(self) -> str:
        """Where its initial value comes from: the importer, or the FMU."""
        return "exact" if self.start else "calculated"

    @property
    def is_initial_unknown(self) -> bool:
        """Whether the FMU computes its initial value, and an importer may want to know."""
        of_interest = self.group in (*_OUTPUTS, "state", "derivative")
        return of_interest and self.initial == "calculated"


class Model(NamedTuple):
    """What a description is made of."""

    name: str
    text: str
    token: str
    version: str
    stop_time: float
    tolerance: float
    variables: tuple[Variable, ...]


_OUTPUTS = ("signal", "energy", "branch", "n_events")
_CAUSALITY = {
    "time": "independent",
    "parameter": "parameter",
    "input": "input",
    **dict.fromkeys(_OUTPUTS, "output"),
    **dict.fromkeys(("state", "derivative", "indicator"), "local"),
}
_VARIABILITY = {"parameter": "fixed", "branch": "discrete", "n_events": "discrete"}

_LOG_CATEGORIES = {
    "logEvents": "Every event: when, which element, which branch before and after",
    "logStatusError": "What was wrong, what was expected, what arrived",
    "logStatusDiscard": "Why a step or an evaluation was given up",
}


def description_3(model: Model) -> bytes:
    """Return ``modelDescription.xml`` of FMI 3.0."""
    root = ET.Element(
        "fmiModelDescription",
        {"fmiVersion": "3.0", "modelName": model.name, "instantiationToken": model.token}
        | _about(model),
    )
    can = dict.fromkeys(("canGetAndSetFMUState", "canSerializeFMUState"), "true")
    ET.SubElement(
        root,
        "ModelExchange",
        can,
        modelIdentifier=MODEL_IDENTIFIER,
        providesDirectionalDerivatives="true",
        needsCompletedIntegratorStep="false",
    )
    ET.SubElement(
        root,
        "CoSimulation",
        can,
        modelIdentifier=MODEL_IDENTIFIER,
        canHandleVariableCommunicationStepSize="true",
        canReturnEarlyAfterIntermediateUpdate="true",
        hasEventMode="true",
        mightReturnEarlyFromDoStep="true",
        providesIntermediateUpdate="true",
    )
    _add_common(root, model)
    variables = ET.SubElement(root, "ModelVariables")
    for variable in model.variables:
        variables.append(_variable_3(variable))
    structure = ET.SubElement(root, "ModelStructure")
    for tag, chosen in (
        ("Output", [v for v in model.variables if v.group in _OUTPUTS]),
        ("ContinuousStateDerivative", [v for v in model.variables if v.group == "derivative"]),
        ("InitialUnknown", [v for v in model.variables if v.is_initial_unknown]),
        ("EventIndicator", [v for v in model.variables if v.group == "indicator"]),
    ):
        for variable in chosen:
            ET.SubElement(structure, tag, valueReference=str(variable.value_reference))
    return _as_bytes(root)


def description_2(model: Model) -> bytes:
    """Return ``modelDescription.xml`` of FMI 2.0: every element of an array on its own."""
    scalars = [
        scalar
        for variable in model.variables
        if variable.group != "clock"  # which only FMI 3.0 knows
        for scalar in _elements(variable)
    ]
    root = ET.Element(
        "fmiModelDescription",
        {"fmiVersion": "2.0", "modelName": model.name, "guid": model.token} | _about(model),
        numberOfEventIndicators=str(sum(v.group == "indicator" for v in scalars)),
    )
    can = dict.fromkeys(("canGetAndSetFMUstate", "canSerializeFMUstate"), "true")
    ET.SubElement(
        root,
        "ModelExchange",
        can,
        modelIdentifier=MODEL_IDENTIFIER,
        completedIntegratorStepNotNeeded="true",
        providesDirectionalDerivative="true",
    )
    ET.SubElement(
        root,
        "CoSimulation",
        can,
        modelIdentifier=MODEL_IDENTIFIER,
        canHandleVariableCommunicationStepSize="true",
    )
    _add_common(root, model)
    variables = ET.SubElement(root, "ModelVariables")
    # Their value references count them from 0, the standard from 1.
    for scalar in scalars:
        variables.append(_variable_2(scalar))
    structure = ET.SubElement(root, "ModelStructure")
    for tag, chosen in (
        ("Outputs", [v for v in scalars if v.group in _OUTPUTS]),
        ("Derivatives", [v for v in scalars if v.group == "derivative"]),
        ("InitialUnknowns", [v for v in scalars if v.is_initial_unknown]),
    ):
        unknowns = ET.SubElement(structure, tag)
        for scalar in chosen:
            ET.SubElement(unknowns, "Unknown", index=str(scalar.value_reference + 1))
    return _as_bytes(root)


def terminals_and_icons() -> bytes:
    """Return ``terminalsAndIcons.xml`` of FMI 3.0: where the icon is, a square."""
    root = ET.Element("fmiTerminalsAndIcons", fmiVersion="3.0")
    graphics = ET.SubElement(root, "GraphicalRepresentation")
    corners = {"x1": "-100", "y1": "-100", "x2": "100", "y2": "100"}
    ET.SubElement(graphics, "CoordinateSystem", corners, suggestedScalingFactorTo_mm="0.1")
    ET.SubElement(graphics, "Icon", corners)
    return _as_bytes(root)


def _about(model: Model) -> dict[str, str]:
    return {
        "description": model.text,
        "author": "manutec_r3 contributors",
        "version": model.version,
        "license": "BSD-3-Clause",
        "generationTool": f"manutec_r3 {model.version}",
        "variableNamingConvention": "structured",
    }


def _add_common(root: ET.Element, model: Model) -> None:
    """Add what both versions have alike, in this order."""
    units = ET.SubElement(root, "UnitDefinitions")
    for unit in sorted({v.unit for v in model.variables if v.unit}):
        definition = ET.SubElement(units, "Unit", name=unit)
        exponents = {base: str(exponent) for base, exponent in base_units(unit).items()}
        ET.SubElement(definition, "BaseUnit", exponents)
        if unit in ("rad", "rad/s"):
            degrees = unit.replace("rad", "deg")
            ET.SubElement(definition, "DisplayUnit", name=degrees, factor="57.29577951308232")
    categories = ET.SubElement(root, "LogCategories")
    for name, text in _LOG_CATEGORIES.items():
        ET.SubElement(categories, "Category", name=name, description=text)
    ET.SubElement(
        root,
        "DefaultExperiment",
        startTime="0",
        stopTime=repr(model.stop_time),
        tolerance=repr(model.tolerance),
    )


def _variable_3(variable: Variable) -> ET.Element:
    if variable.group == "clock":
        return ET.Element(
            "Clock",
            {"name": variable.name, "valueReference": str(variable.value_reference)},
            description=variable.text,
            causality="input",
            intervalVariability="fixed",
        )
    element = ET.Element(
        "Int32" if variable.is_integer else "Float64",
        {"name": variable.name, "valueReference": str(variable.value_reference)} | _kind(variable),
    )
    for extent in variable.shape:
        ET.SubElement(element, "Dimension", start=str(extent))
    if variable.unit:
        element.set("unit", variable.unit)
    if variable.nominal:
        # One for all elements; importers ask the FMU for those of each state.
        element.set("nominal", repr(min(variable.nominal)))
    if variable.start:
        element.set("start", " ".join(map(repr, variable.start)))
    if variable.derivative_of is not None:
        element.set("derivative", str(variable.derivative_of))
    if variable.group == "state":
        element.set("reinit", "true")
    if variable.group in _OUTPUTS:
        element.set("intermediateUpdate", "true")
    return element


def _elements(variable: Variable) -> Iterator[Variable]:
    """Elements of an array as variables: ``joint_angle[1]``, ``der(state.joint_angle[1])``."""
    if not variable.shape:
        yield variable
        return
    places = product(*(range(1, extent + 1) for extent in variable.shape))
    for k, place in zip(range(prod(variable.shape)), places, strict=True):
        index = f"[{','.join(map(str, place))}]"
        name = variable.name
        yield variable._replace(
            name=name.replace(")", f"{index})") if ")" in name else name + index,
            shape=(),
            value_reference=variable.value_reference + k,
            start=variable.start[k : k + 1],
            nominal=variable.nominal[k : k + 1],
            derivative_of=None if variable.derivative_of is None else variable.derivative_of + k,
        )


def _variable_2(scalar: Variable) -> ET.Element:
    element = ET.Element(
        "ScalarVariable",
        {"name": scalar.name, "valueReference": str(scalar.value_reference)} | _kind(scalar),
    )
    if scalar.is_integer:
        ET.SubElement(element, "Integer")
        return element
    real = ET.SubElement(element, "Real")
    if scalar.unit:
        real.set("unit", scalar.unit)
    if scalar.nominal:
        real.set("nominal", repr(scalar.nominal[0]))
    if scalar.start:
        real.set("start", repr(scalar.start[0]))
    if scalar.derivative_of is not None:
        real.set("derivative", str(scalar.derivative_of + 1))
    if scalar.group == "state":
        real.set("reinit", "true")
    return element


def _kind(variable: Variable) -> dict[str, str]:
    kind = {
        "description": variable.text,
        "causality": _CAUSALITY[variable.group],
        "variability": _VARIABILITY.get(variable.group, "continuous"),
    }
    if variable.group not in ("time", "input"):  # of which the standard knows it
        kind["initial"] = variable.initial
    return kind


def _as_bytes(root: ET.Element) -> bytes:
    ET.indent(root)
    return ET.tostring(root, encoding="utf-8", xml_declaration=True)


# --- units --------------------------------------------------------------------------------------

_BASE_UNITS = {
    "1": {},
    "kg": {"kg": 1},
    "m": {"m": 1},
    "s": {"s": 1},
    "A": {"A": 1},
    "rad": {"rad": 1},
    "N": {"kg": 1, "m": 1, "s": -2},
    "J": {"kg": 1, "m": 2, "s": -2},
    "W": {"kg": 1, "m": 2, "s": -3},
    "V": {"kg": 1, "m": 2, "s": -3, "A": -1},
}


def base_units(unit: str) -> dict[str, int]:
    """Return the exponents of the base units in a unit such as ``N m s/rad`` or ``rad/s^2``.

    Raises
    ------
    KeyError
        If it consists of units that are not known.
    """
    above, _, below = unit.partition("/")
    exponents: dict[str, int] = {}
    for part, sign in ((above, 1), (below, -1)):
        for factor in part.split():
            symbol, _, power = factor.partition("^")
            for base, exponent in _BASE_UNITS[symbol].items():
                exponents[base] = exponents.get(base, 0) + sign * int(power or 1) * exponent
    return {base: exponent for base, exponent in exponents.items() if exponent}
