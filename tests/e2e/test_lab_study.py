"""A study in the lab, in a real browser: from its plan to its export, and everything in between
that can go wrong at a station."""

from __future__ import annotations

import dataclasses
import json
import re
import sqlite3
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from squeezefilm.core.quantities import Second
from squeezefilm.study.design.study_design import load_design
from squeezefilm.study.record.store import StudyStore

from .test_lab_pages import AREAS, CONTRAST, SOLVED, keep, opened

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Locator, Page

    from .conftest import RunningLab, Start

pytestmark = [pytest.mark.chromium, pytest.mark.slow]

HOSTILE = '<img src=x onerror="document.title=1">'
DONE = 15_000
IN_PLACE = "The surface is in place"


AT_ONCE = """() => {
  const watch = new MutationObserver(() => {
    if (!document.querySelector(".choice")) return;
    watch.disconnect();
    window.pressed = "1";
    document.dispatchEvent(new KeyboardEvent("keydown", { key: "1", bubbles: true }));
  });
  watch.observe(document.body, { childList: true, subtree: true });
}"""


class Frames:
    """What a page's websockets said, both ways."""

    def __init__(self, page: Page) -> None:
        self.received: list[str] = []
        self.sent: list[str] = []
        page.on("websocket", self._watch)

    def _watch(self, socket: Any) -> None:
        socket.on("framereceived", lambda text: self.received.append(str(text)))
        socket.on("framesent", lambda text: self.sent.append(str(text)))


def small_study(folder: Path, name: str = "small", pause: Second = 1.0, **fields: Any) -> Path:
    """A study's file with few trials and short breaks, as the experimenter's page would make it."""
    design = dataclasses.replace(
        load_design("biet2008-gratings"),
        **{
            "displays": ("biet2008-plate",), "familiarisation": 1, "practice": 2, "blocks": 2,
            "repetitions": 1, "break_between_blocks": pause, "provenance": {}, **fields,
        },
    )  # fmt: skip
    path = folder / "studies" / f"{name}.sqlite"
    path.parent.mkdir(parents=True, exist_ok=True)
    StudyStore.create(path, design, 7).close()
    return path


def rows(path: Path, query: str) -> list[tuple[Any, ...]]:
    with sqlite3.connect(f"file:{path}?mode=ro", uri=True) as found:
        return found.execute(query).fetchall()


def answered(path: Path) -> int:
    """Answers on the disk; every one to another trial, which the schema alone does not say."""
    count = rows(path, "SELECT count(*), count(DISTINCT trial) FROM response")[0]
    assert count[0] == count[1]
    return int(count[0])


def prepared(page: Page, participant: int = 0) -> Locator:
    """The row of a newly enrolled participant with a sitting ready."""
    page.get_by_role("button", name="Enrol a participant").click()
    row = page.locator("tr[data-participant]").nth(participant)
    row.get_by_role("button", name="Prepare a sitting").click()
    page.get_by_role("button", name="Ready for the participant").click()
    row.get_by_role("button", name="Open here").wait_for()
    return row


def chosen(page: Page, name: str) -> None:
    page.locator("ul.plain").get_by_role("button", name=name, exact=True).click()
    page.locator("h2", has_text=name).wait_for()


def link_of(page: Page, row: Locator) -> str:
    """A one-time link for the row's sitting."""
    row.get_by_role("button", name="Link for another station").click()
    pseudonym = row.locator("code").inner_text()
    text = page.locator("#notice", has_text=f"For {pseudonym}, once").inner_text()
    found = re.search(r"http\S+token=[\w-]+", text)
    assert found
    return found[0]


def station(page: Page, row: Locator, browser: Browser, **options: Any) -> Page:
    """A participant's page in another browser, by the one-time link."""
    other = browser.new_context(
        **{"viewport": {"width": 1280, "height": 800}, **options}
    ).new_page()
    other.goto(link_of(page, row))
    return other


def consented(page: Page) -> None:
    page.get_by_label("I have read this and consent.").check()
    page.get_by_role("button", name="Begin").click()
    page.locator("h2", has_text="Ready").wait_for()


