"""How an error says what was read and what was probably meant."""

from collections.abc import Iterable
from difflib import get_close_matches
from itertools import islice

LONGEST = 60


def shown(value: object) -> str:
    """What was read, as the user would recognise it, cut to one short line.

    >>> shown(None), shown(True), shown("nut"), shown([0, 1])
    ('nothing', 'true', "'nut'", '[0, 1]')
    """
    if value is None:
        return "nothing"
    if isinstance(value, bool):
        return "true" if value else "false"
    text = _start_of(value)
    return text if len(text) <= LONGEST else text[: LONGEST - 1] + "…"


def located(place: str, key: str) -> str:
    """Where a mistake is and at which key; an override says its key itself.

    >>> located("case.yaml:7", "time.end"), located("--set time.end=-1", "time.end")
    ('case.yaml:7: time.end', '--set time.end=-1')
    """
    return place if not key or place.startswith(f"--set {key}=") else f"{place}: {key}"


def _start_of(value: object) -> str:
    """`repr`, without spelling out what would be cut off anyway."""
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_start_of(item) for item in value[:LONGEST]) + "]"
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key}: {_start_of(item)}" for key, item in islice(value.items(), LONGEST)) + "}"
    if isinstance(value, str):
        return repr(value[: LONGEST + 1])
    return str(value)


def did_you_mean(read: object, known: Iterable[str]) -> str:
    """`; did you mean 'poisson'?`, or what there is to choose from when nothing is near.

    >>> did_you_mean("poison", ["poisson", "young"])
    "; did you mean 'poisson'?"
    >>> did_you_mean("zzz", ["poisson", "young"])
    '; known here: poisson, young'
    """
    names = list(dict.fromkeys(known))
    nearest = get_close_matches(str(read)[:LONGEST], names, n=1, cutoff=0.65)
    if nearest:
        return f"; did you mean '{nearest[0]}'?"
    if not names:
        return "; there is none"
    more = ", …" if len(names) > 12 else ""
    return "; known here: " + ", ".join(names[:12]) + more
