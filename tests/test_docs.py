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