def step(page: Page, way: str = "keys", answer: int = 0) -> str:
    """Do what the page asks next, once, after it can be done; what that was."""
    sheet = page.locator(".sheet")
    text = sheet.inner_text()
    if page.locator(".choice").count():
        # Sooner than a finger can mean it, an answer is not taken.
        page.wait_for_timeout(260)
        if way == "keys":
            page.keyboard.press(str(answer + 1))
        elif way == "touch":
            page.locator(".choice").nth(answer).tap()
        else:
            page.locator(".choice").nth(answer).click()
        kind = "practice" if "Practice" in text else "answer"
    elif page.get_by_role("button", name="Please rest").count():
        page.wait_for_timeout(200)
        return "rest"
    else:
        button = page.locator(".sheet button.main")
        if not button.count():
            return "end"
        kind = button.inner_text()
        page.wait_for_timeout(260)
        if way == "keys":
            page.keyboard.press("Enter")
        elif way == "touch":
            button.tap()
        else:
            button.click()
    page.wait_for_function(
        """text => { const sheet = document.querySelector(".sheet");
          return sheet.innerText !== text && !sheet.querySelector(".choice:disabled"); }""",
        arg=text,
        timeout=DONE,
    )
    if page.get_by_role("button", name=IN_PLACE).count():
        # The experimenter's hand is no step of the participant's.
        step(page, way)
    return kind


def run_to(page: Page, count: int, way: str = "keys") -> list[str]:
    """Steps until so many main answers were given, or the end."""
    done: list[str] = []
    while done.count("answer") < count:
        done.append(step(page, way, len(done) % 5))
        if done[-1] == "end":
            break
    return done


def test_a_study_from_its_plan_to_its_export(chromium: Browser, running_lab: RunningLab) -> None:
    page, complaints = opened(chromium, running_lab, "study")
    page.get_by_text("time, with breaks").wait_for()
    keep(page, "lab-study-plan-light-1280")
    page.get_by_label("name of its file").fill("../away")
    page.get_by_role("button", name="Create the study").click()
    page.locator(".error", has_text="no name for a file").wait_for()
    page.get_by_label("name of its file").fill("gratings")
    page.get_by_label("seed of all orders").fill("11")
    page.get_by_role("button", name="Create the study").click()
    page.get_by_role("button", name="Enrol a participant").click()
    page.get_by_role("button", name="Prepare a sitting").click()
    page.get_by_label("temperature").fill("warm")
    page.get_by_role("button", name="Ready for the participant").click()
    page.locator(".error", has_text="'warm' is no number").wait_for()
    page.get_by_label("temperature").fill("22,5")
    page.get_by_label("room").fill("quiet office")
    keep(page, "lab-study-prepare-light-1280")
    page.get_by_role("button", name="Ready for the participant").click()
    with page.context.expect_page() as opening:
        page.get_by_role("button", name="Open here").click()
    person = opening.value
    keep(person, "lab-participant-consent")
    assert person.get_by_role("button", name="Begin").is_disabled()
    consented(person)
    done = run_to(person, 3)
    assert done.count("Done") == 10  # Every grating is felt twice, and none is asked for.
    keep(person, "lab-participant-trial")
    # The experimenter sees it without asking.
    page.locator(".count", has_text="13 of 120").wait_for()
    # By hand, somebody has to know what to present; the participant's page does not.
    now = page.locator(".byhand strong").inner_text()
    newest = "SELECT trial FROM presentation ORDER BY presented_utc DESC"
    run = f"SELECT stimuli FROM trial WHERE uuid = ({newest})"
    assert [now] == json.loads(rows(running_lab.folder / "studies" / "gratings.sqlite", run)[0][0])
    keep(page, "lab-study-progress-light-1280")
    page.get_by_role("button", name="End the sitting").click()
    page.locator("#notice", has_text="The sitting has ended").wait_for()
    person.locator("h2", has_text="This sitting has ended").wait_for()
    page.goto(f"{running_lab.address}#results")
    page.get_by_role("button", name="CSV").click()
    page.locator("#notice", has_text="Exported to").wait_for(timeout=DONE)
    said = re.search(r"Exported to (\S+) in", page.locator("#notice").inner_text())
    assert said
    files = [one for one in (running_lab.folder / said[1]).rglob("*.csv") if one.stat().st_size]
    assert files
    path = running_lab.folder / "studies" / "gratings.sqlite"
    assert answered(path) == 13
    conditions = json.loads(rows(path, "SELECT conditions FROM session")[0][0])
    assert conditions["room"] == "quiet office"
    assert "295.65" in json.dumps(conditions)
    assert complaints == []


