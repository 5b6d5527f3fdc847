"""YAML 1.2 as plain Python values that remember where they were written."""

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.error import MarkedYAMLError, YAMLError
from ruamel.yaml.nodes import CollectionNode, MappingNode, Node, ScalarNode, SequenceNode
from ruamel.yaml.reader import ReaderError

from rbfem.case.wording import shown
from rbfem.errors import InputError

Path = tuple[str | int, ...]
# Ten thousand bodies written one by one fit; an alias bomb does not.
MOST_VALUES = 200_000
DEEPEST = 40


@dataclass(frozen=True, order=True)
class Origin:
    """Where a value was written: `text` is what the user is told, `order` sorts errors as the file reads."""

    order: int
    text: str


@dataclass
class Document:
    """A tree of dicts, lists, strings, numbers, booleans and None, the origin of every value, and what is wrong.

    Keys are always strings. Aliases and merge keys are resolved; every alias is a copy of its own.
    """

    tree: Any = None
    origins: dict[Path, Origin] = field(default_factory=dict)
    problems: list[tuple[Origin, Path, str]] = field(default_factory=list)

    def origin(self, path: Path) -> Origin:
        """Of the value, or of the nearest one around it that was written."""
        while path and path not in self.origins:
            path = path[:-1]
        return self.origins[path]

    def complain(self, path: Path, message: str, origin: Origin | None = None) -> None:
        self.problems.append((origin or self.origin(path), path, message))

    def put(self, path: Path, value: Any, origin: Origin) -> None:
        """Write a value where its parent exists already; its parts share its origin."""
        if path:
            _descend(self.tree, path[:-1])[path[-1]] = value
        self.origins = {known: where for known, where in self.origins.items() if known[: len(path)] != path}
        self.origins[path] = origin

    def label(self, path: Path) -> str:
        """The dotted key: items of `bodies` by their name, items of other lists by their index."""
        parts = [str(part) for part in path]
        if len(path) > 1 and path[0] == "bodies":
            parts[1] = self._name_of_body(path[1])
        return ".".join(parts)

    def _name_of_body(self, index: str | int) -> str:
        bodies = self.tree.get("bodies")
        body = bodies[index] if isinstance(bodies, list) and isinstance(index, int) and index < len(bodies) else None
        name = body.get("name") if isinstance(body, dict) else None
        return name if isinstance(name, str) and name else str(index)

    def places(self) -> dict[str, str]:
        """Dotted key -> what the user is told about where it was written."""
        return {self.label(path): origin.text for path, origin in self.origins.items()}


def parse(text: str, origin_at: Callable[[int], Origin]) -> Document:
    """The one document in `text`; `origin_at` makes the origin of a line (1, 2, …).

    Raises InputError where the text is not YAML; what is merely unwelcome (a duplicate key) is in `problems`.

    >>> parse("end: 2e-3", lambda line: Origin(line, f"case.yaml:{line}")).tree
    {'end': 0.002}
    """
    node = _compose(text, origin_at)
    document = Document(origins={(): origin_at(1 if node is None else _line(node))})
    if node is not None:
        document.tree = _Builder(document, origin_at).value(node, (), _line(node))
    return document


def _compose(text: str, origin_at: Callable[[int], Origin]) -> Node | None:
    try:
        yaml = YAML(typ="safe", pure=True)
        yaml.max_depth = DEEPEST
        yaml.composer.warn_double_anchors = False
        return yaml.compose(text)
    except MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        what = ", ".join(part for part in (error.context, error.problem) if part)
        raise InputError(f"{origin_at(mark.line + 1).text}: not YAML: {_advice(what)}") from None
    except ReaderError as error:
        line = text.count("\n", 0, error.position) + 1
        character = chr(error.character) if isinstance(error.character, int) else error.character
        raise InputError(f"{origin_at(line).text}: a character that text cannot hold: {character!r}") from None
    except (YAMLError, ArithmeticError, AssertionError, AttributeError, LookupError, TypeError, ValueError) as error:
        # ruamel lets bare errors out of some malformed directives, tags and escapes
        raise InputError(f"{origin_at(1).text}: not YAML: {error}") from None


def _advice(what: str) -> str:
    what = " ".join(what.split())
    what = what if len(what) <= 160 else what[:160] + "…"
    if "'\\t'" in what:
        return f"{what}; indent with spaces, not with tabs"
    if "maximum depth" in what:
        return f"nested deeper than {DEEPEST} levels"
    if "mapping values are not allowed" in what:
        return f"{what}; put text that holds ': ' in quotes"
    return what


