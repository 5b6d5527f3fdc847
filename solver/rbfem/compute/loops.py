"""How a plain function over whole arrays becomes a loop: pure Python, a serial kernel or a parallel one.

A loop is an ordinary Python function that indexes whole arrays with numbers and calls plain scalar functions. The same
text runs interpreted (the arrays handed over as memoryviews, whose items are Python floats) or compiled by numba (the
functions it calls are found through its globals and compiled with it). A loop over independent items is written with
`parallel_range`; only the parallel kernel spreads it over threads.
"""

import functools
import hashlib
import os
import tempfile
import threading
import types
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

BACKENDS = ("python", "serial", "parallel")

parallel_range = range

# Loops allocate nothing, so numba need not count references to the arrays: that counting took more than the physics.
LOOP: dict[str, Any] = {"_nrt": False, "nogil": True, "error_model": "numpy"}
# A leaf is inlined by force: one with many arguments otherwise stays a call, two to three times slower.
LEAF: dict[str, Any] = {**LOOP, "forceinline": True, "fastmath": {"contract"}}

_one_parallel_kernel_at_a_time = threading.Lock()  # numba's workqueue layer aborts the process on a second entry


def loop(function: Callable, backend: str, reorders_sums: bool = False) -> Callable:
    """`function` as the backend runs it; the arguments are the same for all three.

    reorders_sums : the sums of the loop itself, not those of the functions it calls, may be added up in another order,
                    several at a time

    >>> def add_up(values, total):
    ...     for i in range(len(values)):
    ...         total[0] += values[i]
    >>> total = np.zeros(1)
    >>> loop(add_up, "python")(np.arange(4.0), total)
    >>> total
    array([6.])
    """
    if backend == "python":
        return lambda *arguments: function(*[_items(argument) for argument in arguments])
    if backend == "serial":
        return compiled(function, reorders_sums=reorders_sums)
    kernel = compiled(function, parallel=True, reorders_sums=reorders_sums)

    def guarded(*arguments):
        with _one_parallel_kernel_at_a_time:
            return kernel(*arguments)

    return guarded


@functools.cache
def compiled(function: Callable, parallel: bool = False, reorders_sums: bool = False) -> Callable:
    """`function` and all plain functions of rbfem that it calls, compiled by numba and kept on disk.

    The serial and the parallel kernel of one text get different names, because numba's cache tells them apart by name
    only (numba issue 6845).
    """
    import numba

    names = {"parallel_range": numba.prange if parallel else range}
    text = _with_globals(function, names | _compiled_leaves(function), "_parallel" if parallel else "")
    fastmath = {"contract", "reassoc", "nsz"} if reorders_sums else {"contract"}
    return _kept(text, _cache_folder(function), parallel=parallel, fastmath=fastmath, **LOOP)


def clear_of_numba() -> bool:
    """Whether this process has been spared the import of numba so far."""
    import sys

    return "numba" not in sys.modules


def is_cached(function: Callable, backend: str) -> bool:
    """Whether this loop was compiled before on this machine, from exactly this source."""
    folder = _cache_folder(function)
    name = function.__name__ + ("_parallel" if backend == "parallel" else "")
    return folder is not None and any(folder.rglob(f"*.{name}-*.nbc"))


def _items(argument: Any) -> Any:
    if isinstance(argument, np.ndarray):
        return argument.data
    if isinstance(argument, tuple) and hasattr(argument, "_fields"):
        return type(argument)(*[_items(value) for value in argument])
    return argument


def _compiled_leaves(function: Callable) -> dict[str, Callable]:
    return {name: _leaf(called) for name, called in _called(function).items()}


def _called(function: Callable) -> dict[str, types.FunctionType]:
    """The plain functions of rbfem that a function calls, by the name it calls them."""
    found = {name: function.__globals__.get(name) for name in function.__code__.co_names}
    return {
        name: value
        for name, value in found.items()
        if isinstance(value, types.FunctionType) and value.__module__.startswith("rbfem.")
    }


@functools.cache
def _leaf(function: Callable) -> Callable:
    import numba

    return numba.njit(**LEAF)(_with_globals(function, _compiled_leaves(function), ""))


def _with_globals(function: Callable, names: dict[str, Any], suffix: str) -> types.FunctionType:
    name = function.__name__ + suffix
    code = function.__code__.replace(co_name=name, co_qualname=name)
    text = types.FunctionType(code, {**function.__globals__, **names}, name, function.__defaults__)
    text.__module__, text.__qualname__, text.__doc__ = function.__module__, name, function.__doc__
    return text


def _kept(function: Callable, folder: Path | None, **options: Any) -> Callable:
    """A loop for numba to compile and, where there is a folder, to keep there."""
    import numba

    if folder is None:
        return numba.njit(**options)(function)
    settings: Any = numba.config
    before, settings.CACHE_DIR = settings.CACHE_DIR, str(folder)
    try:
        return numba.njit(cache=True, **options)(function)
    finally:
        settings.CACHE_DIR = before


@functools.cache
def _cache_folder(function: Callable) -> Path | None:
    """A writable folder named after the source of a loop and of all that it calls, or None.

    numba does not notice a change in a function that a cached kernel calls from another file; a folder per source does.
    """
    for parent in (_user_cache, _temporary_cache):
        try:
            folder = parent() / "rbfem" / _source_hash(function)
            folder.mkdir(parents=True, exist_ok=True)
            with tempfile.TemporaryFile(dir=folder):
                return folder
        except (OSError, RuntimeError):  # RuntimeError: a user without a home
            continue
    return None


def _user_cache() -> Path:
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")


def _temporary_cache() -> Path:
    return Path(tempfile.gettempdir()) / f"rbfem-{os.getuid() if hasattr(os, 'getuid') else 'user'}"


def _source_hash(function: Callable) -> str:
    """Of every file in the rooms that the loop's text comes from: the constants it reads count as well as functions."""
    digest = hashlib.sha256(os.environ.get("NUMBA_BOUNDSCHECK", "").encode())
    for room in sorted({Path(file).parent for file in _source_files(function)} | {Path(__file__).parent}):
        for file in sorted(room.glob("*.py")):
            digest.update(file.read_bytes())
    return digest.hexdigest()[:16]


def _source_files(function: Callable) -> set[str]:
    """The files of a function and of all that it calls."""
    return {function.__code__.co_filename}.union(*(_source_files(called) for called in _called(function).values()))
