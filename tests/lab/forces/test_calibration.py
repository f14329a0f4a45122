"""Calibration of force sensors: against a sensor whose conductance is proportional to its force, in closed form."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from liftopt.commands.cli import main
from liftopt.errors import InputError
from liftopt.lab.forces.calibration import Calibration, Curve, calibrate, load_calibration, save_calibration
from liftopt.lab.forces.calibration_series import Series, mean_series, read_series
from liftopt.lab.forces.voltage_divider import Divider

DIVIDER = Divider(supply=5.0, resistor=10_000.0, full_scale=1023)
SIEMENS_PER_NEWTON = 2e-5  # 5 kohm at 10 N: the order of an FSR 402 (data sheet, Interlink 2010)
GRAMS = np.arange(0.0, 301.0, 3.0)  # the paper's steps of 3 g
NEWTONS = 9.81e-3 * GRAMS


def voltage_of(force: Any, divider: Divider = DIVIDER) -> Any:
    """Return V = R Vs / (R + Rs) of the ideal sensor."""
    with np.errstate(divide="ignore"):
        sensor = 1.0 / (SIEMENS_PER_NEWTON * np.asarray(force, float))
    return divider.resistor * divider.supply / (divider.resistor + sensor)


def write(path: Path, *rows: str, header: str = "voltage [V],weight [g]") -> Path:
    path.write_text("\n".join([header, *rows]) + "\n")
    return path


def write_series(path: Path, voltage: Any, grams: Any = GRAMS) -> Path:
    return write(path, *(f"{v:.9f},{g:g}" for v, g in zip(voltage, grams, strict=True)))


@pytest.fixture
def four(tmp_path: Path) -> list[Path]:
    """Return four series that scatter about the ideal sensor and whose mean is it."""
    scatter = 0.01 * np.sin(NEWTONS)
    return [write_series(tmp_path / f"{k}.csv", voltage_of(NEWTONS) + k * scatter) for k in (-2, -1, 1, 2)]


def test_the_curve_goes_through_the_mean_of_four_series(four: list[Path]) -> None:
    fit = calibrate(four, DIVIDER)
    curve = fit.calibration.curve("finger1")
    np.testing.assert_allclose(curve.of(voltage_of(NEWTONS)), NEWTONS, atol=1e-7)
    fine = np.linspace(0.0, NEWTONS[-1], 5000)
    # Between loads 0.03 N apart the monotone cubic leaves the hyperbola by 1.4e-5 N (measured).
    np.testing.assert_allclose(curve.of(voltage_of(fine)), fine, atol=2e-5)
    assert fit.series == {"all": 4}
    slope = np.gradient(NEWTONS, voltage_of(NEWTONS))
    assert fit.residual_max["all"] == pytest.approx(np.max(np.abs(2 * 0.01 * np.sin(NEWTONS)) * slope), rel=0.05)
    assert fit.notes == ()


def test_units_of_voltage_and_weight_do_not_matter(tmp_path: Path) -> None:
    grams = np.array([0.0, 30.0, 60.0, 90.0])
    volts = DIVIDER.supply * np.array([0, 100, 180, 250]) / 1023
    plain = read_series(write_series(tmp_path / "v.csv", volts, grams), DIVIDER)[0]
    others = [
        write(tmp_path / "mv.csv", *(f"{v * 1e3:.12g};{g / 1e3:.12g}" for v, g in zip(volts, grams, strict=True)),
              header="Voltage (mV);Weight (kg)"),
        write(tmp_path / "c.csv", *(f"{g * 9.81e-3:.12g}\t{c}" for g, c in zip(grams, (0, 100, 180, 250), strict=True)),
              header="weight [N]\tvoltage [counts]"),
    ]  # fmt: skip
    for path in others:
        one = read_series(path, DIVIDER)[0]
        np.testing.assert_allclose(one.voltage, plain.voltage, atol=1e-8)
        np.testing.assert_allclose(one.force, plain.force, atol=1e-12)


def test_series_with_other_loads_are_interpolated_and_the_shortest_ends_the_curve(tmp_path: Path) -> None:
    long = write_series(tmp_path / "long.csv", voltage_of(NEWTONS))
    other = 1.5 + GRAMS[:60]
    short = write_series(tmp_path / "short.csv", voltage_of(9.81e-3 * other), other)
    fit = calibrate([long, short], DIVIDER)
    curve = fit.calibration.curve("thumb")
    assert curve.force[0] == pytest.approx(9.81e-3 * 3.0)
    assert curve.force[-1] == pytest.approx(9.81e-3 * 177.0)
    np.testing.assert_allclose(curve.of(voltage_of(NEWTONS[1:60])), NEWTONS[1:60], atol=3e-5)
    assert "the curve ends there" in fit.notes[0]
    assert curve.of(np.array([0.0, -0.01])) == pytest.approx(0.0)  # unloaded, though the curve starts at 3 g


def test_one_file_may_hold_several_series_and_sensors(tmp_path: Path) -> None:
    rows = [
        f"{name},{series},{(1.0 + 0.1 * i) * voltage_of(f):.12g},{f:g}"
        for i, name in enumerate(("finger1", "thumb1"))
        for series in "ab"
        for f in (0.0, 1.0, 2.0)
    ]
    fit = calibrate([write(tmp_path / "s.csv", *rows, header="channel,series,voltage [V],weight [N]")], DIVIDER)
    assert fit.series == {"finger1": 2, "thumb1": 2}
    assert fit.calibration.curve("Thumb1").of(1.1 * voltage_of(1.0)) == pytest.approx(1.0)
    with pytest.raises(InputError, match="channel finger2: the calibration knows only finger1, thumb1"):
        fit.calibration.curve("finger2")


def test_a_step_back_is_pooled_and_a_saturated_load_is_left_out() -> None:
    force = np.arange(6.0)
    series = [Series("one", "all", np.array([0.0, 1.0, 2.2, 2.0, 3.0, 5.0]), force)]
    mean = mean_series(series, DIVIDER)
    np.testing.assert_allclose(mean.voltage, [0.0, 1.0, 2.1, 3.0])
    np.testing.assert_allclose(mean.force, [0.0, 1.0, 2.5, 4.0])
    assert len(mean.notes) == 2


@pytest.mark.parametrize("lightest", [0.0, 1.0])
def test_what_an_unloaded_sensor_shows_means_no_force(lightest: float) -> None:
    """A force-sensitive resistor conducts nothing below its break force: several loads read 0 V."""
    force = lightest + np.arange(5.0)
    mean = mean_series([Series("one", "all", np.array([0.0, 0.0, 1.0, 2.0, 3.0]), force)], DIVIDER)
    np.testing.assert_allclose(mean.voltage, [0.0, 1.0, 2.0, 3.0])
    np.testing.assert_allclose(mean.force, [0.0, *force[2:]])


@settings(max_examples=60, deadline=None)
@example([0.0, 0.0, 5e-149, 1.0, 2.0])
@example([6e-08, 5.9e-08, 6e-08, 1.0])  # the first two are pooled half way between two roundings
@given(st.lists(st.floats(0.0, 4.9), min_size=4, max_size=30))
def test_whatever_was_read_the_curve_never_falls(voltages: list[float]) -> None:
    series = [Series("any", "all", np.array(voltages), np.arange(float(len(voltages))))]
    try:
        mean = mean_series(series, DIVIDER)
    except InputError:
        return
    curve = Curve(voltage=tuple(mean.voltage), force=tuple(mean.force))
    force = curve.of(np.linspace(-0.1, 5.1, 800))
    assert np.all(np.diff(force) >= -1e-9)
    assert force[-1] == pytest.approx(mean.force[-1])


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("voltage,weight [g]\n1,2\n", "line 1 = 'voltage': a column states no unit"),
        ("voltage [V],weight [lb]\n1,2\n", r"line 1 = 'weight \[lb\]': the unit must be N or kg or g"),
        ("voltage [A],weight [g]\n1,2\n", r"'voltage \[A\]': the unit must be V or mV or counts"),
        ("voltage [V],load [g]\n1,2\n", "has no column weight"),
        ("voltage [V],weight [g]\n0.1,0\n0.2,three\n", "line 3 = 'three': the column weight must hold numbers"),
        ("voltage [V],weight [g]\n0.1,0\n0.2\n0.3,9\n", "line 3 = '1 fields': the header names 2 columns"),
        ("voltage [V],weight [g]\n0.1,0\n5.2,3\n", "line 3 = '5.2,3': needs a voltage from 0 to 5 V"),
        ("voltage [mV],weight [g]\n0.1,0\n5200,3\n", "needs a voltage from 0 to 5000 mV"),
        ("voltage [V],weight [g]\n0.1,-3\n", "line 2 = '0.1,-3'.*a weight from 0 to 10000 N"),
        ("voltage [V],weight [g]\n0.1,\n", "line 2 = '0.1,'"),
        ("voltage [V],weight [g]\ninf,1\n", "line 2 = 'inf': the column voltage must hold finite"),
        ("voltage [V],weight [g]\n0.1,0\n0.2,3\n", "'2 different weights': a series needs three"),
        ("voltage [V],weight [g]\n3,0\n2,3\n1,6\n", "is the sensor between supply and output"),
        ("voltage [V],weight [g]\n", "holds no rows"),
        ("", "is empty"),
    ],
)
def test_a_bad_series_is_named_with_its_line(text: str, said: str, tmp_path: Path) -> None:
    path = tmp_path / "series.csv"
    path.write_text(text)
    with pytest.raises(InputError, match=said) as caught:
        calibrate([path], DIVIDER)
    assert str(path) in str(caught.value)


def test_the_divider_is_its_closed_form() -> None:
    volts = np.array([0.0, 1.0, 2.5, 4.0])
    np.testing.assert_allclose(DIVIDER.conductance(volts), volts / (1e4 * (5.0 - volts)))
    np.testing.assert_allclose(DIVIDER.voltage(DIVIDER.conductance(volts)), volts, atol=1e-12)
    assert DIVIDER.conductance(np.array(5.0)) == np.inf
    assert DIVIDER.voltage(np.array(np.inf)) == 5.0
    np.testing.assert_array_equal(DIVIDER.saturated(np.array([4.98, 5 * 1022 / 1023, 5.0])), [False, True, True])


def test_a_calibration_moves_to_another_divider_by_the_conductance(four: list[Path]) -> None:
    other = Divider(supply=3.3, resistor=4_700.0, full_scale=4095)
    moved = calibrate(four, DIVIDER).calibration.wired(other)
    np.testing.assert_allclose(moved.curve("finger1").of(voltage_of(NEWTONS, other)), NEWTONS, atol=1e-6)
    assert moved.divider == other


def test_it_is_kept_as_toml_and_never_written_over(four: list[Path], tmp_path: Path) -> None:
    calibration, path = calibrate(four, DIVIDER).calibration, tmp_path / "new" / "cal.toml"
    save_calibration(calibration, path)
    assert load_calibration(path) == calibration
    before = path.read_bytes()
    with pytest.raises(InputError, match="exists already"):
        save_calibration(calibration, path)
    assert path.read_bytes() == before
    assert list(path.parent.iterdir()) == [path]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("schema = 1", "curves: is missing"),
        ("schema = 2\n[curves.all]\nvoltage=[0,1]\nforce=[0,1]", "schema = 2"),
        ("[curves.all]\nvoltage=[0,1]\nforce=[0,1,2]", "'3 numbers': there are 2 voltages"),
        ("[curves.all]\nvoltage=[0,1,1]\nforce=[0,1,2]", r"curves.all.voltage = \[0, 1, 1\]"),
        ("[curves.all]\nvoltage=[0,1]\nforce=[0,nan]", "curves.all.force"),
        ("[curves]", "curves = {}"),
        ("[curves.all]\nvoltage=[0,1]\nforce=[0,1]\n[divider]\nresistor=0", "divider.resistor = 0"),
        ("curves", "is not valid TOML"),
    ],
)
def test_a_bad_calibration_is_named_with_its_key(text: str, said: str, tmp_path: Path) -> None:
    path = tmp_path / "cal.toml"
    path.write_text(text)
    with pytest.raises(InputError, match=said) as caught:
        load_calibration(path)
    assert str(path) in str(caught.value)


def test_the_command_says_how_well_the_curve_fits(
    four: list[Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "cal.toml"
    assert main(["calibrate", *map(str, four), "--out", str(out), "--resistor", "10000"]) == 0
    said = capsys.readouterr().out
    assert "all: 4 series, 0 to 2.94 N, 0 to 1.85 V; readings within" in said
    assert isinstance(load_calibration(out), Calibration)
    assert main(["calibrate", *map(str, four), "--out", str(out)]) == 2
    assert "never written over" in capsys.readouterr().err