class _Builder:
    """Turns nodes into values, noting the origin of each."""

    def __init__(self, document: Document, origin_at: Callable[[int], Origin]) -> None:
        self.document = document
        self.origin_at = origin_at
        self.left = MOST_VALUES

    def value(self, node: Node, path: Path, key_line: int) -> Any:
        origin = self.origin_at(_line(node) if _starts_with_its_value(node) else key_line)
        self.document.origins[path] = origin
        self._count(origin, len(path))
        if node.ctag.handle is not None:
            self.document.complain(path, f"the tag {shown(str(node.ctag))} is not used here: write the value alone")
        if isinstance(node, MappingNode):
            return self._mapping(node, path)
        if isinstance(node, ScalarNode):
            return plain_value(node.value) if node.style is None else node.value
        return [self.value(item, (*path, index), _line(item)) for index, item in enumerate(node.value)]

    def _count(self, origin: Origin, depth: int) -> None:
        self.left -= 1
        if self.left < 0:
            raise InputError(f"{origin.text}: more than {MOST_VALUES} values, with what the aliases stand for")
        if depth > DEEPEST:
            raise InputError(f"{origin.text}: nested deeper than {DEEPEST} levels, or an alias inside its own anchor")

    def _mapping(self, node: MappingNode, path: Path) -> dict[str, Any]:
        pairs: dict[str, tuple[Node, Node]] = {}
        for key, value in _own_pairs(node):
            if not isinstance(key, ScalarNode):
                self.document.complain(path, "a key is a word, not a list or a group", self.origin_at(_line(key)))
            elif key.value in pairs:
                first = self.origin_at(_line(pairs[key.value][0])).text
                message = f"the key is given twice, first at {first}"
                self.document.complain((*path, key.value), message, self.origin_at(_line(key)))
            else:
                pairs[key.value] = (key, value)
        for key, value in self._merged_pairs(node, path, len(path)):
            pairs.setdefault(key.value, (key, value))
        return {name: self.value(value, (*path, name), _line(key)) for name, (key, value) in pairs.items()}

    def _merged_pairs(self, node: MappingNode, path: Path, depth: int) -> Iterator[tuple[Node, Node]]:
        """What the merge keys (`<<`) of a mapping bring, nearest first."""
        for source in _merge_sources(node):
            origin = self.origin_at(_line(source))
            self._count(origin, depth)
            if not isinstance(source, MappingNode):
                self.document.complain(path, "'<<' takes over the keys of a group, and this is none", origin)
                continue
            for key, value in _own_pairs(source):
                self._count(origin, depth)
                if isinstance(key, ScalarNode):
                    yield key, value
            yield from self._merged_pairs(source, path, depth + 1)


def _is_merge(key: Node) -> bool:
    return key.tag == "tag:yaml.org,2002:merge"


def _own_pairs(node: MappingNode) -> Iterator[tuple[Node, Node]]:
    return ((key, value) for key, value in node.value if not _is_merge(key))


def _merge_sources(node: MappingNode) -> Iterator[Node]:
    for key, value in node.value:
        if _is_merge(key):
            yield from value.value if isinstance(value, SequenceNode) else [value]


def _line(node: Node) -> int:
    return node.start_mark.line + 1


def _starts_with_its_value(node: Node) -> bool:
    """False for a group or list in block style and for nothing at all: there the line of the key says more."""
    if isinstance(node, ScalarNode):
        return node.style is not None or node.value != ""
    return isinstance(node, CollectionNode) and bool(node.flow_style)


_WORDS = {"": None, "~": None, "null": None, "Null": None, "NULL": None, "true": True, "True": True, "TRUE": True,
          "false": False, "False": False, "FALSE": False}  # fmt: skip
_INTEGER = re.compile(r"[-+]?[0-9]{1,300}")
_BASED = re.compile(r"0o[0-7]{1,300}|0x[0-9a-fA-F]{1,300}")
_FLOAT = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?")
_NOT_FINITE = re.compile(r"[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)")


def plain_value(text: str) -> Any:
    """What unquoted text means in YAML 1.2 (core schema).

    Source: YAML 1.2.2, section 10.3.2.

    >>> plain_value("2e-3"), plain_value("yes"), plain_value("010"), plain_value("0x10"), plain_value("1/60")
    (0.002, 'yes', 10, 16, '1/60')
    """
    if text in _WORDS:
        return _WORDS[text]
    if _INTEGER.fullmatch(text):
        return int(text)
    if _BASED.fullmatch(text):
        return int(text, 0)
    if _FLOAT.fullmatch(text):
        return float(text)
    if _NOT_FINITE.fullmatch(text):
        return float(text.replace(".", ""))
    return text


def _descend(tree: Any, path: Path) -> Any:
    for part in path:
        tree = tree[part]
    return tree
