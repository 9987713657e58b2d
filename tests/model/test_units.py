"""Conversion to SI: all valid forms of a value give the same float, others are refused."""

import contextlib
import re
from decimal import Decimal

import numpy as np
import pint
import pytest
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st

from ratestate import ParameterError, linspace, logspace
from ratestate.model.arrays import check_aligned, column_to_si
from ratestate.model.quantities import KINDS, QUANTITIES, attrs, long_time_unit
from ratestate.model.units import _PREFIXES, _registry, to_si, unit_factor

STRINGS = [
    ("Dc", "10 um", 1e-05),
    ("Dc", "10 µm", 1e-05),
    ("Dc", "1e-2mm", 1e-05),
    ("V_lp", "3.2 mm/s", 0.0032),
    ("V_lp", " 0.1 mm/s ", 1e-4),
    ("V_lp", "0.1 mm s-1", 1e-4),
    ("sigma", "2 MPa", 2e6),
    ("sigma", "2e6", None),
    ("sigma", "1 bar", 1e5),
    ("K", "900 MPa/m", 9e8),
    ("K", "inf", np.inf),
    ("M", "3000 kg/m2", 3000.0),
    ("M", "3000 kg m-2", 3000.0),
    ("M", "0.3 g/mm**2", 300.0),
    ("t_end", "1 day", 86400.0),
    ("dt", "50 us", 5e-05),
    ("a", "0.003", 0.003),
    ("a", "0.3 %", 0.003),
]


@pytest.mark.parametrize(("symbol", "text", "si"), STRINGS)
def test_strings_are_read_exactly(symbol, text, si):
    if si is None:
        with pytest.raises(ParameterError, match="has no unit"):
            to_si(symbol, text)
    else:
        assert to_si(symbol, text) == si
        assert type(to_si(symbol, text)) is float


@pytest.mark.parametrize("registry", [pint.UnitRegistry(), pint.UnitRegistry(non_int_type=Decimal)])
def test_pint_quantities_of_any_registry(registry):
    assert to_si("Dc", registry.Quantity(10, "um")) == 1e-05
    assert to_si("Dc", registry.Quantity("10 um")) == 1e-05
    assert to_si("K", registry.Quantity(900, "MPa") / registry.Quantity(1, "m")) == 9e8
    with pytest.raises(ParameterError, match=re.escape("sigma = 3 meter is a length")):
        to_si("sigma", registry.Quantity(3, "m"))
    with pytest.raises(ParameterError, match="dims='Dc'"):
        to_si("Dc", registry.Quantity(np.array([1, 2]), "um"))


@pytest.mark.parametrize("unit", [unit for unit in KINDS if unit[0] in "msPH"])
@pytest.mark.parametrize("prefix", _PREFIXES)
def test_units_read_without_pint_agree_with_pint(unit, prefix):
    by_pint = _registry().Quantity(Decimal(1), prefix + unit).to(unit).magnitude
    assert unit_factor(unit, prefix + unit) == by_pint


def test_pint_has_the_units_of_the_tables_and_examples_are_valid():
    for symbol, quantity in QUANTITIES.items():
        assert (
            _registry()
            .Quantity(Decimal(1), quantity.unit)
            .is_compatible_with(quantity.unit if quantity.unit != "1" else "dimensionless")
        )
        example = quantity.example or KINDS[quantity.unit][1]
        assert to_si(symbol, example.strip("'")) > 0, symbol
        assert attrs(symbol) == {"units": quantity.unit, "long_name": quantity.long_name}


@pytest.mark.parametrize(
    "value",
    [3, 3.0, np.float64(3), np.float32(3), np.int16(3), np.array(3.0), Decimal(3), "3 kg/m^2"],
)
def test_to_si_of_a_scalar_is_a_float(value):
    assert to_si("M", value) == 3.0
    assert type(to_si("M", value)) is float


class TwoLines:
    def __repr__(self):
        return "1\n2"


REFUSED = [
    ("V_lp", "3.2 mm", "V_lp = '3.2 mm' is a length. Give a speed such as '3.2 mm/s'"),
    ("V_lp", "3.2", "V_lp = '3.2' has no unit. Give a speed"),
    ("V_lp", "3.2 mn/s", "V_lp = '3.2 mn/s' has an unknown unit 'mn/s'. Give a speed"),
    ("V_lp", "fast", "V_lp = 'fast' is not a number with a unit. Give a speed"),
    ("V_lp", "-3.2 mm/s", "V_lp = '-3.2 mm/s' must be > 0. Give a speed such as"),
    ("sigma", "5 degC", "sigma = '5 degC' is of dimension [temperature]. Give a stress"),
    ("sigma", "200 N", "sigma = '200 N' is of the whole contact, and must be divided by its area"),
    ("V_lp", "3 m^3/s", "V_lp = '3 m^3/s' is of dimension"),  # not a unit of data sheets
    ("sigma", -2e6, "sigma = -2e+06 Pa must be > 0. Give a stress such as '2 MPa'"),
    ("sigma", np.inf, "sigma = inf Pa must be finite"),
    ("K", "1e999", "K = '1e999' has no unit"),
    ("sigma", "1e400 Pa", "sigma = '1e400 Pa' is out of range"),
    ("sigma", 10**400, "sigma = inf Pa must be finite"),
    ("Dc", np.nan, "Dc = nan m is not a number. Give a length such as '10 um'"),
    ("a", "3 um", "a = '3 um' is a length. Give a pure number such as 0.003"),
    ("M", -1, "M = -1 kg/m^2 must be >= 0. Give a mass per area such as '3000"),
    ("M", -5e-324, "must be >= 0"),
    ("M", True, "M = True is of type bool. Give a mass per area"),
    ("M", np.True_, "is of type bool"),
    ("M", None, "M = None is of type NoneType. Give a mass per area"),
    ("M", 1j, "is of type complex"),
    ("M", TwoLines(), "M = 1 2 is of type TwoLines. Give a mass per area"),
    ("M", [1.0, 2.0], "For many values give xarray.DataArray("),
]


