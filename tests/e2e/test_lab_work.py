"""What the Design area shows while it computes: older numbers grey, what is computed, a way out."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import pytest

from .test_lab_pages import SOLVED, keep

if TYPE_CHECKING:
    from playwright.sync_api import Browser, WebSocketRoute

    from .conftest import RunningLab

pytestmark = pytest.mark.chromium


@pytest.fixture(scope="module", autouse=True)
def kept_within_a_run() -> None:
    """Nothing is kept: what is looked at here is how a solve shows itself while it lasts."""


class Held:
    """Keeps the lab's answers to computations of some qualities until they are let go."""

    def __init__(self) -> None:
        self.qualities: set[str] = set()
        self.kept: list[str] = []
        self.asked: list[str] = []
        self._numbers: set[int] = set()

    def route(self, page: WebSocketRoute) -> None:
        self.page, server = page, page.connect_to_server()

        def sent(text: str | bytes) -> None:
            message = json.loads(text)
            self.asked.append(message["type"])
            if message.get("quality") in self.qualities:
                self._numbers.add(message["id"])
            server.send(text)

        def heard(text: str | bytes) -> None:
            if json.loads(text).get("id") in self._numbers:
                self.kept.append(str(text))
            else:
                page.send(text)

        page.on_message(sent)
        server.on_message(heard)

    def let_go(self) -> None:
        self.qualities, self._numbers = set(), set()
        for text in self.kept:
            self.page.send(text)


@pytest.fixture
def nothing_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    """A plate that another test has solved would be there before its progress is."""
    monkeypatch.setenv("SQUEEZEFILM_CACHE", "off")


@pytest.mark.slow
def test_numbers_of_an_older_design_are_grey_until_replaced(
    chromium: Browser, nothing_kept: None, running_lab: RunningLab
) -> None:
    held = Held()
    held.qualities = {"solved"}
    page = chromium.new_context(viewport={"width": 1280, "height": 900}).new_page()
    page.route_web_socket("**/ws", held.route)
    page.goto(running_lab.link)
    page.goto(f"{running_lab.address}#design")
    work = page.locator(".work")
    page.locator(".results:not(.older) .quality", has_text="screening:").wait_for(timeout=SOLVED)
    work.filter(has_text="solving the plate in three dimensions").wait_for(timeout=SOLVED)
    page.wait_for_function(
        "() => document.querySelector('.work progress:not([hidden])')?.value > 0"
    )
    before = page.locator(".number b").first.inner_text()

    held.qualities = {"screening", "solved"}
    thickness = page.locator("input[type=text][data-path='actuator.thickness']")
    thickness.fill("2.2 mm")
    thickness.press("Enter")
    page.locator(".results.older[aria-busy=true]").wait_for()
    page.wait_for_function(
        "() => Number(getComputedStyle(document.querySelector('.results .numbers')).opacity) < 0.5"
    )
    assert page.locator(".number b").first.inner_text() == before
    keep(page, "lab-design-computing")

    page.get_by_role("button", name="Cancel").click()
    page.locator(".quality", has_text="cancelled: the numbers are of an older design").wait_for()
    work.wait_for(state="hidden")
    assert held.asked[-1] == "cancel design"
    keep(page, "lab-design-cancelled")
    # What was on its way when it was cancelled changes nothing any more.
    held.let_go()
    assert page.locator(".results.older").count() == 1
    assert page.locator(".number b").first.inner_text() == before

    thickness.fill("2.3 mm")
    thickness.press("Enter")
    page.locator(".results:not(.older)").wait_for(timeout=SOLVED)
    assert page.locator(".number b").first.inner_text() != before
