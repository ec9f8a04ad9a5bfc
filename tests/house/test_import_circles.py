"""Modules import each other in one direction: no circles, also not for annotations alone."""

import pytest

grimp = pytest.importorskip("grimp")


def circles(imports: dict[str, set[str]]) -> list[list[str]]:
    """Sets of modules that import each other in a circle: strongly connected components."""
    order, seen = [], set()

    def visit(start, edges, found):
        waiting = [(start, iter(sorted(edges[start])))]
        seen.add(start)
        while waiting:
            following = next((other for other in waiting[-1][1] if other not in seen), None)
            if following is None:
                found.append(waiting.pop()[0])
            else:
                seen.add(following)
                waiting.append((following, iter(sorted(edges[following]))))

    for module in sorted(imports):
        if module not in seen:
            visit(module, imports, order)
    backwards = {module: set() for module in imports}
    for module, others in imports.items():
        for other in others:
            backwards[other].add(module)
    seen.clear()
    found = []
    for module in reversed(order):
        if module not in seen:
            component = []
            visit(module, backwards, component)
            if len(component) > 1 or module in imports[module]:
                found.append(sorted(component))
    return sorted(found)


def test_no_modules_import_each_other_in_a_circle():
    graph = grimp.build_graph("isotorque", cache_dir=None)
    imports = {module: graph.find_modules_directly_imported_by(module) for module in graph.modules}
    assert len(imports) > 300
    assert sum(map(len, imports.values())) > 1000
    assert circles(imports) == []


def test_circles_are_found():
    chain = {"a": {"b"}, "b": {"c"}, "c": set(), "d": {"a", "c"}}
    assert circles(chain) == []
    assert circles(chain | {"c": {"a"}}) == [["a", "b", "c"]]
    assert circles(chain | {"c": {"b"}, "d": {"d"}}) == [["b", "c"], ["d"]]
