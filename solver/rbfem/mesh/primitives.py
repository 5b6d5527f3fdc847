"""Shapes given in words, such as `sphere:radius=0.05` or `box:size=0.1,0.1,0.2`."""

import math
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
    """A shape centred at the origin; a cylinder stands along z. values : parameter -> its numbers"""

    kind: str
    values: dict[str, tuple[float, ...]]

    @property
    def largest(self) -> float:
        return max(max(numbers) for numbers in self.values.values())

    @property
    def volume(self) -> float:
        """In closed form."""
        if self.kind == "box":
            return math.prod(self.values["size"])
        if self.kind == "cylinder":
            return math.pi * self.values["radius"][0] ** 2 * self.values["height"][0]
        radii = self.values["radii"] if self.kind == "ellipsoid" else self.values["radius"] * 3
        return 4.0 / 3.0 * math.pi * math.prod(radii)


def is_primitive(source: str) -> bool:
    return source.partition(":")[0] in PRIMITIVES


def parse_primitive(text: str) -> Primitive:
    """
    >>> parse_primitive("cylinder:radius=0.1,height=2")
    Primitive(kind='cylinder', values={'radius': (0.1,), 'height': (2.0,)})

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
    return Primitive(kind, numbers)


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
