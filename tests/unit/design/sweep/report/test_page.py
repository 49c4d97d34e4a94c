"""The page of a sweep: what it says is what the sweep found."""

import math

import numpy as np
import pytest

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.design.sweep.axes import Axis
from squeezefilm.design.sweep.report.figures import drawn_columns, means
from squeezefilm.design.sweep.report.page import sweep_page, wishes
from squeezefilm.design.sweep.swept import Sweep, SweptColumn, varied_values

pytestmark = pytest.mark.usefixtures("figures_as_described")

ASKED = [("relative_friction", si.Unit("1")), ("amplitude_m", si.Unit("m"))]


def made(points: int = 40) -> Sweep:
    random = np.random.default_rng(0).uniform(size=(points, 2))
    axis = Axis(
        ("voltage", "speed"),
        (si.Unit("V"), si.Unit("m/s")),
        tuple(map(tuple, random.tolist())),
        sampled=("linear", "linear"),
    )
    friction = 1 - random[:, 0]
    amplitude = 1e-6 * random[:, 0] * random[:, 1]
    friction[3] = amplitude[3] = math.nan
    columns = (
        SweptColumn("relative_friction", si.Unit("1"), friction),
        SweptColumn("amplitude_m", si.Unit("m"), amplitude),
    )
    reasons = tuple("too <wide>" if k == 3 else "" for k in range(points))
    told = {"finger": "person 3's"}
    return Sweep(
        "made", ("predict",), (axis,), columns, reasons, (("careful", 2),), points, 0, told
    )


def test_it_has_every_part_and_its_pictures() -> None:
    files = sweep_page(made(), ["sweep.csv"], (("relative_friction", 1), ("amplitude_m", 1)))
    assert sorted(files) == ["effects.png", "index.html", "tradeoffs.png"]
    page = str(files["index.html"])
    for said in (
        "a sweep of 40 points",
        "voltage and speed",
        "points left out of it",
        "of 40 points; rows are",
        "too &lt;wide&gt; (1 points)",
        "careful (at 2 points)",
    ):
        assert said in page, said


@pytest.mark.usefixtures("undrawn")
def test_without_wishes_nothing_is_marked_and_the_page_says_how() -> None:
    page = str(sweep_page(made(), ["sweep.csv"])["index.html"])
    assert "--less relative_friction" in page


def test_means_are_of_steps_or_of_eighths() -> None:
    found = made(64)
    voltage = varied_values(found)[0]
    x, y = means(voltage, found.column("relative_friction"))
    assert len(x) == 8
    assert y == pytest.approx(1 - x)
    assert [one.name for one in drawn_columns(found)] == ["relative_friction", "amplitude_m"]


def test_wishes_are_of_what_was_asked_once() -> None:
    assert wishes(ASKED, ["relative_friction"], ["amplitude"]) == (
        ("relative_friction", 1), ("amplitude_m", -1),
    )  # fmt: skip
    with pytest.raises(InputError, match=r"was not asked for\. Did you mean 'amplitude'"):
        wishes(ASKED, ["amplitud"], [])
    with pytest.raises(InputError, match="twice"):
        wishes(ASKED, ["amplitude"], ["amplitude_m"])


def test_nothing_is_wished_of_followed_modes_which_have_no_names_yet() -> None:
    asked = [*ASKED, ("followed.frequency_Hz", si.Unit("Hz"))]
    for name in ("followed.frequency_Hz", "followed.(8,0).frequency_Hz"):
        with pytest.raises(InputError, match="names only once they are solved"):
            wishes(asked, [name], [])
    with pytest.raises(InputError, match=r"There are: relative_friction, amplitude_m$"):
        wishes(asked, ["amplitud"], [])
