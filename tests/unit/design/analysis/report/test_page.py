"""The report's two files: complete, escaped, self-contained, and whole or not there at all."""

from __future__ import annotations

import dataclasses
import json
import re
from collections.abc import Callable
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.core.kit.numbers import printable, shown
from squeezefilm.core.quantities import Unit
from squeezefilm.design.analysis.analysis import Analysis
from squeezefilm.design.analysis.report import page
from squeezefilm.design.analysis.report.figures import FIGURES
from squeezefilm.design.analysis.report.first_screen import first_screen
from squeezefilm.design.analysis.report.folds import folds
from squeezefilm.design.analysis.report.page import report_page, write_analysis

FIGURE_KEYS = tuple(item.key for item in FIGURES)
VOID = {"meta", "br", "link", "img", "hr", "input"}


class Reader(HTMLParser):
    """Elements and text of a page; fails on tags that are not closed in order."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.elements: list[tuple[str, dict[str, str | None]]] = []
        self.text = ""

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, dict(attrs)))

    def handle_endtag(self, tag: str) -> None:
        assert self.open, f"</{tag}> closes nothing"
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.text += data


def read(text: str) -> Reader:
    reader = Reader()
    reader.feed(text)
    reader.close()
    assert reader.open == []
    return reader


@pytest.fixture(scope="module")
def written(
    tmp_path_factory: pytest.TempPathFactory, analysis_of: Callable[[str], Analysis]
) -> tuple[Path, Analysis]:
    analysis = analysis_of("biet2008-plate")
    steps: list[str] = []
    path = write_analysis(analysis, tmp_path_factory.mktemp("out") / "new", steps.append)
    # Steps before these are told only where another test has not taken them already.
    assert steps[-2:] == ["figures", "writing the report"]
    return path, analysis


def test_page_is_well_formed_with_all_figures(written: tuple[Path, Analysis]) -> None:
    reader = read(written[0].read_text(encoding="utf-8"))
    figures = [attrs["id"] for tag, attrs in reader.elements if tag == "figure"]
    assert figures == [f"figure-{key}" for key in FIGURE_KEYS]
    drawings = [attrs for tag, attrs in reader.elements if tag == "svg"]
    assert len(drawings) == len(FIGURE_KEYS)
    for attrs in drawings:
        assert attrs["role"] == "img"
        assert len(attrs["aria-label"] or "") > 60


def test_the_first_screen_stands_above_folded_questions(written: tuple[Path, Analysis]) -> None:
    path, analysis = written
    text = path.read_text(encoding="utf-8")
    first = text.index("<details>")
    assert text.index("<h2>In short") < text.index('id="figure-friction"') < first
    questions = [f"<summary><h2>{fold.question}" for fold in folds(analysis)]
    places = [text.index(question) for question in questions]
    assert places == sorted(places)
    assert first < places[0]
    reader = read(text)
    words = re.sub(r"<svg.*?</svg>|<style.*?</style>|<[^>]*>", " ", text, flags=re.DOTALL)
    assert len(words.split()) <= 1500
    assert sum(tag == "figure" for tag, _ in reader.elements) <= 7
    # Everything but the verdict's model is said with --all.
    assert not any(name in words for name in ("levitation-2016", "paper2008", "timoshenko"))


def test_a_notebook_shows_the_first_screen(written: tuple[Path, Analysis]) -> None:
    analysis = written[1]
    screen = first_screen(analysis)
    said = " ".join(read(analysis._repr_html_()).text.split())
    cells = [cell for row in screen.numbers for cell in row]
    for text in (screen.sentence, *cells, *screen.doubts, screen.next_step):
        assert " ".join(printable(text).split()) in said
    # One that no verb made has the table that all results have.
    assert "prediction.voltage" in dataclasses.replace(analysis, notebook=None)._repr_html_()


def test_page_refers_to_nothing_outside(written: tuple[Path, Analysis]) -> None:
    text = written[0].read_text(encoding="utf-8")
    assert "http://" not in text
    assert "https://" not in text
    assert "@import" not in text
    reader = read(text)
    tags = {tag for tag, _ in reader.elements}
    assert not tags & {"script", "link", "img", "iframe", "object", "embed", "base"}
    for tag, attrs in reader.elements:
        assert "src" not in attrs, tag
        assert (attrs.get("href") or "#").startswith("#"), tag
        inside = "data:image/png;base64," if tag == "image" else "#"
        assert (attrs.get("xlink:href") or inside).startswith(inside), tag
    assert all(target.startswith("#") for target in re.findall(r"url\(([^)]*)\)", text))
    policy = [a for t, a in reader.elements if t == "meta" and "http-equiv" in a]
    assert policy[0]["content"] == "default-src 'none'; style-src 'unsafe-inline'; img-src data:"


@pytest.mark.slow
def test_ids_are_unique_and_references_resolve(written: tuple[Path, Analysis]) -> None:
    text = written[0].read_text(encoding="utf-8")
    ids = re.findall(r'\bid="([^"]*)"', text)
    assert len(ids) == len(set(ids))
    assert set(re.findall(r'href="#([^"]*)"', text)) <= set(ids)
    assert set(re.findall(r"url\(#([^)]*)\)", text)) <= set(ids)


def test_page_says_the_numbers_the_doubts_and_the_origin(written: tuple[Path, Analysis]) -> None:
    path, analysis = written
    words = " ".join(read(path.read_text(encoding="utf-8")).text.split())
    p = analysis.prediction
    for part in (
        "33.57 kHz",
        shown(p.vibration_amplitude, Unit("m"), 3),
        shown(p.touch.free_amplitude, Unit("m"), 3),
        f"{p.relative_friction:.2f}",
        "piezoelectric_solid_3d",
        "Temperature rise",
        "at a fixed 33.57 kHz",
    ):
        assert part in words
    for finding in analysis.verdict:
        if finding.about != "friction" and not finding.short:
            assert printable(finding.text) in words
    rows = folds(analysis)[-1].tables[-1].rows
    assert len(rows) == 15
    assert {row[-1] for row in rows} == {"assumed"}
    assert analysis.summary()["provenance"]["config_sha256"] in words
    assert "UTC" in words
    assert "contradict each other" in words


def test_json_is_strict_and_carries_curves_and_description(
    written: tuple[Path, Analysis],
) -> None:
    def refuse(constant: str) -> Any:
        raise AssertionError(f"{constant} is no JSON")

    path, analysis = written
    data = json.loads((path.parent / "result.json").read_text("utf-8"), parse_constant=refuse)
    assert data["resonance_frequency_Hz"] == analysis.prediction.mode.resonance_frequency
    curves = data["curves"]
    assert set(curves) == {
        "response",
        "friction",
        "fidelity",
        "active_area",
        "band",
    }
    assert len(curves["response"]["frequency_Hz"]) == 200
    assert data["display_description"]["actuator"]["length_m"] == 0.083


@pytest.mark.slow
def test_what_each_value_does_and_other_theories_are_there_where_asked_for(
    plate_analysis: Analysis,
) -> None:
    drawn = dict.fromkeys(FIGURE_KEYS, "<svg></svg>")

    def told(**asked: Any) -> tuple[dict[str, Any], bool, bool]:
        analysis = dataclasses.replace(plate_analysis, **asked)
        summary = analysis.summary()
        text = report_page(analysis, summary["provenance"], drawn)
        theories = "piezoelectric_solid_3d (used)" in text
        return summary, "<h2>What does each value do?" in text, theories

    summary, *shown = told()
    assert shown == [False, False]
    assert summary["sensitivities"] is None
    assert summary["other_models"] is None
    assert len(summary["felt"]["by_speed"]) == 1
    summary, *shown = told(effort="quick")
    assert shown == [True, False]
    assert summary["other_models"] is None
    rows = summary["sensitivities"]["rows"]
    summary, *shown = told(whole=True)
    assert shown == [True, True]
    assert summary["sensitivities"]["rows"] == rows
    assert summary["other_models"]
    assert len(summary["felt"]["by_speed"]) > 1


@pytest.mark.slow
def test_names_are_text_and_nothing_else(hostile_analysis: Analysis, folder: Path) -> None:
    path = write_analysis(hostile_analysis, folder)
    text = path.read_text(encoding="utf-8")
    reader = read(text)
    assert "script" not in {tag for tag, _ in reader.elements}
    assert '<script>alert("x")</script>' in reader.text
    assert "\x1b" not in text
    assert "\u202e" not in text


@pytest.mark.slow
def test_a_display_that_renders_nothing_still_has_a_report(analysis_of: Any, folder: Path) -> None:
    path = write_analysis(analysis_of("no-voltage"), folder)
    assert "Finest grating" not in path.read_text(encoding="utf-8")
    data = json.loads((folder / "result.json").read_text("utf-8"))
    assert data["curves"]["fidelity"] is None


@pytest.mark.slow
def test_page_is_the_same_for_the_same_analysis(plate_analysis: Analysis) -> None:
    stamp = plate_analysis.summary()["provenance"]
    first, second = (
        report_page(plate_analysis, stamp, page._figures(plate_analysis)) for _ in range(2)
    )
    assert first == second


def everything_in(folder: Path) -> list[str]:
    return sorted(str(item.relative_to(folder)) for item in folder.rglob("*"))


def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """A page without its figures: what is tested is the writing."""
    monkeypatch.setattr(page, "_figures", lambda *_: {})
    monkeypatch.setattr(page, "report_page", lambda *_: "<!DOCTYPE html>")


def test_a_file_in_place_of_the_folder_is_refused(plate_analysis: Analysis, tmp_path: Path) -> None:
    (tmp_path / "taken").write_text("mine")
    with pytest.raises(InputError, match="is a file, not a folder"):
        write_analysis(plate_analysis, tmp_path / "taken")
    assert (tmp_path / "taken").read_text() == "mine"
    assert everything_in(tmp_path) == ["taken"]


def test_a_file_further_up_is_refused(
    plate_analysis: Analysis, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    quick(monkeypatch)
    (tmp_path / "taken").write_text("mine")
    with pytest.raises(InputError, match="cannot write"):
        write_analysis(plate_analysis, tmp_path / "taken" / "below")
    assert everything_in(tmp_path) == ["taken"]


def test_if_the_page_cannot_be_written_the_numbers_are_not_left_alone(
    plate_analysis: Analysis, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    quick(monkeypatch)
    (tmp_path / "report.html").mkdir()
    with pytest.raises(InputError, match=r"report\.html"):
        write_analysis(plate_analysis, tmp_path)
    assert everything_in(tmp_path) == ["report.html"]


def test_if_the_page_cannot_be_written_the_old_numbers_come_back(
    plate_analysis: Analysis, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    quick(monkeypatch)
    (tmp_path / "report.html").mkdir()
    (tmp_path / "result.json").write_text("old")
    with pytest.raises(InputError):
        write_analysis(plate_analysis, tmp_path)
    assert (tmp_path / "result.json").read_text() == "old"


def test_if_the_numbers_cannot_be_written_neither_is_the_page(
    plate_analysis: Analysis, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    quick(monkeypatch)
    (tmp_path / "result.json").mkdir()
    with pytest.raises(InputError, match=r"result\.json"):
        write_analysis(plate_analysis, tmp_path)
    assert everything_in(tmp_path) == ["result.json"]


def test_a_figure_that_fails_leaves_nothing(
    plate_analysis: Analysis, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: Any) -> str:
        raise RuntimeError("no figure")

    monkeypatch.setattr(page, "_figures", fail)
    with pytest.raises(RuntimeError):
        write_analysis(plate_analysis, folder)
    assert not folder.exists()
