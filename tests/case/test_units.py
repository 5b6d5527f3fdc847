import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rbfem.case import units
from rbfem.case.units import (
    ACCELERATION,
    ANGULAR_VELOCITY,
    COMMON_UNITS,
    DENSITY,
    LENGTH,
    NUMBER,
    PRESSURE,
    STIFFNESS,
    TIME,
    TORQUE,
    to_si,
)


@pytest.mark.parametrize(
    ("text", "dimension", "value"),
    [
        ("7.85 g/cm^3", DENSITY, 7850.0),
        ("7.85 g/cm³", DENSITY, 7850.0),
        ("7.85 g/cm**3", DENSITY, 7850.0),
        ("5 mm", LENGTH, 0.005),
        ("5mm", LENGTH, 0.005),
        ("-1.5e-3 km", LENGTH, -1.5),
        ("1/2 in", LENGTH, 0.0127),
        ("3 µm", LENGTH, 3e-6),
        ("2 MPa", PRESSURE, 2e6),
        ("1e5 N/m", STIFFNESS, 1e5),
        ("1 g0", ACCELERATION, 9.80665),
        ("3 kN mm", TORQUE, 3.0),
        ("3 kN*mm", TORQUE, 3.0),
        ("3 kN·mm", TORQUE, 3.0),
        ("2 kg m^2/s^2", TORQUE, 2.0),
        ("90 deg/s", ANGULAR_VELOCITY, math.pi / 2),
        ("60 rpm", ANGULAR_VELOCITY, 2 * math.pi),
        ("1/60", TIME, 1 / 60),
        (" 1 / 60 ", TIME, 1 / 60),
        ("2 min", TIME, 120.0),
        ("0.25", NUMBER, 0.25),
        (3, LENGTH, 3.0),
        (2e-3, LENGTH, 2e-3),
    ],
)
def test_what_a_person_writes_becomes_si(text, dimension, value):
    # conversions are made in decimal and rounded once: equal to the last digit or the one before it
    assert to_si(text, dimension) == pytest.approx(value, rel=3e-16, abs=0)


@pytest.mark.parametrize(
    ("value", "message"),
    [
        ("7.85 g/cm^3", "expected a length in m, read '7.85 g/cm^3', which is a density in kg/m^3"),
        ("5 mmm", "expected a length in m, read '5 mmm': unknown unit 'mmm'; did you mean 'mm'?"),
        ("5 kg^2", "expected a length in m, read '5 kg^2', which is in g^2"),
        ("5 m+m", "expected a length in m, read '5 m+m': 'm+m' is not a unit"),
        ("5 m2", "expected a length in m, read '5 m2': 'm2' is not a unit; did you mean 'm^2'?"),
        ("8.5 g/cm3", "expected a length in m, read '8.5 g/cm3': 'g/cm3' is not a unit; did you mean 'g/cm^3'?"),
        ("5 m^", "expected a length in m, read '5 m^': 'm^' is not a unit"),
        ("five", "expected a length in m, read 'five'"),
        ("", "expected a length in m, read ''"),
        (True, "expected a length in m, read true"),
        (None, "expected a length in m, read nothing"),
        ([1], "expected a length in m, read [1]"),
        ({"a": 1}, "expected a length in m, read {a: 1}"),
        (math.nan, "expected a length in m, read nan, which is not finite"),
        (-math.inf, "expected a length in m, read -inf, which is not finite"),
        ("nan", "expected a length in m, read 'nan'"),
        ("inf mm", "expected a length in m, read 'inf mm'"),
        ("1/0", "expected a length in m, read '1/0', which is not finite"),
        ("0/0", "expected a length in m, read '0/0', which is not finite"),
        ("1e400", "expected a length in m, read '1e400', which is not finite"),
        ("1e308 km", "expected a length in m, read '1e308 km', which is not finite"),
    ],
)
def test_what_is_no_length_is_refused_with_both_sides(value, message):
    with pytest.raises(ValueError) as caught:  # noqa: PT011 (the whole message is compared)
        to_si(value, LENGTH)
    assert str(caught.value) == message


def test_an_integer_beyond_floats_is_refused():
    with pytest.raises(ValueError, match="not finite"):
        to_si(10**400, LENGTH)


def test_a_frequency_is_no_angular_velocity():
    with pytest.raises(ValueError, match="expected an angular velocity in rad/s, read '5 Hz', which is in 1 / s"):
        to_si("5 Hz", ANGULAR_VELOCITY)


def test_a_plain_number_takes_no_unit():
    with pytest.raises(ValueError, match="expected a number, read '5 mm', which has a unit"):
        to_si("5 mm", NUMBER)


@pytest.mark.parametrize("text", ["1 m^9^9^9^9", "9**9**9**9", "1 " + "(" * 70, "1 " + "a" * 70 + "!", "1" * 5000])
def test_an_expression_that_could_hang_a_parser_is_refused(text):
    with pytest.raises(ValueError, match="expected a length in m"):
        to_si(text, LENGTH)


@pytest.mark.parametrize("unit", COMMON_UNITS)
def test_every_unit_of_the_reference_is_known(unit):
    factor, _ = units._in_base_units(unit)
    assert factor > 0


@given(st.floats(-1e100, 1e100), st.sampled_from([("mm", 1e-3), ("cm", 1e-2), ("km", 1e3), ("in", 0.0254), ("m", 1.0)]))
def test_a_length_in_a_unit_is_the_number_times_the_factor(number, unit):
    name, factor = unit
    assert to_si(f"{number!r} {name}", LENGTH) == pytest.approx(number * factor, rel=4e-16, abs=1e-320)


@given(st.integers(-999, 999), st.integers(1, 999))
def test_a_fraction_is_divided_and_rounded_once(numerator, denominator):
    assert to_si(f"{numerator}/{denominator}", TIME) == numerator / denominator


@given(st.text(max_size=30), st.sampled_from(units.DIMENSIONS))
def test_any_text_is_a_finite_number_or_refused(text, dimension):
    try:
        outcome = to_si(text, dimension)
    except ValueError as error:
        outcome = str(error)
    assert outcome.startswith(f"expected {dimension}, read ") if isinstance(outcome, str) else math.isfinite(outcome)
