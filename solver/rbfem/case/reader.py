"""A case file in, a Case out, or every mistake of the file at once."""

import os
import types
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Annotated, Any, Union, get_args, get_origin

from pydantic import BaseModel, Tag, ValidationError
from pydantic_core import ErrorDetails

from rbfem.case import document as yaml
from rbfem.case.overrides import apply_override
from rbfem.case.rules import findings
from rbfem.case.schema import Case, Source
from rbfem.case.wording import did_you_mean, located, shown
from rbfem.errors import InputError

CASE_FILE = "case.yaml"
# Reading a megabyte of YAML takes ten seconds; what is larger is a mesh given by mistake.
LARGEST_FILE = 1_000_000


def read_case(path: str | os.PathLike[str], overrides: Sequence[str] = ()) -> Case:
    """The case in a file, or in the case.yaml of a folder, checked and in SI.

    path      : case.yaml, any other YAML file, or a folder that holds a case.yaml
    overrides : `KEY=VALUE` strings; the key is dotted, items of `bodies` go by their name, the value is YAML

    Raises InputError that holds every mistake of the file, one a line, sorted by line, each with its place, what was
    read and what was expected. Not checked: whatever needs the mesh files, such as the names of their groups.
    """
    file = _case_file(os.fspath(path))
    document = yaml.parse(_text(file), lambda line: yaml.Origin(line, f"{file}:{line}"))
    if not isinstance(document.tree, dict):
        read = "an empty file" if document.tree is None else shown(document.tree)
        raise InputError(f"{document.origin(()).text}: expected keys, the first of them `rbfem: 1`, read {read}")
    for index, override in enumerate(overrides):
        apply_override(document, index, override)
    return _checked(document, file)


def _case_file(path: str) -> str:
    file = os.path.join(path, CASE_FILE) if os.path.isdir(path) else path
    if os.path.isfile(file):
        return file
    if file != path:
        raise InputError(f"{path}: the folder holds no {CASE_FILE}")
    what = "not a file" if os.path.exists(path) else "no such file"
    raise InputError(f"{path}: {what}; expected a {CASE_FILE} or a folder that holds one")


def _text(file: str) -> str:
    try:
        with open(file, "rb") as stream:
            data = stream.read(LARGEST_FILE + 1)
    except OSError as error:
        raise InputError(f"{file}: cannot be read: {error.strerror}") from None
    if len(data) > LARGEST_FILE:
        raise InputError(f"{file}: larger than {LARGEST_FILE / 1e6:g} MB; a case is a short text, is this a mesh?")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise InputError(f"{file}:{line}: not UTF-8 text; a case file is text, save it as UTF-8") from None


def _checked(document: yaml.Document, file: str) -> Case:
    folder = Path(file).parent
    name = folder.resolve().name if Path(file).name == CASE_FILE else Path(file).stem
    case = None
    try:
        source = Source(folder=folder, name=name, file=file, places=document.places())
        case = Case.model_validate(document.tree, context=source)
    except ValidationError as error:
        for details in error.errors(include_url=False):
            document.complain(*_in_our_words(details, document.tree))
    for path, message in findings(document.tree):
        document.complain(path, message)
    if case is None or document.problems:
        raise InputError("\n".join(_lines(document)))
    return case


def _lines(document: yaml.Document) -> Iterable[str]:
    """The problems in the order of the file, each once."""
    for origin, path, message in dict.fromkeys(sorted(document.problems, key=lambda problem: problem[0])):
        yield f"{located(origin.text, document.label(path))}: {message}"


# ------------------------------------------------------------------------------- what pydantic found, in our words

EXPECTED = {
    "model_type": "a group of keys (key: value)",
    "model_attributes_type": "a group of keys (key: value)",
    "dict_type": "a group of names (name: …)",
    "tuple_type": "a list",
    "string_type": "text (numbers go in quotes)",
    "int_type": "a whole number",
    "bool_type": "true or false",
    "greater_than_equal": "a whole number from {ge}",
    "less_than_equal": "a whole number up to {le}",
    "too_long": "a list of {max_length}",
    "no_kind": "one of {kinds}",
    "literal_error": "{expected}",
}


