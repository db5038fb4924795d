"""The stubs of the compiled modules name what these have, no more and no less, with its types.

What a compiled function takes and returns stands in the first line of its docstring.
"""

import ast
from pathlib import Path

import pytest

import manutec_r3
from manutec_r3 import _core, _processor

MODULES = {"_core": _core, "_processor": _processor}


def stub_of(module):
    path = Path(manutec_r3.__file__).with_name(f"{module}.pyi")
    return ast.parse(path.read_text(encoding="utf-8"))


STUB = stub_of("_core")
CLASSES = [node for node in STUB.body if isinstance(node, ast.ClassDef)]
FUNCTIONS = [
    (where, node)
    for where, body in [("", STUB.body), *((cls.name, cls.body) for cls in CLASSES)]
    for node in body
    if isinstance(node, ast.FunctionDef)
]
ALIASES = {
    node.targets[0].id: ast.unparse(node.value)
    for node in STUB.body
    if isinstance(node, ast.Assign)
}


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


def compiled(where, name):
    """The signature of a function, a method or a property of the core, as pybind11 tells it."""
    thing = vars(getattr(_core, where) if where else _core)[name]
    text = (thing.fget if isinstance(thing, property) else thing).__doc__.splitlines()[0]
    text = text.replace("::", ".")
    return ast.parse(f"def {name}{text.removeprefix(name)}: ...").body[0]


def returned(function):
    """What it returns: the name of the type, of arrays with that of their numbers."""
    text = ast.unparse(function.returns).removeprefix("typing.Annotated[")
    text = ALIASES.get(text, text).replace("numpy.typing.", "").replace("numpy.", "")
    return text if text.startswith("NDArray") else text.split("[")[0].split(".")[-1]


@pytest.mark.parametrize("module", MODULES)
def test_stub_names_everything_in_the_module(module):
    assert names(stub_of(module).body) == public(MODULES[module])


@pytest.mark.parametrize("cls", CLASSES, ids=lambda cls: cls.name)
def test_stub_names_every_member_of_every_class(cls):
    assert names(cls.body) == public(getattr(_core, cls.name))


@pytest.mark.parametrize("cls", CLASSES, ids=lambda cls: cls.name)
def test_stub_has_the_constructors_that_there_are(cls):
    has_one = any(getattr(node, "name", "") == "__init__" for node in cls.body)
    built = vars(getattr(_core, cls.name)).get("__init__")
    # What nobody but the core makes has one that says no more than that.
    assert has_one == (type(built).__name__ == "instancemethod")


@pytest.mark.parametrize(
    ("where", "function"), FUNCTIONS, ids=[f"{where}.{node.name}" for where, node in FUNCTIONS]
)
def test_stub_has_the_arguments_and_the_type_that_is_returned(where, function):
    built = compiled(where, function.name)
    of_stub = function.args.posonlyargs + function.args.args
    assert len(of_stub) == len(built.args.args)
    # Who names an argument would be told so by the core: it knows them by their places.
    assert [a.arg for a in function.args.args if a.arg != "self"] == []
    assert returned(function) == returned(built)


def test_stub_has_the_types_of_constants():
    for module, thing in MODULES.items():
        for node in stub_of(module).body:
            if isinstance(node, ast.AnnAssign):
                kind = ast.unparse(node.annotation).split("[")[0]
                assert type(getattr(thing, node.target.id)).__name__ == kind
