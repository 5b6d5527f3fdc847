"""`--set KEY=VALUE`: values written over those of the file, before anything is checked."""

from typing import Any

from rbfem.case.document import Document, Origin, Path, parse
from rbfem.case.wording import did_you_mean, shown
from rbfem.errors import InputError

# Errors of the command line come after those of the file.
AFTER_THE_FILE = 10**9


def apply_override(document: Document, index: int, text: str) -> None:
    """Write the value of `KEY=VALUE` into the document; what is wrong with it goes to the document's problems.

    Groups that the file does not have are made on the way, so that the schema decides whether the key is known.
    """
    origin = Origin(AFTER_THE_FILE + index, f"--set {text}")
    key, equals, value = text.partition("=")
    if not equals or not all(part.strip() for part in key.split(".")):
        document.complain((), f"expected KEY=VALUE such as time.end=2, read {shown(text)}", origin)
        return
    try:
        parsed = parse(value, lambda line: origin)
        path = _open(document, [part.strip() for part in key.split(".")], origin)
    except InputError as error:
        document.problems.append((origin, (), str(error).removeprefix(f"{origin.text}: ")))
        return
    document.put(path, parsed.tree, origin)
    document.problems.extend((origin, path + inner, message) for _, inner, message in parsed.problems)


def _open(document: Document, parts: list[str], origin: Origin) -> Path:
    """The path that the dotted key stands for, with every group around its last part in place."""
    path: Path = ()
    holder: Any = document.tree
    for number, part in enumerate(parts):
        step = _step(holder, part, path, document)
        path = (*path, step)
        if number == len(parts) - 1:
            break
        inner = holder.get(step) if isinstance(holder, dict) else holder[step]
        if inner is None:
            inner = {}
            document.put(path, inner, origin)
        holder = inner
    return path


def _step(holder: Any, part: str, path: Path, document: Document) -> str | int:
    """The key or index that `part` means inside `holder`; raises InputError where there is none."""
    if isinstance(holder, dict):
        return part
    if not isinstance(holder, list):
        around = document.label(path)
        raise InputError(f"{around} is {shown(holder)}, which holds no '{part}'; set {around} as a whole")
    if path == ("bodies",):
        return _index_of_body(holder, part)
    if part.isdecimal() and len(part) < 10 and int(part) < len(holder):
        return int(part)
    raise InputError(f"{document.label(path)} has {len(holder)} items, counted from 0, and no item '{part}'")


def _index_of_body(bodies: list[Any], name: str) -> int:
    names = [body.get("name") if isinstance(body, dict) else None for body in bodies]
    if name not in names:
        raise InputError(f"no body '{name}'{did_you_mean(name, [str(known) for known in names if known])}")
    return names.index(name)
