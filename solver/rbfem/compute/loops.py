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

# A leaf is inlined by force: one with many arguments otherwise stays a call, two to three times slower.
LEAF = {"forceinline": True, "_nrt": False, "nogil": True, "error_model": "numpy", "fastmath": {"contract"}}
LOOP = {"_nrt": False, "nogil": True, "error_model": "numpy", "fastmath": {"contract"}}

_one_parallel_kernel_at_a_time = threading.Lock()  # numba's workqueue layer aborts the process on a second entry


def loop(function: Callable, backend: str) -> Callable:
    """`function` as the backend runs it; the arguments are the same for all three.

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
        return compiled(function)
    kernel = compiled(function, parallel=True)

    def guarded(*arguments):
        with _one_parallel_kernel_at_a_time:
            return kernel(*arguments)

    return guarded


@functools.cache
def compiled(function: Callable, parallel: bool = False) -> Callable:
    """`function` and all plain functions of rbfem that it calls, compiled by numba and kept on disk.

    The serial and the parallel kernel of one text get different names, because numba's cache tells them apart by name
    only (numba issue 6845).
    """
    import numba

    names = {"parallel_range": numba.prange if parallel else range}
    text = _with_globals(function, names | _compiled_leaves(function), "_parallel" if parallel else "")
    return _jit(text, parallel=parallel, **LOOP)


def clear_of_numba() -> bool:
    """Whether this process has been spared the import of numba so far."""
    import sys

    return "numba" not in sys.modules


def is_cached() -> bool:
    """Whether kernels of exactly this source were compiled before on this machine."""
    folder = _cache_folder()
    return folder is not None and any(folder.rglob("*.nbc"))


def _items(argument: Any) -> Any:
    if isinstance(argument, np.ndarray):
        return memoryview(argument)
    if isinstance(argument, tuple) and hasattr(argument, "_fields"):
        return type(argument)(*[_items(value) for value in argument])
    return argument


def _compiled_leaves(function: Callable) -> dict[str, Callable]:
    called = {name: function.__globals__.get(name) for name in function.__code__.co_names}
    return {name: _leaf(value) for name, value in called.items() if _is_ours(value)}


def _is_ours(value: Any) -> bool:
    return isinstance(value, types.FunctionType) and value.__module__.startswith("rbfem.")


@functools.cache
def _leaf(function: Callable) -> Callable:
    return _jit(_with_globals(function, _compiled_leaves(function), ""), **LEAF)


def _with_globals(function: Callable, names: dict[str, Any], suffix: str) -> types.FunctionType:
    name = function.__name__ + suffix
    code = function.__code__.replace(co_name=name, co_qualname=name)
    text = types.FunctionType(code, {**function.__globals__, **names}, name, function.__defaults__)
    text.__module__, text.__qualname__, text.__doc__ = function.__module__, name, function.__doc__
    return text


def _jit(function: Callable, **options: Any) -> Callable:
    import numba

    folder = _cache_folder()
    if folder is None:
        return numba.njit(**options)(function)
    before, numba.config.CACHE_DIR = numba.config.CACHE_DIR, str(folder)
    try:
        return numba.njit(cache=True, **options)(function)
    finally:
        numba.config.CACHE_DIR = before


@functools.cache
def _cache_folder() -> Path | None:
    """A writable folder named after the source of every kernel, or None.

    numba does not notice a change in a function that a cached kernel calls from another file; a folder per source does.
    """
    user = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    for parent in (user, Path(tempfile.gettempdir()) / f"rbfem-{os.getuid() if hasattr(os, 'getuid') else 'user'}"):
        folder = parent / "rbfem" / _source_hash()
        try:
            folder.mkdir(parents=True, exist_ok=True)
            with tempfile.TemporaryFile(dir=folder):
                return folder
        except OSError:
            continue
    return None


@functools.cache
def _source_hash() -> str:
    digest = hashlib.sha256(os.environ.get("NUMBA_BOUNDSCHECK", "").encode())
    for file in sorted(Path(__file__).parents[1].rglob("*.py")):
        digest.update(file.read_bytes())
    return digest.hexdigest()[:16]
