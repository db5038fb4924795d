"""The stub of the compiled core names what the core has, no more and no less."""

import ast
from pathlib import Path

import manutec_r3
from manutec_r3 import _core

STUB = ast.parse(Path(manutec_r3.__file__).with_name("_core.pyi").read_text(encoding="utf-8"))


def names(body):
    """Public names that a module or a class of the stub defines."""
    found = set()
    for node in body:
        if isinstance(node, ast.ClassDef | ast.FunctionDef):
            found.add(node.name)
        elif isinstance(node, ast.AnnAssign):
            found.add(node.target.id)
        elif isinstance(node, ast.Assign):
            found |= {target.id for target in node.targets}
    return {name for name in found if not name.startswith("_")}


def public(thing):
    return {name for name in vars(thing) if not name.startswith("_")}


def test_stub_names_everything_in_the_core():
    assert names(STUB.body) == public(_core)


def test_stub_names_every_member_of_every_class():
    for node in STUB.body:
        if isinstance(node, ast.ClassDef):
            cls = getattr(_core, node.name)
            assert names(node.body) == public(cls), node.name
