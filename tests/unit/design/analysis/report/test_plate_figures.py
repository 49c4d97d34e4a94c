"""The figures of the vibrating body: every shape and line where the description puts it."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from tests.unit.drawn import labelled, words

from squeezefilm.design.analysis.report.figures import (
    frequency_response,
    half_power,
)

pytestmark = pytest.mark.usefixtures("figures_as_described")


def data(line: Any) -> tuple[np.ndarray, np.ndarray]:
    return np.asarray(line.get_xdata(), float), np.asarray(line.get_ydata(), float)


FREQUENCY = np.linspace(29.5e3, 30.5e3, 401)


def driven(**changes: Any) -> Any:
    """A resonance of Q = 100 at 30 kHz with 100 nm/V at its top, driven on it by 20 V."""
    peak = changes.pop("peak", 1e-7)
    r = FREQUENCY / 30e3
    own = changes.pop("own", peak)
    solid = changes.pop("solid", None)
    free = changes.pop("free", 2e-6)
    parts: dict[str, Any] = {
        "voltage": 20.0, "vibration_amplitude": free, "frequency": 30e3,
        "touch": SimpleNamespace(free_amplitude=free),
        "mode": SimpleNamespace(
            solid=solid, amplitude_per_volt=own, resonance_frequency=30e3, quality_factor=100.0
        ),
    }  # fmt: skip
    return SimpleNamespace(
        response=SimpleNamespace(
            frequency=FREQUENCY, model="a-model",
            amplitude_per_volt=peak / 100 / np.abs(1 - r**2 + 0.01j * r),
        ),
        prediction=SimpleNamespace(**{**parts, **changes}),
    )  # fmt: skip


def test_a_response_has_its_resonance_band_and_drive() -> None:
    figure = frequency_response(driven())
    assert words(figure.get_suptitle()) == (
        "The resonance at 30 kHz is 300 Hz wide: the drive must stay on it"
    )
    (axes,) = figure.axes
    seen = {words(name): one for name, one in labelled(axes).items()}
    assert list(seen) == [
        "half-power band, 29.85 to 30.15 kHz (above 71 % of the peak)",
        "amplitude per volt, quality factor Q = 100", "resonance, 30 kHz",
        "drive: 20 V at 30 kHz, 2 µm free",
    ]  # fmt: skip
    band, curve, line, drive = seen.values()
    ends = axes.transData.inverted().transform(band.get_extents())[:, 0]
    assert ends == pytest.approx([29.85, 30.15], abs=2e-3)
    f, w = data(curve)
    assert f == pytest.approx(FREQUENCY / 1e3)
    assert np.max(w) == pytest.approx(100)
    assert data(line)[0] == pytest.approx([30, 30])
    # 2 µm at 20 V are 100 nm/V.
    assert data(drive) == (pytest.approx([30]), pytest.approx([100]))
    assert axes.get_xlim() == pytest.approx((29.5, 30.5))
    low, high = axes.get_ylim()
    assert low == 0
    assert 100 < high < 120
    assert (axes.get_xlabel(), axes.get_ylabel()) == (
        "frequency (kHz)", "amplitude per volt, free (nm/V)",
    )  # fmt: skip
    (right,) = axes.child_axes
    assert right.get_ylabel() == "amplitude at 20 V (µm)"
    FigureCanvasAgg(figure).draw()
    assert right.get_ylim() == pytest.approx(0.02 * np.array(axes.get_ylim()))


@pytest.mark.parametrize(("share", "said"), [(0.985, " 98 % of the motion"), (0.995, None)])
def test_a_drive_beside_the_resonance_is_said(share: float, said: str | None) -> None:
    # What a finger damps is no matter of where the drive is.
    found = driven(frequency=30.02e3, free=share * 2e-6, vibration_amplitude=0.5e-6)
    title = words(frequency_response(found).get_suptitle())
    assert title.startswith("The resonance at 30 kHz is 300 Hz wide: the drive must stay on it")
    assert ("but at 30.02 kHz it gets" in title) == (said is not None)
    if said:
        assert title.endswith(said)
    name = [*labelled(frequency_response(found).axes[0])][-1]
    assert words(name).endswith(" µm free, 0.5 µm with the finger on")


def test_a_drive_outside_the_sweep_or_none_is_not_drawn() -> None:
    def names(**changes: Any) -> list[str]:
        return [words(name) for name in labelled(frequency_response(driven(**changes)).axes[0])]

    ends = (29.5e3, 30.5e3)
    assert all("drive: 20 V" in names(frequency=at)[-1] for at in ends)
    assert all("resonance" in names(frequency=at)[-1] for at in (29.4e3, 30.6e3))
    given = frequency_response(driven(voltage=None))
    assert list(labelled(given.axes[0]))[-1].startswith("resonance")
    assert given.axes[0].child_axes == []
    # Nothing moves at 0 V; the drive still stands at the peak per volt.
    still = frequency_response(driven(voltage=0.0, free=0.0)).axes[0]
    assert words(list(labelled(still))[-1]).startswith("drive: 0 V at 30 kHz")
    assert data(list(labelled(still).values())[-1])[1] == pytest.approx([100])
    assert still.child_axes == []


def test_ceramics_that_cancel_out_have_no_band() -> None:
    """What is left of the drive is a rounding error of the others' peak."""
    for changes in ({"own": 1e-18}, {"solid": SimpleNamespace(alone_per_volt=1e-18)}):
        figure = frequency_response(driven(**changes))
        assert words(figure.get_suptitle()) == (
            "The ceramics cancel out: they do not drive the mode at 30 kHz"
        )
        assert not any("half-power" in name for name in labelled(figure.axes[0]))
    figure = frequency_response(driven(peak=0.0))
    assert figure.axes[0].get_ylim() == (0, 1)


def test_half_power_lies_on_the_line_between_two_points() -> None:
    # A triangle of height 1 falls to 1/√2 at 1 − 1/√2 of its base to either side.
    frequency = np.array([0.0, 10.0, 20.0, 40.0])
    edge = 10 * (1 - 1 / math.sqrt(2))
    found = half_power(frequency, np.array([0.0, 0.0, 1.0, 0.0]))
    assert found == pytest.approx((20 - edge, 20 + 2 * edge))
    assert half_power(frequency, np.array([1.0, 0.5, 0.2, 0.1])) is None
    assert half_power(frequency, np.array([0.1, 0.5, 0.8, 1.0])) is None
    # What falls to exactly that value has not fallen below it.
    assert half_power(frequency, np.array([0.8, 0.9, 1.0, 0.8])) is None
