"""Running a reader we did not write on a file we did not write, without believing either."""

import contextlib
import io
import signal
import threading
from collections.abc import Callable, Iterator
from typing import Any

GIB = 2**30


class OutOfTimeError(BaseException):
    """Not an Exception, so that no `except Exception` of the contained code can swallow it."""


def contained(read: Callable[[], Any], file_bytes: int) -> tuple[Any, str, str]:
    """Result of `read()`, why it failed ('' if it did not), and what it printed.

    Whatever `read` does (raise anything, call `sys.exit`, print, loop, ask for memory without end) comes back as words.
    A damaged file can hold a count of 1e15 cells, so on POSIX time and memory are limited in proportion to the file;
    the time limit needs the main thread, since Python delivers signals nowhere else.
    KeyboardInterrupt passes through.
    """
    printed = io.StringIO()
    result, failure = None, ""
    with contextlib.redirect_stdout(printed), contextlib.redirect_stderr(printed):
        try:
            with memory_limit(GIB + 200 * file_bytes), time_limit(10.0 + 5e-6 * file_bytes):
                result = read()
        except KeyboardInterrupt:
            raise
        except BaseException as error:
            failure = describe(error)
    return result, failure, printed.getvalue()


def describe(error: BaseException) -> str:
    """What an exception of a foreign reader says, in one line that is never empty."""
    if isinstance(error, SystemExit):
        return "the reader gave up"
    words = " ".join(str(error).split())
    return f"{type(error).__name__}: {words[:200]}" if words else type(error).__name__


@contextlib.contextmanager
def time_limit(seconds: float) -> Iterator[None]:
    if threading.current_thread() is not threading.main_thread() or not hasattr(signal, "setitimer"):
        yield
        return

    def out_of_time(signum, frame):
        raise OutOfTimeError(f"reading took more than {seconds:.0f} s")

    handler = signal.signal(signal.SIGALRM, out_of_time)
    remaining, interval = signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, remaining, interval)
        signal.signal(signal.SIGALRM, handler)


@contextlib.contextmanager
def memory_limit(extra_bytes: int) -> Iterator[None]:
    """Let this process grow by `extra_bytes` at most; beyond that an allocation raises MemoryError."""
    try:
        import resource

        pages = int(open("/proc/self/statm").read().split()[0])  # noqa: SIM115 - one line of a kernel file
    except (ImportError, OSError):
        yield
        return
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    limit = pages * resource.getpagesize() + extra_bytes
    if any(bound != resource.RLIM_INFINITY and bound < limit for bound in (soft, hard)):
        yield
        return
    resource.setrlimit(resource.RLIMIT_AS, (limit, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, (soft, hard))
