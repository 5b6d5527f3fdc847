"""The one place where a result is written: a file appears under its name only when it is whole."""

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from rbfem.errors import InputError, RunError


def temporary_path(path: Path) -> Path:
    """Where `path` is built up: hidden, in the same folder so that a rename is atomic, with the same suffix.

    >>> temporary_path(Path("frames/nut_000000.vtu")).name
    '.nut_000000.part.vtu'
    """
    return path.with_name(f".{path.stem}.part{path.suffix}")


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """Give a temporary path to write to; rename it to `path` once the block is done.

    Whatever ends the block early, `path` keeps its earlier content and the temporary file is removed.
    Raises RunError, with the file and the cause, for an OSError in the block (a full disk, a quota, a lost folder).
    """
    temporary = temporary_path(path)
    try:
        yield temporary
        os.replace(temporary, path)
    except OSError as error:
        raise RunError(
            f"{path}: could not be written: {reason(error)}; files written before are whole and stay readable"
        ) from error
    finally:
        with suppress(OSError):
            temporary.unlink(missing_ok=True)


def write_text(path: Path, text: str) -> None:
    """Write `text` as UTF-8 to `path`, whole or not at all. Raises RunError.

    >>> import tempfile
    >>> path = Path(tempfile.mkdtemp()) / "report.json"
    >>> write_text(path, "{}")
    >>> path.read_text()
    '{}'
    """
    with whole_file(path) as temporary:
        temporary.write_text(text, encoding="utf-8", newline="\n")


def require_writable(directory: Path) -> None:
    """Make `directory` if it is missing and prove that a file can be written and renamed in it. Raises InputError."""
    proof = directory / "rbfem_can_write_here"
    try:
        directory.mkdir(parents=True, exist_ok=True)
        write_text(proof, "The file by which rbfem tries out a folder; it can be removed.\n")
        proof.unlink()
    except (OSError, RunError) as error:
        cause = error if isinstance(error, OSError) else error.__cause__
        raise InputError(
            f"{directory}: results cannot be written to this folder: {reason(cause)}; choose another with -o"
        ) from error


class FolderLock:
    """Keeps a second run out of a folder while the first writes to it; the system lifts it when a process dies.

    Raises InputError if another process holds it.
    """

    def __init__(self, directory: Path):
        import fcntl

        self._path = directory / ".rbfem_lock"
        self._file = self._path.open("w")
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            self._file.close()
            raise InputError(
                f"{directory}: another run is writing to this folder; wait for it, or choose another with -o"
            ) from error

    def release(self) -> None:
        """Let others in; releasing twice does no harm."""
        if not self._file.closed:
            self._path.unlink(missing_ok=True)
            self._file.close()


def reason(error: BaseException | None) -> str:
    """The cause of an OSError in the system's own words, without its number and paths.

    >>> reason(OSError(28, "No space left on device"))
    'no space left on device'
    """
    words = getattr(error, "strerror", None) or str(error)
    return words[:1].lower() + words[1:]
