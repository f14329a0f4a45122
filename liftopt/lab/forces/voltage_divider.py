"""The voltage divider that turns the resistance of a force-sensitive resistor into a voltage (Fig. 7a)."""

from __future__ import annotations

from typing import Annotated

import numpy as np
import numpy.typing as npt

from liftopt.errors import InputError
from liftopt.files.entries import number, whole
from liftopt.files.section import Section
from liftopt.types import Array

VOLTAGE_UNITS = ("V", "mV", "counts")


class Divider(Section):
    """The divider and its converter: the sensor from the supply to the output, a fixed resistor from there to ground.

    V = R Vs / (R + Rs) with the fixed resistor R, the sensor Rs and the supply Vs (data sheet of the FSR 402, Interlink
    2010). The conductance 1 / Rs is what grows about in proportion to the force.
    """

    supply: Annotated[float, number("supply voltage of the divider", "V", 0.0, 24.0, open_low=True)] = 5.0
    resistor: Annotated[float, number("fixed resistor to ground", "ohm", 1.0, 1e7)] = 10_000.0
    full_scale: Annotated[int, whole("what the converter counts at the supply voltage", 1, 2**24)] = 1023

    def volts(self, values: Array, unit: str) -> Array:
        """Return readings as volts.

        Args:
            values: of any shape, in ``unit``.
            unit: V, mV, or counts of the converter.

        Raises:
            InputError: the unit is another.
        """
        if unit not in VOLTAGE_UNITS:
            raise InputError("unit", unit, f"must be one of {', '.join(VOLTAGE_UNITS)}")
        scale = {"V": 1.0, "mV": 1e-3, "counts": self.supply / self.full_scale}[unit]
        return np.asarray(values, float) * scale

    def saturated(self, voltage: Array) -> npt.NDArray[np.bool_]:
        """Return where the output [V] is within a count of the supply: the converter cannot show more."""
        # One and a half, so that a voltage printed with two decimals and cut off still counts.
        return np.asarray(voltage >= self.supply * (1.0 - 1.5 / self.full_scale), bool)

    def conductance(self, voltage: Array) -> Array:
        """Return the sensor's conductance [S] at an output [V]; infinite from the supply voltage on."""
        voltage = np.asarray(voltage, float)
        left = self.supply - voltage
        with np.errstate(divide="ignore"):
            return np.where(left > 0.0, voltage / (self.resistor * np.where(left > 0.0, left, 1.0)), np.inf)

    def voltage(self, conductance: Array) -> Array:
        """Return the output [V] for a conductance [S] of the sensor."""
        product = self.resistor * np.asarray(conductance, float)
        with np.errstate(invalid="ignore"):
            return np.where(np.isinf(product), self.supply, self.supply * product / (1.0 + product))
