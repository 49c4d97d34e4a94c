"""The device alone, out of sweeps of it in its fixture, of the open and of the shorted fixture."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import cast

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.measure.recordings.description import DescribedImpedance, Description
from squeezefilm.measure.recordings.kinds import ImpedanceSweep, Recording

_HZ = si.Unit("Hz")


def fixture_description(description: Description) -> Description:
    """The description of a device's sweep as that of its fixture alone.

    Raises `ConfigError` where the leads are to be fitted as well.
    """
    said = cast(DescribedImpedance, description.said)
    if said.compensated is False:
        raise description.error(
            "compensated = false and files of an open or shorted fixture exclude each other; "
            "leave one of them out",
            ["compensated"],
        )
    alone = dataclasses.replace(said, bar=None, disc=None, band=None, points=None)
    return dataclasses.replace(description, said=alone)


def without_fixture(
    device: Recording, fixtures: Mapping[str, Recording], description: Description
) -> ImpedanceSweep:
    """A sweep of the device alone; `fixtures` are "open", "short" or both.

    What lies in series with the device is told by the shorted fixture, what lies across it by the
    open one. Both are taken between their points by straight lines, and without their noise, which
    averages should make small. Raises `ConfigError` where a fixture was not swept as far, and
    where it is as the device.
    """
    sweep = cast(ImpedanceSweep, device)

    def impedance(key: str) -> si.ComplexArray:
        fixture = cast(ImpedanceSweep, fixtures[key])
        low, high = fixture.frequency[[0, -1]].tolist()
        if not low <= sweep.frequency[0] <= sweep.frequency[-1] <= high:
            ends = f"{si.format_quantity(low, _HZ)} to {si.format_quantity(high, _HZ)}"
            raise description.error(
                f"the file goes from {ends}, and the device was swept beyond; sweep the fixture "
                "over the same frequencies",
                [key],
            )
        admittance = np.interp(sweep.frequency, fixture.frequency, fixture.admittance)
        return np.asarray(1 / admittance, dtype=complex)

    in_series = impedance("short") if "short" in fixtures else 0.0
    with np.errstate(divide="ignore", invalid="ignore"):
        across = 1 / (impedance("open") - in_series) if "open" in fixtures else 0.0
        admittance = 1 / (1 / sweep.admittance - in_series) - across
    if not np.all(np.isfinite(admittance)):
        raise description.error(
            "the fixture measures as the device does, so that nothing of it is left; name sweeps "
            "of the fixture alone",
            [next(iter(fixtures))],
        )
    return dataclasses.replace(sweep, admittance=admittance, compensated=True)