def test_a_whole_sitting_by_keys_with_practice_and_rest(
    chromium: Browser, start_lab: Start, tmp_path: Path
) -> None:
    path = small_study(tmp_path)
    lab = start_lab(tmp_path)
    page, complaints = opened(chromium, lab, "study")
    chosen(page, "small")
    row = prepared(page)
    person = station(page, row, chromium)
    frames = Frames(person)
    person.reload()
    # Without a mouse from the first page on.
    person.locator("#consent").wait_for()
    person.keyboard.press("Tab")
    person.keyboard.press("Space")
    person.keyboard.press("Tab")
    person.keyboard.press("Enter")
    person.locator("h2", has_text="Ready").wait_for()
    done = run_to(person, 99)
    assert done[-1] == "end"
    assert person.locator("h2").inner_text() == "Thank you"
    assert done.count("Done") == 5
    assert done.count("practice") == 2
    assert done.count("answer") == 10
    assert "rest" in done
    planned = rows(path, "SELECT count(*) FROM trial")[0][0]
    assert answered(path) == planned == 17
    times = [one[0] for one in rows(path, "SELECT response_time_s FROM response")]
    assert all(0 <= one < 60 for one in times)
    # What is right is in no message about a trial that counts.
    truth = dict(rows(path, "SELECT uuid, answer FROM trial WHERE phase = 'main'"))
    trials = [m for m in map(json.loads, frames.received) if m.get("state") == "trial"]
    seen = [one for one in trials if one["token"] in truth]
    assert len(seen) >= 10
    for one in seen:
        assert set(one) == {
            "id", "type", "state", "token", "phase", "question", "alternatives", "numeric",
            "surfaces", "plays", "by_hand", "named", "pause_s", "remaining", "interrupted",
        }  # fmt: skip
        assert one["named"] == ""
        # The alternatives stand in the same order whatever is right.
        assert one["alternatives"] == seen[0]["alternatives"]
        rest = {key: value for key, value in one.items() if key != "alternatives"}
        assert truth[one["token"]] not in json.dumps(rest)
    told = [m for m in map(json.loads, frames.received) if m.get("type") == "acknowledged"]
    assert sum(one["right"] is not None for one in told) == 2
    assert sum(one["correct"] is not None for one in told) == 2
    page.locator(".count", has_text="17 of 17").wait_for()
    assert complaints == []


def test_by_hand_the_clock_starts_when_the_experimenter_says_so(
    chromium: Browser, start_lab: Start, tmp_path: Path
) -> None:
    """Two surfaces a trial; each swap takes half a second, which no response time holds."""
    swap = 500
    path = tmp_path / "studies" / "jnd.sqlite"
    path.parent.mkdir(parents=True)
    StudyStore.create(path, dataclasses.replace(load_design("friction-jnd"), practice=0), 3).close()
    page, complaints = opened(chromium, start_lab(tmp_path), "study")
    chosen(page, "jnd")
    person = station(page, prepared(page), chromium)
    consented(person)
    person.keyboard.press("Enter")
    ready = page.get_by_role("button", name="Surface is in place")
    presented = "SELECT count(*) FROM presentation"
    for trial in range(2):
        for number, which in enumerate(("first", "second")):
            person.get_by_text(f"The experimenter puts the {which} surface in place").wait_for()
            assert person.locator(".choice").count() == 0
            ready.wait_for()
            assert rows(path, presented)[0][0] == trial + number
            if trial == number == 0:
                keep(person, "lab-participant-by-hand")
                keep(page, "lab-study-by-hand")
                ready.focus()
            # The focus comes back to the button at each surface: Enter is all that it takes.
            page.wait_for_function("document.activeElement.textContent === 'Surface is in place'")
            page.wait_for_timeout(swap)
            page.keyboard.press("Enter")
            person.locator("h2", has_text=f"Feel the {which} surface").wait_for()
            assert rows(path, presented)[0][0] == trial + 1
            person.wait_for_timeout(260)
            person.keyboard.press("Enter")
        person.locator(".choice").first.wait_for()
        person.wait_for_timeout(300)
        person.keyboard.press("1")
        page.locator(".count", has_text=f"{trial + 1} of").wait_for()
    took = "SELECT r.response_time_s, r.started_utc, p.presented_utc FROM response r "
    found = rows(path, took + "JOIN presentation p ON p.trial = r.trial")
    assert len(found) == 2
    # The trial began when its first surface was in place, and two swaps are in neither time.
    assert all(began == shown for _, began, shown in found)
    lasted = "SELECT ended_monotonic_s - started_monotonic_s, response_time_s FROM response"
    assert all(whole == pytest.approx(time) for whole, time in rows(path, lasted))
    assert complaints == []


