"""A contract that finds imports which the import graph does not show."""

from __future__ import annotations

import ast
import importlib.util
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from importlinter import Contract, ContractCheck, fields, output

DYNAMIC_MODULES = frozenset(
    {"builtins", "ctypes", "imp", "importlib", "pkgutil", "runpy", "zipimport"}
)
"""Modules that import others by name; of importlib, metadata and resources are harmless."""

HARMLESS = frozenset({"metadata", "resources"})

DYNAMIC_NAMES = frozenset({"__import__", "__builtins__", "__loader__", "__spec__", "eval", "exec"})

DYNAMIC_ATTRIBUTES = frozenset(
    {
        "__builtins__",
        "__globals__",
        "__import__",
        "__loader__",
        "__spec__",
        "f_globals",
        "import_module",
    }
)


@dataclass(frozen=True)
class Module:
    """A module's source.

    Attributes
    ----------
    name : str
        Its full name.
    path : Path
        Its file.
    """

    name: str
    path: Path

    @cached_property
    def tree(self) -> ast.Module:
        """The syntax tree."""
        return ast.parse(self.path.read_text(encoding="utf-8"), str(self.path))

    @cached_property
    def bindings(self) -> dict[str, tuple[str, str | None]]:
        """Names bound outside functions by imports, or as other names of what these bind.

        Each stands for a module (and None), or for a name in a module.
        """
        return dict(self._bound(_outside_functions(self.tree)))

    @cached_property
    def all_bindings(self) -> dict[str, tuple[str, str | None]]:
        """The same for all imports, those inside functions too."""
        return dict(self._bound(ast.walk(self.tree)))

    def imported_from(self, node: ast.ImportFrom) -> str:
        """Return the full name of the module that a ``from`` import names."""
        if not node.level:
            return node.module or ""
        parts = self.name.split(".")
        keep = len(parts) - node.level + (self.path.name == "__init__.py")
        return ".".join([*parts[:keep], *([node.module] if node.module else [])])

    def _bound(self, nodes: Iterator[ast.AST]) -> Iterator[tuple[str, tuple[str, str | None]]]:
        for node in nodes:
            if isinstance(node, ast.Import):
                for alias in node.names:
                    top = alias.name if alias.asname else alias.name.split(".")[0]
                    yield alias.asname or top, (top, None)
            elif isinstance(node, ast.ImportFrom):
                for alias in node.names:
                    yield alias.asname or alias.name, (self.imported_from(node), alias.name)
            elif isinstance(node, ast.Assign) and isinstance(node.value, ast.Name):
                for target in node.targets:
                    if isinstance(target, ast.Name) and target.id != node.value.id:
                        yield target.id, (self.name, node.value.id)


class HiddenImportsContract(Contract):
    """Modules import nothing dynamically, and nothing forbidden that others imported for them.

    Options
    -------
    source_modules
        Packages whose modules are read.
    forbidden_modules
        What they must not reach through names that other modules happen to have imported.

    Notes
    -----
    The import graph has an edge to the module that is named. A name that this module has itself
    imported from elsewhere, as in
    ``from isotorque.learning.simulator.simulated_body import Robot``, is traced here to the module
    that defines it; so are attributes of modules. Dynamic imports have no edge at all:
    importlib and its kin, ``__import__``, ``exec``, ``eval`` and ``sys.modules`` are refused, and
    so are the namespaces of other modules, which serve the same end.
    """

    type_name = "hidden_imports"

    source_modules = fields.ListField(subfield=fields.StringField())
    forbidden_modules = fields.ListField(subfield=fields.StringField())

    def check(self, graph: Any, verbose: bool) -> ContractCheck:
        """Return every violation as a line of text."""
        sources = _Sources(_paths(graph.modules))
        found = []
        for name in sorted(sources.names):
            if any(_inside(name, package) for package in self.source_modules):
                module = sources.module(name)
                found += list(_dynamic(module, sources))
                found += list(_borrowed(module, sources, self.forbidden_modules))
        return ContractCheck(kept=not found, metadata={"found": found})

    def render_broken_contract(self, check: ContractCheck) -> None:
        """Print the violations."""
        for line in check.metadata["found"]:
            output.print_error(f"- {line}", bold=False)
        output.new_line()


class _Sources:
    """The modules whose source can be read, by name."""

    def __init__(self, paths: dict[str, Path]) -> None:
        self._modules = {name: Module(name, path) for name, path in paths.items()}
        self.names = frozenset(self._modules)

    def module(self, name: str) -> Module:
        return self._modules[name]

    def origin(self, module: str, name: str) -> tuple[str, str]:
        """Return where a name of a module comes from: the defining module, and its name there."""
        seen = set()
        while module in self.names and (module, name) not in seen:
            seen.add((module, name))
            if f"{module}.{name}" in self.names:  # a submodule
                return f"{module}.{name}", ""
            bound = self.module(module).bindings.get(name)
            if bound is None:
                return module, name
            if bound[1] is None:
                return bound[0], ""
            module, name = bound[0], bound[1]
        return module, name


