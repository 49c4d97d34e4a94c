"""A participant in a real browser, on the twin behind its port: played, stopped, answered."""

from __future__ import annotations

import sqlite3
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from playwright.sync_api import Browser

    from .conftest import RunningLab

pytestmark = [pytest.mark.chromium, pytest.mark.nightly, pytest.mark.realtime]
PATIENCE = 120_000


@pytest.mark.parametrize(("seed", "display"), [("0", "biet2008-stator"), ("2", "biet2008-plate")])
def test_a_surface_is_played_stopped_by_the_space_bar_and_answered(
    chromium: Browser, running_lab: RunningLab, seed: str, display: str
) -> None:
    context = chromium.new_context(viewport={"width": 1280, "height": 900})
    page = context.new_page()
    complaints: list[str] = []
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.goto(running_lab.link)
    page.goto(f"{running_lab.address}#study")
    page.get_by_label("design").select_option("biet2008-gratings")
    page.get_by_label("name of its file").fill("one")
    page.get_by_label("seed").fill(seed)
    page.get_by_role("button", name="Create the study").click()
    page.get_by_role("button", name="Enrol a participant").click()
    page.get_by_role("button", name="Prepare a sitting…").click()
    assert display in page.locator("tr[data-participant]").inner_text()
    page.locator("#sitting-device").select_option("twin")
    page.locator(".warning", has_text="Airborne ultrasound").wait_for(timeout=PATIENCE)
    page.locator("#acknowledged").check()
    page.get_by_role("button", name="Ready for the participant").click()
    with context.expect_page() as opened:
        page.get_by_role("button", name="Open here").click()
    person = opened.value
    person.on("pageerror", lambda error: complaints.append(str(error)))
    person.locator("#consent").check()
    person.get_by_role("button", name="Begin").click()
    person.get_by_role("heading", name="Ready").wait_for(timeout=PATIENCE)
    person.get_by_role("button", name="Next").click()
    # Real gratings first, which only lie there.
    stop = person.get_by_role("button", name="Stop (space bar)")
    done = person.get_by_role("button", name="Done")
    for _ in range(30):
        stop.or_(done).first.wait_for(timeout=PATIENCE)
        if stop.is_visible():
            break
        # A page may take no answer that comes before anybody can have read it.
        person.wait_for_timeout(500)
        left = person.locator("p.muted").last.inner_text()
        done.click()
        person.wait_for_function(
            "text => [...document.querySelectorAll('p.muted')].at(-1)?.innerText !== text", arg=left
        )
    choices = person.locator("button.choice")
    choices.first.wait_for(timeout=PATIENCE)
    assert stop.is_visible()
    person.wait_for_timeout(500)
    person.keyboard.press("Space")
    person.get_by_role("heading", name="Stopped").wait_for()
    person.get_by_role("button", name="Go on").click()
    interrupted = person.get_by_text("This one was interrupted")
    interrupted.wait_for(timeout=PATIENCE)
    person.wait_for_timeout(500)
    person.keyboard.press("1")
    interrupted.wait_for(state="hidden", timeout=PATIENCE)
    choices.first.wait_for(timeout=PATIENCE)
    person.close()
    page.get_by_role("button", name="End the sitting").click()
    page.locator("#notice", has_text="The sitting has ended.").wait_for(timeout=PATIENCE)
    assert complaints == []
    with sqlite3.connect(running_lab.folder / "studies" / "one.sqlite") as study:
        (answer,) = study.execute(
            "SELECT path_length_m, traces FROM response WHERE choice != ''"
        ).fetchall()
        passed = study.execute("SELECT passed FROM verification").fetchall()
    assert answer[0] > 0.01
    assert answer[1].count(".sqft") == 1
    assert passed == [(1,), (1,)]
