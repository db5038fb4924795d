"""The examples in docstrings give what they say."""

import doctest
import inspect
from io import StringIO

import numpy as np
import pytest

import manutec_r3 as r3

EXAMPLES = [
    example
    for name in r3.__all__
    if not inspect.ismodule(thing := getattr(r3, name))
    for example in doctest.DocTestFinder().find(thing, name, globs={"np": np, "r3": r3})
    if example.examples
]


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda example: example.name)
def test_an_example_gives_what_it_says(example, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    said = StringIO()
    failed, _ = doctest.DocTestRunner().run(example, out=said.write)
    assert failed == 0, said.getvalue()


def test_where_users_begin_there_are_examples():
    begin = {"Load", "Robot", "Scenario", "Simulator", "check", "compare", "simulate"}
    begin |= {"Result.at", "Result.load", "Result.save", "simulate_many"}
    begin |= {"FunctionMotion", "Hold", "Quintic", "Sequence", "Spline", "Trapezoid"}
    assert begin <= {example.name for example in EXAMPLES}