def test_two_stations_at_once_by_mouse_and_touch(
    chromium: Browser, start_lab: Start, tmp_path: Path
) -> None:
    path = small_study(tmp_path, familiarisation=0, practice=0, blocks=1, pause=0.0)
    lab = start_lab(tmp_path)
    page, complaints = opened(chromium, lab, "study")
    chosen(page, "small")
    people = [
        station(page, prepared(page, 0), chromium),
        station(page, prepared(page, 1), chromium, has_touch=True),
    ]
    ways = ["mouse", "touch"]
    # A sitting that begins draws the table anew: the focus stays where it was.
    page.get_by_role("button", name="Enrol a participant").focus()
    for person in people:
        consented(person)
    page.get_by_text("running").nth(1).wait_for()
    ends = [False, False]
    for turn in range(80):
        for k, person in enumerate(people):
            ends[k] = ends[k] or step(person, ways[k], turn % 5) == "end"
        if all(ends):
            break
        # Numbers come in, and what the experimenter is on stays.
        if turn < 4:
            assert page.evaluate("document.activeElement.innerText") == "Enrol a participant"
    assert all(ends)
    keep(page, "lab-study-two-stations")
    counts = rows(
        path,
        "SELECT t.participant, count(*), count(DISTINCT r.session) FROM response r "
        "JOIN trial t ON t.uuid = r.trial GROUP BY t.participant",
    )
    assert [one[1:] for one in counts] == [(5, 1), (5, 1)]
    assert answered(path) == 10
    # A station's link has the participant's role, in its browser and for good.
    for person in people:
        assert person.goto(lab.address).status == 403  # type: ignore[union-attr]
    assert complaints == []


def test_a_link_opened_in_the_own_browser_leaves_the_experimenter_in(
    chromium: Browser, running_lab: RunningLab
) -> None:
    small_study(running_lab.folder)
    page, _ = opened(chromium, running_lab, "study")
    chosen(page, "small")
    link = link_of(page, prepared(page))
    other = page.context.new_page()
    other.goto(link)
    other.get_by_role("button", name="Begin").wait_for()
    again = page.context.new_page().goto(running_lab.address)
    assert again is not None
    assert again.status == 200
    used = chromium.new_context().new_page().goto(link)
    assert used is not None
    assert used.status == 401


def test_reload_second_tab_and_held_keys(chromium: Browser, running_lab: RunningLab) -> None:
    path = small_study(running_lab.folder, familiarisation=0, practice=0, pause=0.0)
    page, _ = opened(chromium, running_lab, "study")
    chosen(page, "small")
    person = station(page, prepared(page), chromium)
    consented(person)
    step(person)
    for _ in range(3):
        person.reload()
        person.locator("h2", has_text="Ready").wait_for()
    second = person.context.new_page()
    second.goto(person.url)
    second.locator("h2", has_text="Open in another tab").wait_for()
    assert second.locator(".sheet button").count() == 0
    keep(second, "lab-participant-second-tab")
    step(person)
    person.get_by_text("This one was interrupted").wait_for()
    remaining = person.get_by_text("to go").inner_text()
    # Too soon after it came is the second tap of a double tap; a held key repeats.
    person.reload()
    person.evaluate(AT_ONCE)
    step(person)
    person.wait_for_timeout(300)
    assert person.evaluate("pressed") == "1"
    assert person.get_by_text("to go").inner_text() == remaining
    for change in ({"repeat": True}, {"ctrlKey": True}):
        person.evaluate(
            "change => document.dispatchEvent(new KeyboardEvent('keydown', "
            "{key: '1', bubbles: true, ...change}))",
            change,
        )
    person.wait_for_timeout(300)
    assert answered(path) == 0
    step(person)
    assert answered(path) == 1
    # The other tab takes over once this one is closed.
    person.close()
    second.reload()
    second.locator("h2", has_text="Ready").wait_for()


