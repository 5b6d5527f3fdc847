"""Numbers with units: the one place where what a person wrote becomes SI."""

import re
from dataclasses import dataclass
from decimal import Decimal
from functools import cache
from math import inf, isfinite
from typing import Any

from rbfem.case.wording import did_you_mean, shown


@dataclass(frozen=True)
class Dimension:
    """What a number measures, in words, and its SI unit ("" for a plain number)."""

    meaning: str
    unit: str

    def __str__(self) -> str:
        return self.described()

    def described(self, adjective: str = "") -> str:
        """In a sentence: `an angular velocity in rad/s`, `a positive length in m`."""
        noun = f"{adjective} {self.meaning}".strip()
        article = "an" if noun[0] in "aeiou" else "a"
        return f"{article} {noun} in {self.unit}" if self.unit else f"{article} {noun}"


NUMBER = Dimension("number", "")
LENGTH = Dimension("length", "m")
TIME = Dimension("time", "s")
MASS = Dimension("mass", "kg")
VELOCITY = Dimension("velocity", "m/s")
ANGULAR_VELOCITY = Dimension("angular velocity", "rad/s")
ACCELERATION = Dimension("acceleration", "m/s^2")
DENSITY = Dimension("density", "kg/m^3")
MOMENT_OF_INERTIA = Dimension("moment of inertia", "kg m^2")
MOMENTUM = Dimension("momentum", "kg m/s")
ANGULAR_MOMENTUM = Dimension("angular momentum", "kg m^2/s")
FORCE = Dimension("force", "N")
TORQUE = Dimension("torque", "N m")
ENERGY = Dimension("energy", "J")
PRESSURE = Dimension("pressure", "Pa")
STIFFNESS = Dimension("stiffness", "N/m")
DAMPING = Dimension("damping", "N s/m")
ANGULAR_DAMPING = Dimension("angular damping", "N m s")
DIMENSIONS = (LENGTH, TIME, MASS, VELOCITY, ANGULAR_VELOCITY, ACCELERATION, DENSITY, MOMENT_OF_INERTIA, MOMENTUM,
              ANGULAR_MOMENTUM, FORCE, TORQUE, PRESSURE, STIFFNESS, DAMPING, ANGULAR_DAMPING)  # fmt: skip

# An angle is a dimension of its own here, so that a frequency in Hz is not taken for an angular velocity in rad/s.
DEFINITIONS = """
micro- = 1e-6 = u- = µ- = μ-
milli- = 1e-3 = m-
centi- = 1e-2 = c-
kilo- = 1e3 = k-
mega- = 1e6 = M-
giga- = 1e9 = G-
meter = [length] = m = metre
second = [time] = s
gram = [mass] = g
radian = [angle] = rad
minute = 60 * second = min
hour = 3600 * second = h
inch = 0.0254 * meter = in
foot = 0.3048 * meter = ft
tonne = 1000 * kilogram = t
pound = 0.45359237 * kilogram = lb
degree = 0.0174532925199432957692369 * radian = deg = °
revolution = 360 * degree = rev
rpm = revolution / minute
hertz = 1 / second = Hz
newton = kilogram * meter / second ** 2 = N
pascal = newton / meter ** 2 = Pa
bar = 1e5 * pascal
joule = newton * meter = J
standard_gravity = 9.80665 * meter / second ** 2 = g0
pound_force = pound * standard_gravity = lbf
psi = pound_force / inch ** 2
"""
COMMON_UNITS = ("m", "mm", "cm", "km", "um", "in", "ft", "s", "ms", "min", "h", "kg", "g", "t", "lb", "rad", "deg",
                "rev", "rpm", "N", "kN", "mN", "lbf", "Pa", "kPa", "MPa", "GPa", "bar", "psi", "J", "g0")  # fmt: skip

