"""Shapes given in words, such as `sphere:radius=0.05` or `box:size=0.1,0.1,0.2`."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from rbfem.errors import InputError

# Name -> its parameters and how many numbers each takes.
PRIMITIVES = {
    "sphere": {"radius": 1},
    "box": {"size": 3},
    "cylinder": {"radius": 1, "height": 1},
    "ellipsoid": {"radii": 3},
}


@dataclass(frozen=True)
class Primitive:
    """A shape centred at the origin; a cylinder stands along z.

    kind   : one of `PRIMITIVES`
    extent : half widths of a box, radii of a sphere or ellipsoid, or radius, radius and half height of a cylinder
    """

    kind: str
    extent: tuple[float, float, float]

    @property
    def volume(self) -> float:
        """In closed form."""
        return {"box": 8.0, "cylinder": 2.0 * math.pi}.get(self.kind, 4.0 / 3.0 * math.pi) * math.prod(self.extent)

    @property
    def bounding_radius(self) -> float:
        """Largest distance of a point from the centre."""
        a, b, c = self.extent
        if self.kind == "box":
            return math.hypot(a, b, c)
        return math.hypot(a, c) if self.kind == "cylinder" else max(a, b, c)

    def scaled(self, factor: float) -> "Primitive":
        """The same shape, every length times a factor."""
        a, b, c = self.extent
        return Primitive(self.kind, (factor * a, factor * b, factor * c))


def from_sizes(kind: str, sizes: Mapping[str, Sequence[float]]) -> Primitive:
    """A primitive from its parameters by name, see `PRIMITIVES`.

    >>> from_sizes("cylinder", {"radius": (0.1,), "height": (2.0,)})
    Primitive(kind='cylinder', extent=(0.1, 0.1, 1.0))
    """
    if kind == "box":
        x, y, z = sizes["size"]
        return Primitive(kind, (0.5 * x, 0.5 * y, 0.5 * z))
    if kind == "ellipsoid":
        a, b, c = sizes["radii"]
        return Primitive(kind, (a, b, c))
    (radius,) = sizes["radius"]
    return Primitive(kind, (radius, radius, 0.5 * sizes["height"][0] if kind == "cylinder" else radius))


def is_primitive(source: str) -> bool:
    return source.partition(":")[0] in PRIMITIVES


def parse_primitive(text: str) -> Primitive:
    """
    >>> parse_primitive("cylinder:radius=0.1,height=2")
    Primitive(kind='cylinder', extent=(0.1, 0.1, 1.0))

    raises : InputError for a parameter that is unknown, missing, or not positive.
    """
    kind, _, rest = text.partition(":")
    expected = PRIMITIVES[kind]
    values: dict[str, list[str]] = {}
    for word in rest.split(","):
        name, equals, number = word.rpartition("=")
        if equals and (name.strip() in values or name.strip() not in expected):
            raise InputError(f"{text}: unexpected {name.strip()!r}; expected {usage(kind)}")
        if equals:
            values[name.strip()] = []
        if not values:
            raise InputError(f"{text}: expected {usage(kind)}")
        list(values.values())[-1].append(number)
    numbers = {name: tuple(length(text, word) for word in words) for name, words in values.items()}
    if {name: len(words) for name, words in numbers.items()} != expected:
        raise InputError(f"{text}: expected {usage(kind)}")
    return from_sizes(kind, numbers)


def length(text: str, word: str) -> float:
    try:
        value = float(word)
    except ValueError:
        raise InputError(f"{text}: read {word!r} where a number was expected") from None
    if not (value > 0.0 and math.isfinite(value)):
        raise InputError(f"{text}: read {word!r}, expected a length above zero")
    return value


def usage(kind: str) -> str:
    """'box' -> 'box:size=1,1,1'"""
    return f"{kind}:" + ",".join(f"{name}={','.join('1' * count)}" for name, count in PRIMITIVES[kind].items())