@pytest.mark.parametrize(
    "moment", ["between", pytest.param("answering", marks=pytest.mark.nightly)]
)
def test_a_killed_server_loses_and_doubles_nothing(
    chromium: Browser, start_lab: Start, tmp_path: Path, moment: str
) -> None:
    path = small_study(tmp_path, familiarisation=0, practice=0, pause=0.0)
    lab = start_lab(tmp_path)
    page, _ = opened(chromium, lab, "study")
    chosen(page, "small")
    person = station(page, prepared(page), chromium)
    consented(person)
    step(person)
    step(person)
    trial = person.locator(".sheet").inner_text()
    if moment == "answering":
        # The answer is on its way while the server dies: whether it came to the disk is open.
        person.wait_for_timeout(260)
        person.evaluate(
            """() => setTimeout(() => document.dispatchEvent(
              new KeyboardEvent("keydown", {key: "2", bubbles: true})), 5)"""
        )
    lab.kill()
    person.locator("#connection", has_text="The connection is lost").wait_for()
    page.locator("#connection", has_text="the lab is not running").wait_for()
    assert person.locator("button:enabled").count() == 0
    person.keyboard.press("3")
    if moment == "between":
        keep(person, "lab-participant-connection-lost")
    before = answered(path)
    start_lab(tmp_path, lab.port)
    # By itself: nobody reloads anything.
    person.locator("h2", has_text="Ready").wait_for(timeout=DONE)
    page.locator("#connection", has_text="connected").wait_for(timeout=DONE)
    if moment == "between":
        assert before == answered(path) == 1
        step(person)
        assert person.locator(".sheet h2").inner_text() in trial
        person.get_by_text("This one was interrupted").wait_for()
    else:
        assert before in (1, 2)
        assert answered(path) == 2
    run_to(person, 1)
    count = answered(path)
    assert count == (2 if moment == "between" else 3)
    assert rows(path, "SELECT max(number) - min(number) + 1 FROM response JOIN trial "
                "ON trial.uuid = trial")[0][0] == count  # fmt: skip
    page.locator(".count", has_text=f"{count} of 10").wait_for()


@pytest.mark.nightly
def test_what_a_killed_server_computed_ends_with_it(
    chromium: Browser, start_lab: Start, tmp_path: Path
) -> None:
    lab = start_lab(tmp_path)
    page, _ = opened(chromium, lab, "design")
    page.locator(".quality", has_text=re.compile("screening|solved")).wait_for(timeout=SOLVED)
    task = Path(f"/proc/{lab.process.pid}/task/{lab.process.pid}/children")
    children = [Path("/proc") / one for one in task.read_text().split()]
    assert children
    lab.kill()
    for _ in range(100):
        if not any(one.exists() for one in children):
            break
        page.wait_for_timeout(100)
    assert not any(one.exists() for one in children)


@pytest.mark.nightly
def test_servers_killed_at_every_moment_of_an_answer(
    chromium: Browser, start_lab: Start, tmp_path: Path
) -> None:
    path = small_study(tmp_path, familiarisation=0, practice=0, pause=0.0, blocks=4, repetitions=2)
    lab = start_lab(tmp_path)
    page, _ = opened(chromium, lab, "study")
    chosen(page, "small")
    person = station(page, prepared(page), chromium)
    consented(person)
    for delay in range(0, 30, 2):
        step(person)
        person.wait_for_timeout(260)
        before = answered(path)
        person.keyboard.press("4")
        person.wait_for_timeout(delay)
        lab.kill()
        lab = start_lab(tmp_path, lab.port)
        person.locator("#connection:not(.lost)").wait_for(timeout=DONE, state="attached")
        person.locator("h2", has_text="Ready").wait_for(timeout=DONE)
        assert answered(path) == before + 1
    run_to(person, 99)
    assert answered(path) == rows(path, "SELECT count(*) FROM trial")[0][0] == 40


def test_an_answer_that_could_not_be_written_is_handed_in_again(
    chromium: Browser, running_lab: RunningLab
) -> None:
    path = small_study(running_lab.folder, familiarisation=0, practice=0, pause=0.0)
    page, _ = opened(chromium, running_lab, "study")
    chosen(page, "small")
    link = link_of(page, prepared(page))
    person = chromium.new_context().new_page()
    refused: list[str] = []

    def between(socket: Any) -> None:
        server = socket.connect_to_server()

        def sent(text: str) -> None:
            asked = json.loads(text)
            if asked["type"] != "respond" or refused:
                server.send(text)
                return
            # What the server says where the disk is full, before anything was written.
            refused.append(text)
            said = {"id": asked["id"], "type": "error", "message": "no room", "again": True}
            socket.send(json.dumps(said))

        socket.on_message(sent)

    person.route_web_socket(re.compile("/ws/participant"), between)
    person.goto(link)
    consented(person)
    step(person)
    step(person, answer=2)
    person.get_by_text("no room").wait_for()
    assert answered(path) == 0
    person.keyboard.press("Enter")
    person.locator("h2", has_text="Ready").wait_for()
    given = json.loads(refused[0])
    assert rows(path, "SELECT trial, choice FROM response") == [(given["token"], given["choice"])]