_PLAIN = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_NUMBER = re.compile(rf"\s*({_PLAIN})(?:\s*/\s*({_PLAIN}))?\s*(\D.*)?", re.ASCII | re.DOTALL)
# Names, small powers, * and / only: an expression such as 9**9**9 never reaches the unit parser.
_UNIT = re.compile(r"(?:[A-Za-zµμ°][A-Za-zµμ°_0]*+(?:\^-?[1-9])?+|[*/()\s])++")
_BARE_POWER = re.compile(r"([A-Za-zµμ°])(-?[1-9])(?![0-9])")
_LONGEST = 80


def to_si(value: object, dimension: Dimension = NUMBER, expected: str = "") -> float:
    """The value in SI: a number as it is, a string with its unit converted, a fraction divided.

    expected : what to say that was expected, if it is more than the dimension

    Raises ValueError with what was expected and what was read, for anything else and for NaN and infinity.

    >>> to_si("7.85 g/cm^3", DENSITY), to_si("1/60", TIME), to_si(2e-3, LENGTH)
    (7850.0, 0.016666666666666666, 0.002)
    """
    try:
        number = _number(value, dimension)
    except ValueError as error:
        raise ValueError(f"expected {expected or dimension}, read {shown(value)}{error}") from None
    if not isfinite(number):
        raise ValueError(f"expected {expected or dimension}, read {shown(value)}, which is not finite")
    return number


def _number(value: object, dimension: Dimension) -> float:
    """The float meant by `value`; raises ValueError with the end of the sentence that says why there is none."""
    if isinstance(value, str):
        return _number_in_text(value, dimension)
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise ValueError("")
    try:
        return float(value)
    except OverflowError:
        return inf


def _number_in_text(text: str, dimension: Dimension) -> float:
    match = _NUMBER.fullmatch(text) if len(text) <= _LONGEST else None
    if match is None:
        raise ValueError("")
    numerator, denominator, unit = match.groups()
    factor = unit_factor(unit.strip(), dimension) if unit and unit.strip() else Decimal(1)
    try:
        return float(Decimal(numerator) / Decimal(denominator or 1) * factor)
    except ArithmeticError:
        return inf


@cache
def unit_factor(unit: str, dimension: Dimension) -> Decimal:
    """How many SI units one `unit` is, exactly.

    Raises ValueError saying what is wrong with the unit, as the end of a sentence.

    >>> unit_factor("mm", LENGTH)
    Decimal('0.001')
    """
    if not dimension.unit:
        raise ValueError(", which has a unit")
    factor, base = _in_base_units(unit)
    if base != _in_base_units(dimension.unit)[1]:
        raise ValueError(f", which is {_meaning(base)}")
    return factor / _in_base_units(dimension.unit)[0]


@cache
def _in_base_units(unit: str) -> tuple[Decimal, Any]:
    import pint

    text = unit.replace("²", "^2").replace("³", "^3").replace("·", "*").replace("**", "^")
    if not _UNIT.fullmatch(text):
        raise ValueError(f": {shown(unit)} is not a unit{_with_powers(text)}")
    try:
        factor, base = _registry().get_base_units(_registry().parse_units(text))
    except pint.UndefinedUnitError as error:
        name = error.unit_names if isinstance(error.unit_names, str) else error.unit_names[0]
        raise ValueError(f": unknown unit '{name}'{did_you_mean(name, COMMON_UNITS)}") from None
    except Exception:  # pint answers a malformed expression with whatever its parser trips over
        raise ValueError(f": {shown(unit)} is not a unit") from None
    return Decimal(factor), base


def _with_powers(unit: str) -> str:
    """A hint where the ^ of a power was left out."""
    meant = _BARE_POWER.sub(r"\1^\2", unit)
    return f"; did you mean '{meant}'?" if meant != unit and _UNIT.fullmatch(meant) else ""


@cache
def _registry() -> Any:
    """A registry that knows mechanical units only: read in milliseconds, and 'k' is no Boltzmann constant."""
    import pint

    registry: Any = pint.UnitRegistry(None, non_int_type=Decimal)
    registry.load_definitions(DEFINITIONS.strip().splitlines())
    return registry


def _meaning(base: Any) -> str:
    for dimension in DIMENSIONS:
        if _in_base_units(dimension.unit)[1] == base:
            return str(dimension)
    return f"in {base:~}".replace(" ** ", "^")
