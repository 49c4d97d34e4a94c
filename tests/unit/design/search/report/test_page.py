"""The folder of a search: its page, its numbers, and plates that read back as they were."""

import csv
import json
import math
import re
from html.parser import HTMLParser
from pathlib import Path

import pytest
from tests.unit.design.search.report.made_search import made_search

import squeezefilm as sf
from squeezefilm.core.errors import InputError
from squeezefilm.design.search.found import DesignSearch
from squeezefilm.design.search.report.page import write_design

VOID = {"meta", "img", "br", "path", "use", "rect", "line"}


class Tags(HTMLParser):
    """The ids, links and open tags of a page."""

    def __init__(self) -> None:
        super().__init__()
        self.ids: list[str] = []
        self.links: list[str] = []
        self.open: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = dict(attrs)
        if "id" in given:
            self.ids.append(str(given["id"]))
        if tag == "a" and "href" in given:
            self.links.append(str(given["href"]))
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.handle_starttag(tag, attrs)
        if tag not in VOID:
            self.open.pop()

    def handle_endtag(self, tag: str) -> None:
        if tag not in VOID:
            assert self.open.pop() == tag


@pytest.fixture(scope="module")
def found() -> DesignSearch:
    return made_search()


@pytest.fixture(scope="module")
def written(found: DesignSearch, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("design")
    page = sf.write_report(found, folder)
    assert page == folder / "index.html"
    return folder


@pytest.mark.slow
def test_every_link_leads_somewhere(found: DesignSearch, written: Path) -> None:
    tags = Tags()
    tags.feed((written / "index.html").read_text(encoding="utf-8"))
    assert not tags.open
    assert len(set(tags.ids)) == len(tags.ids)
    for link in tags.links:
        assert link[1:] in tags.ids if link.startswith("#") else (written / link).is_file(), link
    # Each plate of the front is marked in the figure and leads to its row of the table.
    for member in found.front:
        assert f"#front-row-{member.name}" in tags.links


def test_marks_have_titles_that_say_what_the_plate_is(found: DesignSearch, written: Path) -> None:
    text = (written / "index.html").read_text(encoding="utf-8")
    titles = re.findall(r"<title>([0-9a-f]{10}): ([^<]*)</title>", text)
    assert {name for name, _ in titles} == {one.name for one in found.front}
    assert all("nodal lines" in said and "finest grating felt" in said for _, said in titles)


def test_numbers_and_table_say_the_same(found: DesignSearch, written: Path) -> None:
    data = json.loads((written / "result.json").read_text(encoding="utf-8"))
    assert data["chosen"] == found.chosen_name
    with (written / "front.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["name"] for row in rows] == [one["name"] for one in data["front"]]
    for row, one in zip(rows, data["front"], strict=True):
        assert float(row["relative_friction"]) == one["relative_friction"]
        assert float(row["yield"]) == one["made"]["yield"]
        assert row["neighbour"] == ("" if one["neighbour"] is None else str(one["neighbour"]))


@pytest.mark.usefixtures("undrawn")
def test_a_limit_that_nobody_could_judge_has_its_row(tmp_path: Path) -> None:
    """Its number is not there, or is none."""
    found = made_search(limits={"most_deflection": 1e-3, "most_sound_level": 90.0})
    for member in found.front:
        member.evaluated.numbers["deflection"] = math.nan  # type: ignore[index]
    text = write_design(found, tmp_path).read_text(encoding="utf-8")
    plain = re.sub(r"\s", " ", text)
    for said, limit in (
        ("deflection when pressed", "at most 1 mm"),
        ("sound level at 0.5 m", "at most 90 dB"),
    ):
        row = f"{said}</th><td>not known</td><td>{limit}</td><td>not judged</td>"
        assert row in plain


@pytest.mark.usefixtures("undrawn")
def test_the_page_of_an_empty_front_says_so(tmp_path: Path) -> None:
    page = write_design(made_search(limits={"most_temperature_rise": 20.5}), tmp_path / "new")
    text = page.read_text(encoding="utf-8")
    assert "No plate meets the requirements" in text
    assert not (tmp_path / "new" / "plates").exists()
    assert (tmp_path / "new" / "front.csv").read_text(encoding="utf-8") == "name\n"


@pytest.mark.usefixtures("undrawn")
def test_a_stopped_search_and_one_without_limits_are_written(tmp_path: Path) -> None:
    page = write_design(made_search(screened=0, solved=0, stopped=True), tmp_path)
    assert "The search was stopped" in page.read_text(encoding="utf-8")
    bare = dict.fromkeys(
        (
            "most_relative_friction",
            "most_finest_period",
            "least_squeeze_number",
            "least_frequency",
            "most_temperature_rise",
            "most_stress",
            "most_deflection",
            "least_neighbour",
        )
    )
    found = made_search(screened=40, solved=14, limits=bare)  # type: ignore[arg-type]
    assert "No limit was asked for" in write_design(found, tmp_path).read_text(encoding="utf-8")


@pytest.mark.usefixtures("undrawn")
def test_it_links_to_what_the_plate_is_made_from_where_that_is_there(
    found: DesignSearch, tmp_path: Path
) -> None:
    page = write_design(found, tmp_path, fabrication="fabrication/index.html")
    assert 'href="fabrication/index.html"' in page.read_text(encoding="utf-8")


def test_a_file_in_place_of_the_folder_is_refused(found: DesignSearch, tmp_path: Path) -> None:
    file = tmp_path / "file"
    file.write_text("mine", encoding="utf-8")
    with pytest.raises(InputError, match="is a file, not a folder"):
        write_design(found, file)
    assert file.read_text(encoding="utf-8") == "mine"


def test_its_figures_are_plotted_by_name(found: DesignSearch) -> None:
    assert "front" in sf.plot(found).get_suptitle()
    with pytest.raises(InputError, match="It has: front"):
        sf.plot(found, "pareto")
