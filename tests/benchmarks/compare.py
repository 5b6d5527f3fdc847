"""rbfem against its limits and its peers: one command, one table, ratios in one run.

    python tests/benchmarks/compare.py [NAME …] [-o FILE.md]

Both sides of a ratio are timed in this process, by turns, and the smallest time of each counts. One thread, unless the
row says otherwise. The peers come with `pip install rbfem[peers]`; a missing one is a row that says so.
"""

import os

if __name__ == "__main__":
    os.environ["OMP_NUM_THREADS"] = "1"  # before NumPy is imported: its linear algebra would take every core

import argparse
from collections.abc import Iterable
from pathlib import Path

from accuracy_benchmark import accuracy
from inertia_benchmark import inertia
from measuring import Effort, Row
from motion_benchmark import motion
from peers_benchmark import peers
from rotor_benchmark import rotor
from start_up_benchmark import start_up
from writing_benchmark import writing

BENCHMARKS = {
    "accuracy": accuracy,
    "inertia": inertia,
    "motion": motion,
    "peers": peers,
    "rotor": rotor,
    "start-up": start_up,
    "writing": writing,
}

HEAD = "| benchmark | rbfem | peer or reference | ratio | asked | verdict |\n|---|---|---|---|---|---|\n"


def main() -> None:
    parser = argparse.ArgumentParser(description="Time rbfem against its limits and its peers.")
    parser.add_argument("name", nargs="*", help=f"{', '.join(BENCHMARKS)}; all of them if none is given")
    parser.add_argument("-o", "--output", type=Path, help="also write the table to this file")
    arguments = parser.parse_args()
    unknown = [name for name in arguments.name if name not in BENCHMARKS]
    if unknown:
        parser.error(f"no benchmark '{unknown[0]}'; there are {', '.join(BENCHMARKS)}")
    text = table(measure(arguments.name or BENCHMARKS, Effort()))
    print(text, end="")
    if arguments.output:
        arguments.output.write_text(text, encoding="utf-8")


def measure(names: Iterable[str], effort: Effort) -> list[Row]:
    """The rows of these benchmarks, one benchmark after the other."""
    return [row for name in names for row in BENCHMARKS[name](effort)]


def table(rows: Iterable[Row]) -> str:
    """Rows as a table in Markdown."""
    return HEAD + "".join(f"| {' | '.join(cells(row))} |\n" for row in rows)


def cells(row: Row) -> tuple[str, ...]:
    asked = "" if row.asked is None else f"≤ {ratio_in_words(row.asked)}"
    ratio = "" if row.ratio is None else ratio_in_words(row.ratio)
    return (row.benchmark, row.rbfem, row.reference, ratio, asked, row.verdict)


def ratio_in_words(ratio: float) -> str:
    """
    >>> ratio_in_words(1.3), ratio_in_words(0.02), ratio_in_words(0.0)
    ('1.3', '1/50', '0')
    """
    return f"1/{1.0 / ratio:.3g}" if 0.0 < ratio < 0.1 else f"{ratio:.3g}"


if __name__ == "__main__":
    main()