def _in_our_words(details: ErrorDetails, tree: dict[str, Any]) -> tuple[yaml.Path, str]:
    """The path in the tree and the message for one error of pydantic."""
    kind, read, context = details["type"], details["input"], details.get("ctx", {})
    path = _path_in(tree, details["loc"])
    if kind == "missing":
        return path[:-1], _missing(details["loc"])
    if kind == "extra_forbidden":
        return path, _unknown_key(details["loc"])
    if kind == "value_error":
        return path, str(context["error"])
    if kind not in EXPECTED:
        return path, f"{details['msg']}, read {shown(read)}"
    expected = EXPECTED[kind].format(**context)
    return path, f"expected {expected}, read {shown(read)}{_nearest_choice(kind, read, context)}"


def _nearest_choice(kind: str, read: Any, context: dict[str, Any]) -> str:
    """A hint where a word was mistyped: the kind of a shape or load, or one of a few literals."""
    if kind == "no_kind" and isinstance(read, dict):
        hints = [did_you_mean(key, context["kinds"].split(", ")) for key in read]
    elif kind == "literal_error" and isinstance(read, str):
        hints = [did_you_mean(read, context["expected"].replace(" or ", ", ").replace("'", "").split(", "))]
    else:
        hints = []
    return next((hint for hint in hints if hint.startswith("; did")), "")


def _missing(location: tuple[str | int, ...]) -> str:
    section, key = _section_at(location[:-1]), location[-1]
    if section is None:
        return f"expected a list of {int(key) + 1} items, read a shorter one"
    description = section.model_fields[str(key)].description
    return f"missing key '{key}' ({str(description).rstrip('.')})"


def _unknown_key(location: tuple[str | int, ...]) -> str:
    section, key = _section_at(location[:-1]), location[-1]
    known = section.model_fields if section else ()
    beside = getattr(section, "kind", None)
    return f"unknown key '{key}'{f' beside {beside!r}' if beside else ''}{did_you_mean(key, known)}"


def _path_in(tree: Any, location: Sequence[str | int]) -> yaml.Path:
    """The location without what pydantic adds to it: the tags of the kinds and the mark of a key."""
    path: list[str | int] = []
    for part in location:
        if _holds(tree, part):
            tree = tree[part]
            path.append(part)
    last = location[-1] if location else ""
    is_absent_key = last not in path[-1:] and not _is_added(last)
    return (*path, last) if is_absent_key else tuple(path)


def _holds(tree: Any, part: str | int) -> bool:
    return part in tree if isinstance(tree, dict) else isinstance(tree, list) and part in range(len(tree))


def _is_added(part: str | int) -> bool:
    return part in ("", "[key]") or (isinstance(part, str) and part.startswith("<") and part.endswith(">"))


def _section_at(location: Iterable[str | int]) -> type[BaseModel] | None:
    """The section of the schema at a location of pydantic."""
    annotation: Any = Case
    for part in location:
        annotation = _inside(annotation, part)
    annotation = _bare(annotation)
    return annotation if isinstance(annotation, type) and issubclass(annotation, BaseModel) else None


def _bare(annotation: Any) -> Any:
    """Without its metadata and without `| None`."""
    if get_origin(annotation) is Annotated:
        return _bare(get_args(annotation)[0])
    if get_origin(annotation) in (Union, types.UnionType):
        members = [member for member in get_args(annotation) if member is not type(None)]
        return _bare(members[0]) if len(members) == 1 else annotation
    return annotation


def _inside(annotation: Any, part: str | int) -> Any:
    annotation = _bare(annotation)
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation.model_fields[str(part)].annotation if part in annotation.model_fields else None
    if get_origin(annotation) is dict:
        return get_args(annotation)[1]
    if get_origin(annotation) is tuple:
        return get_args(annotation)[0]
    return next(
        (member for member in get_args(annotation) if Tag(str(part)) in getattr(member, "__metadata__", ())), None
    )
