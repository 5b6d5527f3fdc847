"""A text file that grows line by line and is nevertheless whole whenever somebody reads it."""

from pathlib import Path
from time import perf_counter

from rbfem.results.whole_file import write_text

# A file is rewritten at the earliest when 100 times the duration of its last rewrite has passed: however long it
# grows, its rewrites take at most a hundredth of the run, and a short file is brought up to date at every line.
REST = 100.0


class GrowingFile:
    """`head`, the lines appended so far and `tail`, rewritten whole as often as that is cheap, and at `close`.

    The lines are kept in memory: n lines cost O(n) in all, since the time between two rewrites grows with the file.
    """

    def __init__(self, path: Path, head: str, tail: str = ""):
        self._path = path
        self._parts = [head]
        self._tail = tail
        self._is_behind = True
        self._due = 0.0

    def append(self, line: str) -> None:
        """Add a line, and rewrite the file if its last rewrite is long enough ago. Raises RunError."""
        self._parts.append(line)
        self._is_behind = True
        if perf_counter() >= self._due:
            self._rewrite()

    def close(self) -> None:
        """Bring the file up to date. Raises RunError."""
        if self._is_behind:
            self._rewrite()

    def _rewrite(self) -> None:
        start = perf_counter()
        write_text(self._path, "".join([*self._parts, self._tail]))
        end = perf_counter()
        self._is_behind = False
        self._due = end + REST * (end - start)
