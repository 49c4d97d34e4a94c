"""The lab's Search area in a real browser: a search watched, stopped, finished; plates opened."""

from __future__ import annotations

import re
import time
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from tests.unit.lab.searching.small import TEXT

from squeezefilm.core import presets

from .conftest import RunningLab
from .test_lab_areas import CUT_OFF
from .test_lab_pages import CONTRAST, SOLVED, keep, opened

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

pytestmark = [pytest.mark.chromium, pytest.mark.slow]

PRESET = presets.resolve("biet2008-plate", "requirements").read_text(encoding="utf-8")
# As hot as they like, so that a few designs have a front.
SMALL = TEXT.replace('"75 K"', '"200 K"').replace("most_lines = 16", "most_lines = 8")
STAGE, PLATE = ".search .stage", "circle[data-plate]"


def ask_for(page: Page, text: str, **counts: int) -> None:
    """Write requirements and counts, and start."""
    page.locator("#requirements").fill(text)
    for name, value in counts.items():
        page.locator(f"#{name}").fill(str(value))
    page.get_by_role("button", name="Start the search").click()


def test_a_search_is_watched_finished_and_its_plates_opened(
    chromium: Browser, running_lab: RunningLab
) -> None:
    page, complaints = opened(chromium, running_lab, "search")
    page.get_by_role("button", name="No tour").click()
    page.locator(".asked li", has_text="temperature rise at most 75 K").wait_for(
        state="attached", timeout=SOLVED
    )
    assert page.locator("#requirements").input_value() == PRESET
    assert page.locator("#requirements-choice").input_value() == "preset:biet2008-plate"
    ask_for(page, SMALL, screened=24, solved=4)
    # Points come while it runs: those that were screened, then plates.
    page.locator(f"{PLATE}").first.wait_for(timeout=SOLVED)
    assert page.locator(".front-view path.screened").first.get_attribute("d")
    assert page.locator(".front-view .reference text").text_content() == "biet2008-plate"
    # Another tab and a reload see the same search.
    other = page.context.new_page()
    other.goto(f"{running_lab.address}#search")
    other.locator(PLATE).first.wait_for(timeout=SOLVED)
    page.reload()
    page.locator(PLATE).first.wait_for(timeout=SOLVED)
    assert page.locator("#requirements").input_value() == SMALL
    for one in (page, other):
        one.locator(STAGE, has_text="The search is finished.").wait_for(timeout=2 * SOLVED)
        assert one.locator(f"{PLATE}.chosen").count() == 1
        assert one.locator("tr.chosen small", has_text="the one to build").count() == 1
    other.close()
    for title in ("In short", "What each limit costs", "What this rests on and nobody measured"):
        assert page.locator("h2", has_text=title).locator("..").locator("li").count() > 0
    page.locator("li", has_text=re.compile(r"\d\d designs screened, [1-4] solved")).wait_for()
    plates = page.locator(PLATE).count()
    assert page.locator("table.plates tbody tr").count() == plates > 0
    assert page.locator("table.plates td", has_text=re.compile(r"^[\d.]+ %$")).count() == plates
    for width in (360, 400, 640, 800, 960, 1280, 1920):
        page.set_viewport_size({"width": width, "height": 900})
        page.wait_for_timeout(150)
        assert page.evaluate(CUT_OFF) == [], width
        keep(page, f"lab-search-{width}")
    page.set_viewport_size({"width": 1280, "height": 900})
    for scheme in ("dark", "light"):
        page.emulate_media(color_scheme=scheme)  # type: ignore[arg-type]
        assert page.evaluate(CONTRAST) == []
    # By keys: the points are one stop of Tab, arrows go on, Enter opens.
    page.locator(f"{PLATE}[tabindex='0']").focus()
    first = page.evaluate("document.activeElement.dataset.plate")
    for _ in range(plates):
        page.keyboard.press("ArrowRight")
    assert page.evaluate("document.activeElement.dataset.plate") == first
    assert page.locator("h2", has_text=f"Plate {first}").is_visible()
    assert "opens in Design" in page.locator(f"{PLATE}:focus").get_attribute("aria-label")
    page.keyboard.press("Enter")
    page.locator(".quality", has_text="solved:").wait_for(timeout=SOLVED)
    assert page.locator("input[data-path='name']").input_value() == f"biet2008-plate-{first}"
    numbers = page.locator(".number b").first.inner_text()
    page.goto(f"{running_lab.address}#search")
    row = page.locator(f"tr[data-plate='{first}']")
    row.wait_for()
    # Design solves the plate that the search solved: the same resonance to three digits.
    assert (
        f"{float(numbers.split()[0]):.3g}"
        == row.locator("td", has_text="kHz").inner_text().split()[0]
    )
    # By the mouse: a row opens like a point does.
    row.locator("td").first.click()
    page.locator("#area[data-area=design] input[data-path='name']").wait_for(state="attached")
    assert complaints == []


