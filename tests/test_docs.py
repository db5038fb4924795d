"""Docstrings: every public name has one, and it names every argument."""

import inspect
import re

import pytest

import manutec_r3 as r3


def documented():
    """Functions and classes of the package, and their public methods and properties."""
    for name in r3.__all__:
        thing = getattr(r3, name)
        if inspect.ismodule(thing):
            continue
        yield name, thing
        if inspect.isclass(thing):
            for member, value in vars(thing).items():
                if not member.startswith("_") and callable(getattr(value, "__func__", value)):
                    yield f"{name}.{member}", getattr(thing, member)


every_name = pytest.mark.parametrize(
    ("name", "thing"), [pytest.param(*found, id=found[0]) for found in documented()]
)


@every_name
def test_it_has_a_docstring(name, thing):
    assert inspect.getdoc(thing)


@every_name
def test_the_docstring_names_every_argument(name, thing):
    text = inspect.getdoc(thing)
    if inspect.isclass(thing) and "Parameters\n" not in text:
        return  # only the package makes them
    for argument in inspect.signature(thing).parameters:
        if argument != "self" and not argument.startswith("_"):
            assert re.search(rf"\b{argument}\b", text), f"{name}: {argument}"


@every_name
def test_the_docstring_says_what_is_returned(name, thing):
    if inspect.isclass(thing):
        return
    returned = inspect.get_annotations(thing, eval_str=False).get("return")
    if returned not in (None, "None"):
        assert re.search(r"\bReturns?\b", inspect.getdoc(thing)), name


@every_name
def test_the_docstring_of_a_class_names_every_field(name, thing):
    if not inspect.isclass(thing):
        return
    text = " ".join(base.__doc__ or "" for base in thing.__mro__[:-1])
    for field in (*getattr(thing, "_fields", ()), *getattr(thing, "__dataclass_fields__", ())):
        assert field == "_" or re.search(rf"\b{field}\b", text), f"{name}: {field}"