def _paths(names: Any) -> dict[str, Path]:
    """Return the files of the modules that lie in packages of this project."""
    folders: dict[str, Path] = {}
    paths = {}
    for name in sorted(names):
        root, *rest = name.split(".")
        if root not in folders:
            spec = importlib.util.find_spec(root)
            places = list(spec.submodule_search_locations or []) if spec else []
            folders[root] = Path(places[0]) if places else Path("/nowhere")
        if Path.cwd() not in folders[root].resolve().parents:
            continue
        base = folders[root].joinpath(*rest)
        file = base / "__init__.py" if base.is_dir() else base.with_suffix(".py")
        if file.is_file():
            paths[name] = file
    return paths


def _dynamic(module: Module, sources: _Sources) -> Iterator[str]:
    """Find what imports by name, or opens the namespace of another module."""
    bound = module.all_bindings

    def is_module(node: ast.AST) -> bool:
        if not isinstance(node, ast.Name) or node.id not in bound:
            return False
        place, name = bound[node.id]
        return name is None or not sources.origin(place, name)[1]

    for node in ast.walk(module.tree):
        what = None
        if isinstance(node, ast.Import):
            what = next((x.name for x in node.names if _top(x.name) in DYNAMIC_MODULES), None)
        elif isinstance(node, ast.ImportFrom):
            what = _dynamic_from(module.imported_from(node), [x.name for x in node.names])
        elif isinstance(node, ast.Name) and node.id in DYNAMIC_NAMES:
            what = node.id
        elif isinstance(node, ast.Attribute):
            opened = is_module(node.value) and node.attr in ("__dict__", "modules")
            what = node.attr if node.attr in DYNAMIC_ATTRIBUTES or opened else None
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.args:
            opened = node.func.id in ("getattr", "vars") and is_module(node.args[0])
            what = f"{node.func.id} of a module" if opened else None
        if what is not None:
            line = getattr(node, "lineno", "?")
            yield f"{module.name} imports dynamically: {what} (line {line})"


def _dynamic_from(source: str, names: list[str]) -> str | None:
    if _top(source) in DYNAMIC_MODULES:
        harmless = set(names) <= HARMLESS if source == "importlib" else _last(source) in HARMLESS
        return None if harmless else source
    if "*" in names:
        return f"everything in {source}"
    return "sys.modules" if source == "sys" and "modules" in names else None


def _borrowed(module: Module, sources: _Sources, forbidden: list[str]) -> Iterator[str]:
    """Find names that come from a forbidden module by way of another."""
    for node in ast.walk(module.tree):
        if isinstance(node, ast.ImportFrom):
            source = module.imported_from(node)
            steps = [(source, *sources.origin(source, alias.name)) for alias in node.names]
        elif isinstance(node, ast.Attribute):
            steps = list(_attribute_steps(node, module, sources))
        else:
            continue
        for through, origin, name in steps:
            target = next((x for x in forbidden if _inside(origin, x)), None)
            by_way = not _inside(through, target) if target else False
            # a package is no detour to its own module: that import is in the graph
            if target and by_way and not target.startswith(f"{through}."):
                what = f"{origin}.{name}" if name else origin
                yield f"{module.name} takes {what} from {through} (line {node.lineno})"


def _attribute_steps(
    node: ast.Attribute, module: Module, sources: _Sources
) -> Iterator[tuple[str, str, str]]:
    """Follow ``module.attribute.attribute``: yield where each is looked up and comes from."""
    chain: list[str] = []
    value: ast.expr = node
    while isinstance(value, ast.Attribute):
        chain.insert(0, value.attr)
        value = value.value
    if not isinstance(value, ast.Name) or value.id not in module.all_bindings:
        return
    here, name = module.all_bindings[value.id]
    if name is not None:
        here, name = sources.origin(here, name)
        if name:
            return
    for attribute in chain:
        origin, name = sources.origin(here, attribute)
        yield here, origin, name
        if name:
            return
        here = origin


def _outside_functions(tree: ast.AST) -> Iterator[ast.AST]:
    for node in ast.iter_child_nodes(tree):
        if not isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef | ast.Lambda):
            yield node
            yield from _outside_functions(node)


def _inside(name: str, package: str) -> bool:
    return name == package or name.startswith(f"{package}.")


def _top(name: str) -> str:
    return name.split(".")[0]


def _last(name: str) -> str:
    return name.split(".")[-1]
