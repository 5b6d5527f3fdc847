"""What the pages take from the code when they are built, so that they cannot say anything else than the code does."""

import ast
import inspect
import math
import sys
import textwrap
from collections.abc import Iterator
from pathlib import Path
from typing import Any

METHODS_HERE = "<!-- methods -->"
COSTS_HERE = "<!-- costs -->"

PYTHON_PAGE = """# Python

The command line is a thin skin over these names. Each is imported from `rbfem`; the [tutorial](tutorial.md#from-python)
has a complete example. Quantities are in SI, arrays have the bodies on axis 0, quaternions are scalar first and turn
body axes into world axes.

"""


def on_config(config: Any) -> Any:
    """Make rbfem importable from its sources; mkdocs takes back what a hook does to the path while it is loaded."""
    sys.path.insert(0, str(Path(__file__).parents[1] / "solver"))
    return config


def on_files(files: Any, config: Any) -> Any:
    """Add the pages that are made from the code as a whole."""
    from mkdocs.structure.files import File

    from rbfem.case.reference import reference_page

    for name, content in (("case_file.md", reference_page()), ("python.md", python_page())):
        files.append(File.generated(config, name, content=content))
    return files


def on_page_markdown(markdown: str, **_: Any) -> str:
    """Put what a page asks for in its place."""
    return markdown.replace(METHODS_HERE, methods_table()).replace(COSTS_HERE, plan_costs())


def methods_table() -> str:
    """The rows of `rbfem.motion.methods.METHODS`."""
    from rbfem.motion.methods import METHODS

    titles = ("method", "what it does", "order", "with dampers", "evaluations a step", "bounded to Δt ω =", "keeps")
    head = f"| {' | '.join((*titles, 'fails', 'source'))} |"
    rows = [
        f"| `{name}` | {row.summary} | {_order(row.order)} | {_order(row.damped_order)} | {_count(row)} "
        f"| {_limit(row.oscillation_limit)} | {row.preserves} | {row.fails} | {row.source} |"
        for name, row in METHODS.items()
    ]
    return "\n".join([head, "|" + "---|" * head.count(" |"), *rows])


def _order(order: float) -> str:
    return "none: exact" if math.isinf(order) else f"{order:g}"


def _count(row: Any) -> str:
    return "its own steps" if row.is_adaptive else str(row.evaluations)


def plan_costs() -> str:
    """What the plan takes the parts of a run to cost."""
    from rbfem.planning import planner

    kinds = {"a step of a coasting body": "STEP", "an evaluation of the loads": "EVALUATION", "a free flight": "FLIGHT"}
    return "".join(
        f"- {what}: {1e6 * getattr(planner, f'PYTHON_{name}'):.0f} µs interpreted, "
        f"{1e9 * getattr(planner, f'KERNEL_{name}'):.0f} ns compiled\n"
        for what, name in kinds.items()
    )


def _limit(limit: float) -> str:
    if math.isinf(limit):
        return "any"
    return f"{limit:.3g}" if limit else "none: it grows at every step"


def python_page() -> str:
    """Every public name of rbfem with its signature and docstring."""
    import rbfem

    public = [getattr(rbfem, name) for name in rbfem.__all__]
    functions = [one for one in public if inspect.isfunction(one)]
    classes = [one for one in public if inspect.isclass(one) and not issubclass(one, Exception)]
    errors = [one for one in public if inspect.isclass(one) and issubclass(one, Exception)]
    parts = [PYTHON_PAGE]
    for title, members in (("Functions", functions), ("Data", classes), ("Errors", errors)):
        parts += [f"## {title}\n", *(_entry(member) for member in members)]
    return "\n".join(parts)


def _entry(member: Any) -> str:
    lines = [f"### `{member.__name__}`\n"]
    if inspect.isfunction(member):
        lines.append(f"```python\nrbfem.{_signature(_definition(member))}\n```\n")
    lines += _docstring(member)
    if inspect.isclass(member):
        lines += [f"- `{call}`: {what}" for call, what in _members(member)]
    return "\n".join([*lines, ""])


def _docstring(member: Any) -> Iterator[str]:
    """The first paragraph as text; what follows keeps its columns."""
    first, *rest = (inspect.getdoc(member) or "").split("\n\n")
    yield f"{' '.join(first.split())}\n"
    for paragraph in rest:
        language = "pycon" if paragraph.startswith(">>>") else "text"
        yield f"```{language}\n{paragraph}\n```\n"


def _members(cls: type) -> Iterator[tuple[str, str]]:
    """Signature and first sentence of the methods and properties that are documented."""
    for node in _definition(cls).body:
        if isinstance(node, ast.FunctionDef) and not node.name.startswith("_") and ast.get_docstring(node):
            is_property = any(ast.unparse(decorator) == "property" for decorator in node.decorator_list)
            yield node.name if is_property else _signature(node), ast.get_docstring(node).partition("\n")[0]


def _definition(member: Any) -> Any:
    return ast.parse(textwrap.dedent(inspect.getsource(member))).body[0]


def _signature(node: Any) -> str:
    """As it is written, with the names of the types."""
    result = f" -> {ast.unparse(node.returns)}" if node.returns else ""
    return f"{node.name}({ast.unparse(node.args)}){result}"