@pytest.mark.nightly
def test_a_session_that_is_over_is_said_in_words(
    chromium: Browser, start_lab: Start, tmp_path: Path
) -> None:
    lab = start_lab(tmp_path)
    page, _ = opened(chromium, lab, "help")
    page.locator("#connection", has_text="connected").wait_for()
    assert lab.stop() == 0
    page.locator("#connection", has_text="not running").wait_for()
    start_lab(tmp_path, lab.port)
    page.locator("#connection", has_text="open the link").wait_for(timeout=DONE)


FOREIGN = """async (lab) => {
  const tried = async (work) => { try { return await work(); } catch { return "refused"; } };
  const get = (path, options) => tried(async () =>
    (await fetch(lab + path, { credentials: "include", ...options })).text());
  const open = (path) => new Promise((resolve) => {
    const socket = new WebSocket(lab.replace("http", "ws") + path);
    socket.onopen = () => resolve("open");
    socket.onerror = () => resolve("refused");
  });
  const load = (name, attributes) => new Promise((resolve) => {
    const made = Object.assign(document.createElement(name), attributes);
    made.onload = () => resolve(name === "iframe" && !made.contentDocument ? "refused" : "loaded");
    made.onerror = () => resolve("refused");
    document.body.append(made);
  });
  const post = { method: "POST" };
  return {
    page: await get(""), file: await get("static/lab.js"), post: await get("another-station", post),
    opaque: (await tried(() => fetch(lab + "another-station",
      { ...post, mode: "no-cors", credentials: "include" }))).type ?? "refused",
    socket: await open("ws"), participant: await open("ws/participant"),
    script: await load("script", { src: lab + "static/numbers.js", type: "module" }),
    image: await load("img", { src: lab + "static/icon.svg" }),
    frame: await load("iframe", { src: lab }),
  };
}"""


