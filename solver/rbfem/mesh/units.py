"""Lengths a mesh file may be drawn in. A mesh file carries no unit of its own, so the reader is told one."""

from rbfem.errors import InputError

METRES_PER_UNIT = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "nm": 1e-9, "km": 1e3, "in": 0.0254, "ft": 0.3048}


def metres_per(unit: str) -> float:
    """How many metres one `unit` is, exactly by definition (inch and foot: the international ones of 1959).

    raises : InputError for a name that is not in the table.

    >>> metres_per("in")
    0.0254
    """
    try:
        return METRES_PER_UNIT[unit]
    except KeyError:
        known = ", ".join(METRES_PER_UNIT)
        raise InputError(f"unit: read {unit!r}, expected the name of a length: one of {known}") from None
