"""The figures of a search: what they mark is where the numbers are, and nothing is outside."""

import pytest
from tests.unit.design.search.report.made_search import made_search
from tests.unit.drawn import labelled

from squeezefilm.core.kit.style import png
from squeezefilm.design.search.found import DesignSearch
from squeezefilm.design.search.report import figures

pytestmark = pytest.mark.usefixtures("figures_as_described")

KINDS = {
    "three objectives": {"shapes": 2, "objectives": 3, "screened": 300, "solved": 50},
    "empty front": {"limits": {"most_temperature_rise": 20.5}},
    "nothing": {"screened": 0, "solved": 0, "stopped": True},
    "few": {"screened": 12, "solved": 3},
}


@pytest.fixture(scope="module")
def found() -> DesignSearch:
    return made_search()


@pytest.mark.parametrize("kind", KINDS)
def test_every_figure_of_every_search_can_be_drawn(kind: str) -> None:
    one = made_search(**KINDS[kind])  # type: ignore[arg-type]
    for item in figures.FIGURES:
        figure = item.draw(one)
        # To render takes a second, and what is drawn of others is described.
        assert kind != "nothing" or png(figure, 40).startswith(b"\x89PNG"), item.key


def test_the_front_is_marked_where_it_is_and_lies_within(found: DesignSearch) -> None:
    figure = figures.front(found)
    whole, near, _ = figure.axes
    for axes in (whole, near):
        marks = {
            str(one.get_gid()).split("-")[1]: one.get_offsets()[0]
            for one in axes.collections
            if str(one.get_gid()).startswith(figures.MARKED)
        }
        assert set(marks) == {one.name for one in found.front}
        for member, row in zip(found.front, found.objectives, strict=True):
            x, y = marks[member.name]
            assert x == pytest.approx(row[0])
            assert y == pytest.approx(1e6 * row[1])
            assert axes.get_xlim()[0] < x < axes.get_xlim()[1]
            assert axes.get_ylim()[0] < y < axes.get_ylim()[1]
        square = labelled(axes)["biet2008-plate, to compare"]
        assert square.get_xdata()[0] == pytest.approx(0.62)
        chosen = labelled(axes)["the plate to build"]
        assert chosen.get_xdata()[0] == pytest.approx(marks[found.chosen_name][0])


def test_three_objectives_are_drawn_in_pairs() -> None:
    found = made_search(**KINDS["three objectives"])  # type: ignore[arg-type]
    names = [axes.get_xlabel() + axes.get_ylabel() for axes in figures.front(found).axes[:3]]
    assert len(set(names)) == 3
    assert sum("mass" in one for one in names) == 2


@pytest.mark.slow  # what it draws is described nowhere
def test_a_large_cloud_is_thinned(found: DesignSearch, monkeypatch: pytest.MonkeyPatch) -> None:
    feasible = sum(one.is_feasible for one in found.screened)
    for most, points in ((feasible, feasible), (feasible - 1, -(-feasible // 2))):
        monkeypatch.setattr(figures, "_MOST_POINTS", most)
        cloud = labelled(figures.front(found).axes[0])["screened, keeps all limits"]
        assert len(cloud.get_xdata()) == points