@contextmanager
def foreign_site() -> Iterator[str]:
    """A website on another port, which is another origin but the same site."""

    class Page(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            self.send_response(200)
            self.send_header("content-type", "text/html")
            self.end_headers()
            self.wfile.write(b"<!doctype html><title>foreign</title>")

        def log_message(self, *_: object) -> None:
            pass

    server = ThreadingHTTPServer(("127.0.0.1", 0), Page)
    thread = threading.Thread(target=server.serve_forever)
    thread.start()
    yield f"http://127.0.0.1:{server.server_port}/"
    server.shutdown()
    thread.join()
    server.server_close()


def test_a_page_of_another_origin_gets_nothing(chromium: Browser, shared_lab: RunningLab) -> None:
    page, _ = opened(chromium, shared_lab, "help")
    page.get_by_text("relative friction, µ′/µ").wait_for()
    with foreign_site() as foreign:
        other = page.context.new_page()  # The same browser: it has the experimenter's cookie.
        other.goto(foreign)
        found = other.evaluate(
            FOREIGN,
            shared_lab.address,
        )
        # An opaque answer cannot be read; that the request was refused is tested at the guard.
        assert found.pop("opaque") in ("opaque", "refused")
        assert found == dict.fromkeys(found, "refused")
        assert other.frames[-1].url != shared_lab.address


def test_a_stored_script_is_shown_as_text(chromium: Browser, running_lab: RunningLab) -> None:
    design = load_design("biet2008-gratings")

    def hostile(these: tuple[Any, ...]) -> tuple[Any, ...]:
        return tuple(dataclasses.replace(one, name=f"{HOSTILE}{k}") for k, one in enumerate(these))

    small_study(
        running_lab.folder, "hostile", familiarisation=0, practice=0, title=HOSTILE,
        question=HOSTILE, note=HOSTILE,
        stimuli=hostile(design.stimuli), alternatives=hostile(design.alternatives),
    )  # fmt: skip
    page, complaints = opened(chromium, running_lab, "study")
    page.locator("ul.plain").get_by_role("button", name="hostile").click()
    page.get_by_text("<img src=x").first.wait_for()
    page.get_by_role("button", name="Enrol a participant").click()
    page.get_by_role("button", name="Prepare a sitting").click()
    page.get_by_label("note, without names").fill(HOSTILE)
    page.get_by_label("consent, as the participant reads it").fill(HOSTILE)
    page.get_by_role("button", name="Ready for the participant").click()
    with page.context.expect_page() as opening:
        page.get_by_role("button", name="Open here").click()
    person = opening.value
    person.get_by_text("<img src=x").first.wait_for()
    consented(person)
    step(person)
    person.get_by_text("<img src=x").first.wait_for()
    page.goto(f"{running_lab.address}#results")
    page.get_by_role("button", name="CSV").wait_for()
    for one in (page, person):
        assert one.title() != "1"
        assert one.locator("#area img[src=x], #area script").count() == 0
    assert complaints == []


# What Design and Feel compute takes seconds; by day they are looked at in test_lab_pages.
@pytest.mark.parametrize(
    ("colours", "areas"),
    [
        ("light", ("search", "device", "study", "results", "help")),
        *(
            pytest.param(
                one,
                AREAS,
                marks=pytest.mark.nightly,
            )
            for one in ("light", "dark")
        ),
    ],
)
def test_every_area_has_contrast_and_fits_its_width(
    chromium: Browser, running_lab: RunningLab, colours: Any, areas: tuple[str, ...]
) -> None:
    small_study(running_lab.folder, familiarisation=0, practice=0, pause=0.0)
    page, complaints = opened(chromium, running_lab, "help", color_scheme=colours)
    page.evaluate("sessionStorage.setItem('squeezefilm study', 'small')")
    for area in areas:
        page.evaluate("area => { location.hash = area; }", area)
        page.locator(f"main[data-area={area}] .card").first.wait_for()
        if area == "design":
            page.locator(".quality", has_text="solved:").wait_for(timeout=SOLVED)
        if area == "feel":
            page.locator(".parity", has_text="agree").wait_for(timeout=SOLVED)
        for width in (1280, 1920):
            page.set_viewport_size({"width": width, "height": 1000})
            page.wait_for_timeout(150)
            keep(page, f"lab-{area}-{colours}-{width}")
            assert page.evaluate("document.documentElement.scrollWidth") <= width, area
            main = page.evaluate(
                "(() => { const m = document.querySelector('main');"
                " return [m.scrollWidth, m.clientWidth]; })()"
            )
            assert main[0] <= main[1], area
        for scheme in ("light", "dark"):
            page.emulate_media(color_scheme=scheme)
            assert page.evaluate(CONTRAST) == [], (area, scheme)
        page.emulate_media(color_scheme=colours)
    page.evaluate("location.hash = 'study'")
    row = prepared(page)
    person = station(page, row, chromium, color_scheme=colours)
    assert person.evaluate(CONTRAST) == []
    consented(person)
    step(person)
    assert person.evaluate(CONTRAST) == []
    keep(person, f"lab-participant-{colours}")
    assert complaints == []


def test_the_tour_is_taken_left_and_remembered(chromium: Browser, shared_lab: RunningLab) -> None:
    page, complaints = opened(chromium, shared_lab, "help")
    tour = page.locator("#tour")
    tour.get_by_text("1 of 4").wait_for()
    keep(page, "lab-tour-1280")
    # A tour covers nothing and takes nobody elsewhere before it is asked.
    assert page.evaluate("location.hash") == "#help"
    tour.get_by_role("button", name="Next").focus()
    for number, area in ((2, "feel"), (3, "study"), (4, "help")):
        page.keyboard.press("Enter")
        tour.get_by_text(f"{number} of 4").wait_for()
        page.locator(f"main[data-area={area}]").wait_for()
    assert page.evaluate(CONTRAST) == []
    page.keyboard.press("Enter")
    tour.wait_for(state="hidden")
    page.reload()
    page.get_by_text("Start the tour again").wait_for()
    assert tour.is_hidden()
    page.get_by_role("button", name="Start the tour again").press("Enter")
    tour.get_by_text("1 of 4").wait_for()
    page.keyboard.press("Escape")
    tour.wait_for(state="hidden")
    assert complaints == []
