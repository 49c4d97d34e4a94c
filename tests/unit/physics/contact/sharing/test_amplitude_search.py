"""The search for an amplitude, on frictions whose answer is known."""

import pytest

from squeezefilm.core.errors import OutOfRangeError, UnreachableError
from squeezefilm.physics.contact.sharing.levitation import HIGHEST_AMPLITUDE, least_amplitude


def falling(amplitude: float) -> float:
    return 1 / (1 + amplitude / 1e-6)


@pytest.mark.parametrize("wanted", [0.9, 0.5, 0.1])
def test_the_amplitude_found_gives_the_friction(wanted: float) -> None:
    assert falling(least_amplitude(falling, wanted, "by hand")) == pytest.approx(wanted, rel=1e-6)


def test_nothing_is_needed_for_the_friction_at_rest() -> None:
    assert least_amplitude(falling, 1.0, "by hand") == 0.0
    assert least_amplitude(lambda a: 0.8 * falling(a), 0.85, "by hand") == 0.0


def test_what_no_amplitude_reaches_says_what_is_reached() -> None:
    least = falling(HIGHEST_AMPLITUDE)
    with pytest.raises(UnreachableError, match=f"gives {least:.4g} at the least"):
        least_amplitude(falling, 0.5 * least, "by hand")

    def closing(amplitude: float) -> float:
        if amplitude > 1e-6:
            raise OutOfRangeError("the gap closes")
        return falling(amplitude)

    with pytest.raises(UnreachableError, match="by hand"):
        least_amplitude(closing, 0.2, "by hand")


def test_nothing_beyond_the_highest_amplitude_is_asked() -> None:
    asked: list[float] = []

    def told(amplitude: float) -> float:
        asked.append(amplitude)
        return falling(amplitude)

    with pytest.raises(UnreachableError, match="up to 20 µm"):
        least_amplitude(told, 0.0, "by hand", 20e-6)
    assert max(asked) == pytest.approx(20e-6)