@pytest.mark.parametrize(("symbol", "value", "message"), REFUSED)
def test_wrong_values_are_refused(symbol, value, message):
    with pytest.raises(ParameterError, match=re.escape(message)) as error:
        to_si(symbol, value)
    assert str(error.value).startswith(f"{symbol} = ")
    assert isinstance(error.value, ValueError)


@given(st.floats(1e-12, 1e12), st.sampled_from(["nm", "um", "mm", "cm", "m", "km"]))
def test_strings_are_correctly_rounded(x, unit):
    power = {"nm": -9, "um": -6, "mm": -3, "cm": -2, "m": 0, "km": 3}[unit]
    assert to_si("Dc", f"{x!r} {unit}") == float(Decimal(repr(x)).scaleb(power))


def test_an_array_along_its_symbol_becomes_the_coordinate():
    M = to_si("M", xr.DataArray([1, 2], dims="M"))
    assert M.name == "M"
    assert M.dtype == float
    np.testing.assert_array_equal(M.coords["M"], [1.0, 2.0])
    assert M.attrs == M.coords["M"].attrs == attrs("M")


def test_an_array_is_converted_together_with_its_coordinate():
    V = xr.DataArray([1.0, 3.2], dims="V_lp", attrs={"units": "mm/s"})
    for given_V in (V, V.assign_coords(V_lp=V.values)):
        si = to_si("V_lp", given_V)
        np.testing.assert_array_equal(si, [0.001, 0.0032])
        np.testing.assert_array_equal(si.coords["V_lp"], [0.001, 0.0032])
    np.testing.assert_array_equal(to_si("V_lp", V.assign_coords(V_lp=[7, 8])).V_lp, [7, 8])
    np.testing.assert_array_equal(
        to_si("Dc", xr.DataArray([10.0], dims="x", attrs={"units": "um"})), 1e-5
    )
    np.testing.assert_array_equal(
        to_si("sigma", xr.DataArray([2], dims="x", attrs={"units": "MPa"})), 2e6
    )
    with pytest.raises(
        ParameterError,
        match=re.escape("V_lp has the attribute units = 'mm', which is a length"),
    ):
        to_si("V_lp", V.assign_attrs(units="mm"))
    assert V.attrs == {"units": "mm/s"}  # the array of the user does not change


@pytest.fixture(scope="module")
def offsets():
    """A registry of pint that allows units with offsets."""
    return pint.UnitRegistry(autoconvert_offset_to_baseunit=True)


@pytest.mark.parametrize("unit", ["dB", "Np", "decade", "dBm", "dB/m", "degC", "pH"])
@pytest.mark.parametrize("symbol", ["mu0", "Dc", "sigma"])
def test_units_that_are_not_factors_are_refused(offsets, symbol, unit):
    """Logarithmic and offset units are refused, as text and from pint."""
    with pytest.raises(ParameterError, match=rf"^{symbol} = '10 {unit}' "):
        to_si(symbol, f"10 {unit}")
    with contextlib.suppress(pint.errors.PintError):  # pint cannot make all of them
        quantity = offsets.Quantity(10, unit)
        with pytest.raises(ParameterError, match=rf"^{symbol} = "):
            to_si(symbol, quantity)


@pytest.mark.parametrize("unit", ["ns", "ms", "s", "D"])
def test_a_time_difference_of_numpy_is_not_read_as_an_integer(unit):
    given = np.timedelta64(20, unit)
    for value in (given, np.array([given]), [given, given], xr.DataArray([given], dims="t")):
        with pytest.raises(ParameterError, match=r"^t.*timedelta64|^t.*dtype"):
            column_to_si("t", value)
    with pytest.raises(ParameterError, match="timedelta64"):
        to_si("t", given)
    with pytest.raises(ParameterError, match=r"^n = "):
        logspace("M", 1, 10, given)
    assert to_si("t", np.int64(20)) == 20.0


def test_arrays_of_pint_and_without_dimensions():
    registry = pint.UnitRegistry()
    data = registry.Quantity(np.array([10.0, 20.0]), "um")
    np.testing.assert_array_equal(to_si("Dc", xr.DataArray(data, dims="x")), [1e-5, 2e-5])
    assert to_si("Dc", xr.DataArray(10, attrs={"units": "um"})) == 1e-5
    assert type(to_si("Dc", xr.DataArray(10.0))) is float