def test_a_search_is_stopped_and_goes_on_from_what_is_known(
    chromium: Browser, running_lab: RunningLab
) -> None:
    page, complaints = opened(chromium, running_lab, "search")
    page.locator(".asked li").first.wait_for(state="attached", timeout=SOLVED)
    ask_for(page, SMALL, screened=3000, solved=5)
    page.locator(".far", has_text=re.compile(r"^[1-9]\d* of 3000 designs")).wait_for(timeout=SOLVED)
    assert page.get_by_role("button", name="Start the search").is_disabled()
    page.locator(".search p", has_text=re.compile("about .* left of this step")).wait_for(
        timeout=SOLVED
    )
    page.get_by_role("button", name="Stop").click()
    page.locator(STAGE, has_text="The search is stopped.").wait_for(timeout=SOLVED)
    assert page.get_by_role("button", name="Start the search").is_enabled()
    assert "found until then" in page.locator(".search .results").inner_text()
    assert page.get_by_role("button", name="Stop").is_hidden()
    page.goto(f"{running_lab.address}#help")
    page.goto(f"{running_lab.address}#search")
    page.locator(STAGE, has_text="The search is stopped.").wait_for()
    # What was screened is asked for no second time.
    (kept,) = running_lab.folder.glob("searches/*/designs.jsonl")
    assert len(kept.read_text().splitlines()) > 1
    (text,) = running_lab.folder.glob("searches/*/requirements.toml")
    assert text.read_text(encoding="utf-8") == SMALL
    page.reload()
    page.locator("#requirements-choice").select_option(f"file:{text.parent.name}")
    page.wait_for_function(
        "text => document.querySelector('#requirements').value === text", arg=SMALL
    )
    assert complaints == []


def test_what_is_wrong_is_said_with_its_line_before_anything_is_computed(
    chromium: Browser, shared_lab: RunningLab
) -> None:
    page, complaints = opened(chromium, shared_lab, "search")
    page.locator(".asked li").first.wait_for(state="attached", timeout=SOLVED)
    text = page.locator("#requirements")
    text.fill(TEXT.replace('length = "73 mm"', 'length = "73"'))
    page.locator("#requirements-error", has_text="line 11: workspace.length").wait_for()
    page.get_by_role("button", name="Go to line 11").click()
    picked = "e => e.value.slice(e.selectionStart, e.selectionEnd)"
    assert text.evaluate(picked) == 'length = "73"'
    keep(page, "lab-search-wrong")
    start = page.get_by_role("button", name="Start the search")
    start.click()
    page.locator(".error:visible", has_text="line 11").nth(1).wait_for()
    text.fill('<img src=x onerror="window.bad = 1">')
    page.locator("#requirements-error", has_text="line 1").wait_for()
    text.fill(TEXT)
    page.locator("#requirements-error").wait_for(state="hidden")
    for wrong in ("", "0", "1.5", "2000000"):
        page.locator("#screened").fill(wrong)
        start.click()
        page.locator(".error", has_text="designs screened: a whole number from 1").wait_for()
    # What nobody can build is an answer of the search itself.
    page.locator("#screened").fill("3")
    impossible = TEXT.replace("least_lines = 5", "least_lines = 60")
    ask_for(page, impossible.replace("most_lines = 16", "most_lines = 60"), screened=3)
    page.locator(".search .results .error", has_text="none of the screened designs").wait_for(
        timeout=SOLVED
    )
    assert page.locator(STAGE).inner_text() == "The search failed."
    keep(page, "lab-search-failed")
    assert page.evaluate("window.bad") is None
    assert complaints == []


