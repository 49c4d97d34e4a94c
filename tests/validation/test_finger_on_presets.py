"""What a finger does to metal and glass: the table of the page of models, computed again."""

import re
from pathlib import Path

import pytest

from squeezefilm.physics.chain.prediction import predict
from squeezefilm.physics.display import load_display

PAGE = Path(__file__).parents[2] / "docs" / "explanation" / "models.md"
FORCES = (0.1, 0.5, 1.0, 2.0)
ROW = re.compile(r"\| `([\w-]+)`, \w+, ([\d.]+) V, (\d+) \|(.+)\|")


def finger(display: str, voltage: float, force: float) -> tuple[float, float, float]:
    """Amplitude kept (%), Q and shift of the resonance (Hz), as the table has them."""
    found = predict(load_display(display), voltage=voltage, normal_force=force)
    mode = found.touch.mode
    assert mode is not None
    shift = mode.resonance_frequency - mode.free_frequency
    return 100 * found.touch.kept, mode.quality_factor, shift


def numbers(cell: str) -> list[float]:
    """The three of a cell such as "98.5 % · 59.1 · +3.7 Hz"."""
    return [float(one) for one in re.findall(r"[-+]?[\d.]+", cell.replace("−", "-"))]


def rows(display: str) -> list[tuple[float, int, list[str]]]:
    """Voltage, Q without a finger and the cells of each row of a display."""
    return [
        (float(volts), int(quality), [one.strip() for one in cells.split("|")])
        for name, volts, quality, cells in ROW.findall(PAGE.read_text(encoding="utf-8"))
        if name == display
    ]


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize(
    "display",
    [
        pytest.param("biet2008-plate", marks=pytest.mark.slow),
        pytest.param("touchpad-glass", marks=pytest.mark.nightly),
    ],
)
def test_the_table_of_fingers_on_metal_and_glass_is_what_is_computed(display: str) -> None:
    drive = load_display(display).drive.voltage
    found = rows(display)
    assert [volts for volts, _, _ in found] == pytest.approx([drive, drive / 10])
    for volts, quality, cells in found:
        mode = predict(load_display(display), voltage=volts).mode
        assert quality == round(mode.quality_factor)
        for force, cell in zip(FORCES, cells, strict=True):
            assert numbers(cell) == pytest.approx(finger(display, volts, force), rel=2e-3, abs=0.06)


@pytest.mark.nightly
@pytest.mark.filterwarnings("ignore")
def test_on_glass_the_amplitude_gives_way_at_the_force_that_the_page_says() -> None:
    said = re.search(
        r"(\d+) % is left at ([\d.]+) N and (\d+) % at ([\d.]+) N", PAGE.read_text("utf-8")
    )
    assert said is not None
    for kept, force in (said.group(1, 2), said.group(3, 4)):
        assert finger("touchpad-glass", 30.0, float(force))[0] == pytest.approx(
            float(kept), abs=0.6
        )


def test_the_stator_has_the_impedances_that_the_page_says() -> None:
    said = re.search(r"would have\s+Z = (.+?)\s+N·s/m", PAGE.read_text(encoding="utf-8"), re.S)
    assert said is not None
    numbers = [complex(a + b + "j") for a, b in _parts(said[1])]
    for force, number in zip(FORCES, numbers, strict=True):
        found = predict("biet2008-stator", normal_force=force).touch.impedance
        assert found == pytest.approx(number, abs=0.0072)


def _parts(text: str) -> list[tuple[str, str]]:
    return [
        (real, "-" + imaginary) for real, imaginary in re.findall(r"([\d.]+) − ([\d.]+)i", text)
    ]