@pytest.mark.parametrize(
    ("array", "message"),
    [
        (xr.DataArray([1.0, -2, -3], dims="M"), "M = -2 kg/m^2 at M[1] must be >= 0"),
        (xr.DataArray([1, np.nan], {"x": [5, 6]}, "x"), "M = nan kg/m^2 at x[1] = 6 is not a "),
        (xr.DataArray([[1, np.inf]], dims=("x", "y")), "M = inf kg/m^2 at x[0], y[1] must be "),
        (xr.DataArray([1.0, 2.0]), "M has a dimension called 'dim_0', which cannot be a dimension"),
        (xr.DataArray([1.0, 2.0], dims="time"), "M has a dimension called 'time'"),
        (xr.DataArray([1.0, 2.0], dims="mode"), "M has a dimension called 'mode'"),
        (xr.DataArray([True], dims="M"), "M is a DataArray of dtype bool. Give a mass"),
        (xr.DataArray(["1 kg"], dims="M"), "M is a DataArray of dtype <U4"),
        (xr.DataArray([], dims="M"), "M is a DataArray without values"),
        (xr.DataArray(-1.0), "M = -1 kg/m^2 must be >= 0"),
    ],
)
def test_wrong_arrays_are_refused(array, message):
    with pytest.raises(ParameterError, match=re.escape(message)):
        to_si("M", array)


def test_logspace():
    M = logspace("M", 100, "100000 kg/m^2", 4)
    np.testing.assert_array_equal(M, [1e2, 1e3, 1e4, 1e5])
    np.testing.assert_array_equal(M.M, M)
    assert (M.name, M.dims, M.M.attrs) == ("M", ("M",), attrs("M"))
    eta = logspace("eta", 0.01, 100, 3)  # an axis need not be a parameter
    np.testing.assert_allclose(to_si("V_lp", np.sqrt(eta)), [0.1, 1, 10], rtol=1e-15)
    V = logspace("V_lp", 10**-3.8, 0.1, 13)
    assert (V[0], V[-1], V.size) == (10**-3.8, 0.1, 13)
    np.testing.assert_allclose(np.diff(np.log10(V)), 2.8 / 12, rtol=1e-13)
    assert logspace("ratio", 0.5, 2, 3).sel(ratio=1).item() == 1


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (("M", 0, 1, 3), "M (start) = 0 kg/m^2 must be > 0"),
        (("M", 1, "3 m", 3), "M (stop) = '3 m' is a length"),
        (("K", 1, np.inf, 3), "K needs single, finite values"),
        (("M", 1, 2, 1), "n = 1 is not"),
        (("M", 1, 2, 3.0), "n = 3.0 is not"),
        (("ratio", "1 m", 2, 3), "ratio (start) = '1 m' is a length"),
    ],
)
def test_wrong_axes_are_refused(call, message):
    with pytest.raises(ParameterError, match=re.escape(message)):
        logspace(*call)


def test_check_aligned():
    one, two = logspace("M", 1, 10, 3), logspace("M", 1, 20, 3)
    check_aligned({"M": one, "K": one * 2, "sigma": 1.0, "a": logspace("a", 1e-3, 1e-2, 4)})
    check_aligned({"M": one, "K": xr.DataArray([1, 2, 3], dims="M")})  # without a coordinate
    with pytest.raises(ParameterError, match=r"M and K have different coordinates along .* 'M'"):
        check_aligned({"a": 1.0, "M": one, "K": two})
    with pytest.raises(ParameterError, match="M and K have 3 and 2 values along the dimension 'M'"):
        check_aligned({"M": one, "K": one[:2]})
    bare = xr.DataArray([1, 2, 3], dims="M")
    with pytest.raises(ParameterError, match="M and K have different coordinates"):
        check_aligned({"b": bare, "M": one, "K": two})


def test_units_of_long_times():
    day, year = 24 * 60 * 60, 365.25 * 24 * 60 * 60
    assert long_time_unit(7199.9) is None
    assert long_time_unit(7200.0) == long_time_unit(1.99 * day) == ("hours", 3600.0)
    assert long_time_unit(2.0 * day) == long_time_unit(1.99 * year) == ("days", day)
    assert long_time_unit(2.0 * year) == ("years", year)


def test_linspace():
    b = linspace("b", "-0.001", 0.002, 4)
    assert b.values.tolist() == [-0.001, 0.0, 0.001, 0.002]
    assert b.dims == ("b",)
    assert (
        linspace("V_lp", "1 mm/s", "3 mm/s", 3).V_lp.attrs == logspace("V_lp", 1, 2, 2).V_lp.attrs
    )
    with pytest.raises(ParameterError, match=r"Give for example linspace\('M', 100, 1e5, 12\)"):
        linspace("K", 1, "inf Pa/m", 3)
    with pytest.raises(ParameterError, match="must be > 0"):
        linspace("Dc", -1e-6, 1e-6, 3)