FRONT = """async () => {
  const { FrontView } = await import("/static/front_view.js");
  const opened = [], pointed = [], all = (what) => [...document.querySelectorAll(what)];
  const view = new FrontView({
    open: (name) => opened.push(name), point: (name) => pointed.push(name),
  });
  document.getElementById("area").replaceChildren(view.box);
  const said = (unit, said) => ({ said, unit });
  const plate = (name, ...objectives) => ({ name, objectives, words: objectives.map(String) });
  const found = (...plates) => ({
    objectives: [said("", "friction"), said("m", "period"), said("kg", "mass")],
    screened: [[0.2, null, 0.06], [0.3, 4e-4, 0.07]], plates, reference: null, chosen: "b",
  });
  const b = plate("b", 0.3, 4e-4, 0.04);
  view.set(found(plate("a", 0.2, 5e-4, 0.05), b, plate("c", 0.4, null, 0.03)));
  const labels = () => all(".front-view text.label").map((one) => one.textContent);
  const names = () => all("circle[data-plate]").map((one) => one.dataset.plate);
  const dots = () => all("path.screened")[0].getAttribute("d").split("M").length - 1;
  const first = [labels(), names(), dots()];
  const [, up] = all(".front-view select");
  up.value = "2";
  up.dispatchEvent(new Event("change"));
  const second = [labels(), names(), dots()];
  all("circle[data-plate=b]")[0].focus();
  const key = (key) =>
    document.activeElement.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true }));
  key("ArrowRight");
  key("Enter");
  key("ArrowLeft");
  key(" ");
  // The plate that has the focus keeps it while others come and go.
  view.set(found(plate("d", 0.1, 6e-4, 0.06), b));
  const kept = document.activeElement.getAttribute("aria-label");
  view.set(found());
  view.close();
  return { first, second, opened, pointed, kept, left: names() };
}"""


def test_three_objectives_are_drawn_two_at_a_time(
    chromium: Browser, shared_lab: RunningLab
) -> None:
    page, complaints = opened(chromium, shared_lab, "help")
    page.get_by_role("heading", name="Quantities").wait_for()
    assert page.evaluate(FRONT) == {
        # What is not known has no place.
        "first": [["friction", "period (µm)"], ["a", "b"], 1],
        "second": [["friction", "mass (g)"], ["a", "b", "c"], 2],
        "opened": ["c", "b"],
        "pointed": ["b", "c", "b"],
        "kept": "plate b, chosen: friction 0.3, period 0.0004, mass 0.04; opens in Design",
        "left": [],
    }
    assert complaints == []


def _processes_of(pid: int) -> set[int]:
    """A process's children and theirs, by Linux's list."""
    found: set[int] = set()
    for task in Path(f"/proc/{pid}/task").glob("*/children"):
        for child in map(int, task.read_text().split()):
            found |= {child} | _processes_of(child)
    return found


@pytest.mark.skipif(not Path("/proc/self/task").is_dir(), reason="lists processes as Linux does")
@pytest.mark.parametrize("how", ["stop", "kill"])
def test_the_end_of_the_lab_is_the_end_of_its_search(
    chromium: Browser, running_lab: RunningLab, how: str
) -> None:
    page, _ = opened(chromium, running_lab, "search")
    page.locator(".asked li").first.wait_for(state="attached", timeout=SOLVED)
    ask_for(page, SMALL, screened=3000, solved=5, jobs=2)
    page.locator(".far", has_text=re.compile(r"^[1-9]\d* of 3000 designs")).wait_for(timeout=SOLVED)
    processes = _processes_of(running_lab.process.pid)
    # Those that compute for Design, the search, and those that it has answer.
    assert len(processes) >= 3
    if how == "stop":
        assert running_lab.stop() == 0
    else:
        running_lab.kill()
    for _ in range(200):
        left = {pid for pid in processes if _lives(pid)}
        if not left:
            break
        time.sleep(0.1)
    assert left == set()
    page.locator("#connection.lost").wait_for()


def _lives(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except OSError:
        return False
