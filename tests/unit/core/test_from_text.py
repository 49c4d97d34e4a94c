"""Text in place of values: what is read, what is passed on as it is, and in which words refused."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import numpy as np
import pytest

from squeezefilm.core.arguments import ReadBy, reads_text
from squeezefilm.core.errors import QuantityError
from squeezefilm.core.quantities import Dimensionless, Hertz, Metre, MetreArray, Volt

Named = Annotated[dict[str, str], ReadBy(lambda text: {"named": str(text)})]


@reads_text
def asked(
    what: Named,
    length: Metre,
    *,
    volts: Volt | None = None,
    band: tuple[Hertz, Hertz] | None = None,
    places: MetreArray | None = None,
    word: str = "2 mm",
    share: Dimensionless = 0.5,
) -> tuple[object, ...]:
    """What reached it."""
    return what, length, volts, band, places, word, share


@reads_text
@dataclass(frozen=True, slots=True)
class Rod:
    """A length and a word."""

    length: Metre
    word: str = "3 mm"


def test_text_becomes_what_the_annotation_says() -> None:
    found = asked("plate", "2 mm", volts="15 V", band=("1 kHz", "2 kHz"), share="20 %")
    assert found == ({"named": "plate"}, 2e-3, 15.0, (1e3, 2e3), None, "2 mm", 0.2)
    assert asked(Path("a.toml"), 1.0)[0] == {"named": "a.toml"}
    assert asked({}, 1.0, places=["1 mm", 0.5])[4] == [1e-3, 0.5]
    assert Rod("2 mm") == Rod(2e-3)
    assert Rod("2 mm").word == "3 mm"


def test_what_is_no_text_is_passed_on_as_it_is() -> None:
    array, named = np.ones(3), {"a": "b"}
    what, length, volts, band, places, word, share = asked(
        named, 2, volts=None, band=(1.0, 2.0), places=array
    )
    assert what is named
    assert places is array
    assert (length, volts, band, word, share) == (2, None, (1.0, 2.0), "2 mm", 0.5)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (
            {"length": "2 V"},
            "^length: '2 V' has the wrong dimension: it is a voltage",
        ),
        ({"length": "2"}, "^length: '2' has no unit"),
        ({"length": "two"}, "^length: 'two' is no quantity"),
        ({"length": 1.0, "band": ("1 Hz", "2 m")}, "^band: '2 m' has the wrong dimension"),
    ],
)
def test_a_refusal_names_the_argument(given: dict[str, object], message: str) -> None:
    with pytest.raises(QuantityError, match=message) as refused:
        asked({}, **given)  # type: ignore[arg-type]
    assert refused.value.quantity == next(reversed(given))


def test_missing_and_unknown_arguments_are_refused_in_python_s_words() -> None:
    with pytest.raises(TypeError, match=r"asked\(\) missing 1 required positional argument"):
        asked("plate")  # type: ignore[call-arg]
    with pytest.raises(TypeError, match="unexpected keyword argument 'lengths'"):
        asked("plate", 1.0, lengths="2 mm")  # type: ignore[call-arg]
