"""What every area of the lab owes: an end when it is left, room at every size, a stop while
anything plays, numbers that are true, and what was made there when somebody comes back."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import pytest

from .conftest import RunningLab
from .test_lab_pages import AREAS, CONTRAST, SOLVED

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page, WebSocketRoute

pytestmark = [pytest.mark.chromium, pytest.mark.slow]

SIZES = ((360, 740), (412, 915), (640, 450), (768, 1024), (960, 700), (1280, 900), (1920, 1080))
"""CSS pixels; 640 × 450 is a screen of 1280 × 900 at 200 %."""
COMPUTED = ("compute design", "load texture", "parity", "analyze study", "check requirements")
"""What takes as long as the machine lets it."""
FRAMES = """(() => {
  const ask = requestAnimationFrame.bind(window), drop = cancelAnimationFrame.bind(window);
  const waiting = new Set();
  window.requestAnimationFrame = (draw) => {
    const id = ask((now) => { waiting.delete(id); draw(now); });
    waiting.add(id);
    return id;
  };
  window.cancelAnimationFrame = (id) => { waiting.delete(id); drop(id); };
  window.framesWaiting = () => waiting.size;
})()"""
CUT_OFF = """() => {
  const page = document.documentElement, area = document.getElementById("area");
  const wide = [page, area].filter((one) => one.scrollWidth > one.clientWidth)
    .map((one) => `${one.tagName}: ${one.scrollWidth} in ${one.clientWidth}`);
  // On small screens the page scrolls, and an area has all its height.
  const high = innerWidth <= 960 && area.scrollHeight > area.clientHeight;
  return high ? [...wide, `${area.scrollHeight} high in ${area.clientHeight}`] : wide;
}"""


class Watched:
    """A page whose conversation with the lab is heard, and may be added to."""

    def __init__(self, browser: Browser, lab: RunningLab) -> None:
        self.lab = lab
        self.asked: list[dict[str, Any]] = []
        self.answered: set[int] = set()
        self.late: str | None = None  # the type of request whose answers are kept back
        self._kept: list[str | bytes] = []
        self.complaints: list[str] = []
        context = browser.new_context(viewport={"width": 1280, "height": 900})
        context.route_web_socket(re.compile("/ws$"), self._between)
        context.add_init_script(FRAMES)
        self.page: Page = context.new_page()
        self.page.on("console", lambda message: self.complaints.append(message.text))
        self.page.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.page.goto(lab.link)
        self.page.get_by_role("button", name="No tour").click()

    def _between(self, route: WebSocketRoute) -> None:
        server = route.connect_to_server()

        def asked(text: str | bytes) -> None:
            self.asked.append(json.loads(text))
            server.send(text)

        def told(text: str | bytes) -> None:
            answers = json.loads(text).get("id")
            self.answered.add(answers)
            if self.late in [one["type"] for one in self.asked if one["id"] == answers]:
                self._kept.append(text)
            else:
                route.send(text)

        self.route, self.server = route, server
        route.on_message(asked)
        server.on_message(told)

    def go(self, area: str) -> None:
        """Enter an area."""
        self.page.goto(f"{self.lab.address}#{area}")
        self.page.locator(f"#area[data-area={area}] *").first.wait_for(state="attached")

    def let_go(self) -> None:
        """Give the page the answers that were kept back."""
        self.late, kept, self._kept = None, self._kept, []
        for text in kept:
            self.route.send(text)

    def keeps(self) -> None:
        """Until an answer is kept back; those to what is asked from then on are not."""
        for _ in range(600):
            if self._kept:
                self.late = None
                return
            self.page.wait_for_timeout(50)
        raise AssertionError(f"nothing answered to {self.late} within 30 s")

    def told(self, type: str, **fields: Any) -> None:
        """The page hears a message that the lab did not send."""
        self.route.send(json.dumps({"type": type, **fields}))

    def said(self, type: str, **fields: Any) -> None:
        """The lab hears a request that the page did not send."""
        self.server.send(json.dumps({"id": 2**40, "type": type, **fields}))

    def settle(self) -> None:
        """Until everything that was asked is answered, but for what is computed."""
        for _ in range(600):
            quick = {one["id"] for one in self.asked if one["type"] not in COMPUTED}
            if quick <= self.answered:
                return
            self.page.wait_for_timeout(50)
        raise AssertionError("the lab did not answer within 30 s")

    def hears(self, type: str, times: int) -> None:
        """Until the page has asked for this so often, and is answered."""
        for _ in range(600):
            if self.count(type) >= times:
                break
            self.page.wait_for_timeout(50)
        self.settle()

    def count(self, type: str) -> int:
        """How often the page asked for this."""
        return sum(one["type"] == type for one in self.asked)


@pytest.fixture(scope="module")
def opened(browser: Browser, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Watched]:
    """One lab and one page for all tests of this file."""
    lab = RunningLab(tmp_path_factory.mktemp("areas"))
    yield Watched(browser, lab)
    assert lab.stop() == 0


@pytest.fixture
def seen(opened: Watched) -> Iterator[Watched]:
    """The page, wide; nothing may be complained of."""
    opened.page.set_viewport_size({"width": 1280, "height": 900})
    yield opened
    assert opened.complaints == []


def listeners(page: Page) -> int:
    """How many listeners document and window have."""
    session = page.context.new_cdp_session(page)
    found = 0
    for owner in ("document", "window"):
        handle = session.send("Runtime.evaluate", {"expression": owner})["result"]["objectId"]
        asked = {"objectId": handle}
        found += len(session.send("DOMDebugger.getEventListeners", asked)["listeners"])
    session.detach()
    return found


def test_an_area_that_was_left_is_silent(seen: Watched) -> None:
    page = seen.page
    seen.go("help")
    before = listeners(page)
    page.evaluate(
        """async (areas) => {
          for (let k = 0; k < 30; k += 1) {
            location.hash = areas[k % areas.length];
            await new Promise((later) => setTimeout(later, k % 7 * 4));
          }
          location.hash = "help";
        }""",
        list(AREAS),
    )
    seen.settle()
    page.get_by_role("heading", name="Quantities").wait_for()
    assert page.locator("#area > *").count() == 1
    asked = len(seen.asked)
    page.wait_for_timeout(700)
    assert (page.evaluate("framesWaiting()"), listeners(page)) == (0, before)
    # Half a second after a slider moved a display would be solved.
    assert len(seen.asked) == asked
    # One stay draws once a frame, however often the area was entered before.
    seen.go("design")
    page.wait_for_function("() => framesWaiting() === 1")
    seen.go("study")
    seen.settle()
    button = page.get_by_role("button", name="Create the study")
    button.focus()
    before = seen.count("create study")
    page.keyboard.press("Space")
    # A key is heard after it was pressed, and what it asks for after that.
    seen.hears("create study", before + 1)
    assert seen.count("create study") == before + 1
    assert seen.count("stop everything") == 0


VISITS = """async () => {
  const { Visit } = await import("/static/visit.js");
  const sent = [], heard = new Set(), notes = [];
  let answer = null;
  const ask = (type) => (sent.push(type), new Promise((yes, no) => { answer = { yes, no }; }));
  const on = (type, listener) => (heard.add(listener), () => heard.delete(listener));
  const socket = { ask, on, open: true }, kept = { value: "typed" }, after = [];
  const page = { socket, notify: (text) => notes.push(text), shared: {} };
  const visit = new Visit(page);
  const told = (name) => [(value) => after.push(`${name} ${value}`), () => after.push("failed")];
  visit.socket.on("x", () => {});
  visit.remember("area", { kept });
  visit.socket.ask("here").then(...told("here"));
  answer.yes("answered");
  await null; await null; await null;
  visit.socket.ask("slow").then(...told("slow"));
  const slow = answer;
  visit.act("done").then(...told("done"));
  const done = answer;
  visit.act("refused").then(...told("refused"));
  const refused = answer;
  const hearing = heard.size;
  visit.leave();
  slow.yes("late");
  done.yes("all the same");
  refused.no(new Error("in words"));
  visit.socket.ask("after").then(...told("after"));
  visit.socket.on("x", () => {});
  visit.frames(() => after.push("drew"));
  await new Promise((later) => setTimeout(later, 60));
  return { sent, hearing, heard: heard.size, notes, after, kept: page.shared.area.kept };
}"""


def test_a_visit_ends_what_was_begun_in_it(seen: Watched) -> None:
    seen.go("help")
    assert seen.page.evaluate(VISITS) == {
        "sent": ["here", "slow", "done", "refused"],
        "hearing": 1,
        "heard": 0,
        # What was asked to be done is done and said; what was only to be shown is not.
        "notes": ["in words"],
        "after": ["here answered", "done all the same"],
        "kept": "typed",
    }


def test_the_answer_to_an_earlier_wish_is_not_shown_over_a_later_one(seen: Watched) -> None:
    page = seen.page
    seen.go("help")
    seen.late = "plan study"
    seen.go("study")
    page.locator("#study-name").fill("early")
    page.get_by_role("button", name="Create the study").click()
    page.locator("h2", has_text="early").wait_for()
    seen.let_go()
    seen.settle()
    assert page.locator("h2", has_text="early").is_visible()
    page.reload()
    page.locator("h2", has_text="early").wait_for()


def test_an_earlier_texture_is_not_shown_over_a_later_one(seen: Watched) -> None:
    page = seen.page
    seen.go("help")
    page.evaluate("sessionStorage.clear()")
    seen.late = "load texture"
    seen.go("feel")
    seen.keeps()
    page.locator("#texture-choice").select_option("preset:bump")
    heading = page.locator("#area h2", has_text=", on ")
    heading.wait_for()
    shown = heading.text_content()
    seen.let_go()
    seen.settle()
    assert heading.text_content() == shown
    assert "4 mm" not in (shown or "")


def test_an_earlier_study_is_not_shown_over_a_later_one(seen: Watched) -> None:
    page = seen.page
    seen.go("help")
    seen.go("study")
    for name in ("first", "second"):
        page.locator("#study-name").fill(name)
        page.get_by_role("button", name="Create the study").click()
        page.locator("h2", has_text=name).wait_for()
        if name == "first":
            page.get_by_role("button", name="Enrol a participant").click()
            page.locator("tr[data-participant]").wait_for()
    seen.settle()
    seen.late = "study"
    page.get_by_role("button", name="first", exact=True).click()
    seen.keeps()
    page.get_by_role("button", name="second", exact=True).click()
    seen.settle()
    seen.let_go()
    page.wait_for_timeout(200)
    assert page.locator("[aria-current=true]", has_text="second").count() == 1
    assert page.locator("h2", has_text="first").count() == 0
    seen.go("results")
    page.locator("#results-study").wait_for()
    seen.settle()
    seen.late = "study"
    page.locator("#results-study").select_option("first")
    seen.keeps()
    page.locator("#results-study").select_option("second")
    seen.settle()
    seen.let_go()
    page.wait_for_timeout(200)
    assert page.locator(".person").count() == 0


def test_every_area_has_room_at_every_size(seen: Watched) -> None:
    page = seen.page
    page.emulate_media(color_scheme="dark")
    seen.go("study")
    page.locator("#study-name").fill("roomy")
    page.get_by_role("button", name="Create the study").click()
    page.locator("h2", has_text="roomy").wait_for()
    page.get_by_role("button", name="Enrol a participant").click()
    page.get_by_role("button", name="Prepare a sitting…").click()
    page.locator("form.sitting").wait_for()
    for area in ("study", *(one for one in AREAS if one != "study")):
        seen.go(area)
        if area == "feel":
            page.get_by_text("Compose a grating").click()
        elif area == "design":
            page.locator(".form input").first.wait_for()
        for width, height in SIZES:
            page.set_viewport_size({"width": width, "height": height})
            assert page.evaluate(CUT_OFF) == [], f"{area} at {width} × {height}"
            if area == "design":
                form = page.locator(".form").bounding_box()
                side = page.locator(".design .side").bounding_box()
                assert form is not None
                assert side is not None
                assert form["height"] > 400
                assert side["height"] > 400, f"the form at {width} × {height}"
            if width == 360:
                assert page.evaluate(CONTRAST) == []
    page.emulate_media(color_scheme="light")


PLAYING = [{"key": "device", "text": "a texture on twin", "plays": True}]
VIEW = {
    "state": "PLAYING", "fault": "NONE", "time_s": 1.2, "x_m": -0.004, "speed_m_per_s": 0.06,
    "relative_friction": 0.7, "amplitude_m": 1e-6, "wanted_m": 1e-6, "level_V": 8.08,
    "lag_m": 1e-4, "lateness_s": 1e-5, "flags": [], "held": None, "loops": "",
}  # fmt: skip


def test_what_plays_is_stopped_from_every_area(seen: Watched) -> None:
    page, bar = seen.page, seen.page.locator("#stopbar")
    seen.go("device")
    stops = seen.count("stop everything")
    # The area is ready once its last list is there; what it fills in disarms.
    page.locator("#device-texture option").first.wait_for(state="attached")
    seen.settle()
    arm = page.get_by_role("button", name="Arm", exact=True)
    arm.focus()
    page.keyboard.press("Space")
    # Where nothing plays, Space presses what it presses anywhere.
    page.get_by_role("button", name="Armed").wait_for()
    seen.told("playing", now=PLAYING)
    for area in AREAS:
        seen.go(area)
        assert bar.is_visible(), area
        page.locator("nav a").first.focus()
        page.keyboard.press("Space")
        page.keyboard.press("Escape")
        bar.get_by_role("button").click()
        stops += 3
        page.wait_for_timeout(20)
        assert seen.count("stop everything") == stops, area
        assert page.evaluate("location.hash") == f"#{area}"
    seen.go("device")
    field = page.locator("#stroke")
    field.fill("60 mm/s")
    field.press("Space")
    assert field.input_value() == "60 mm/s "
    assert seen.count("stop everything") == stops
    field.press("Escape")
    seen.settle()
    assert seen.count("stop everything") == stops + 1
    # A key that is held presses nothing when what played has ended meanwhile.
    arm.focus()
    page.keyboard.down("Space")
    seen.told("playing", now=[])
    page.wait_for_function(
        "() => !document.querySelector('#stopbar').textContent.includes('texture')"
    )
    page.keyboard.down("Space")
    page.keyboard.up("Space")
    assert arm.is_visible()
    # Two pages, and somebody who comes back: what was typed is there.
    seen.go("help")
    assert bar.is_hidden()
    seen.go("device")
    assert page.locator("#stroke").input_value() == "60 mm/s "


def test_a_device_that_is_gone_is_not_shown_playing(seen: Watched) -> None:
    page = seen.page
    seen.go("device")
    seen.settle()
    shown = page.locator(".numbers .number")
    for ended, state, fault in (
        ({"ending": "FAULT", "message": "the amplifier tripped"}, "FAULT", "yes"),
        ({"ending": "LINK", "message": "the port is gone"}, "not known", "not known"),
        ({"message": "the process ended without a word"}, "not known", "not known"),
    ):
        seen.told("playing", now=PLAYING)
        seen.told("device view", **VIEW)
        shown.filter(has_text="8.08 V").wait_for()
        assert shown.filter(has_text="position").inner_text().splitlines()[1] == "−4.00 mm"
        if state == "FAULT":
            # Held up, it may still play: what is shown is old, and says so.
            page.locator(".results.older .age", has_text="updated 1 s ago").wait_for()
        seen.told("device ended", failed=True, **ended)
        seen.told("playing", now=[])
        shown.filter(has_text=ended["message"]).wait_for()
        values = page.locator(".numbers .number b").all_inner_texts()
        assert values == [state, "–", "–", "–", "–", "–", "–", fault, "–"]
        assert ended["message"] in page.locator("#stopbar").inner_text()


AXES = """async (largest) => {
  const { Scope } = await import("/static/scope.js");
  const canvas = document.createElement("canvas");
  canvas.style = "width: 400px; height: 150px";
  document.body.append(canvas);
  const scope = new Scope(canvas, [{ label: "", colour: "blue" }]);
  const written = [];
  const g = canvas.getContext("2d");
  g.fillText = (text) => written.push(text);
  const found = [];
  for (const high of largest) {
    written.length = 0;
    scope.clear();
    scope.add(0, [high]);
    scope.draw(0);
    found.push(written.slice(0, 5));
  }
  canvas.remove();
  return found;
}"""
NUMBERS = """async () => {
  const { plain, quantity, fixed } = await import("/static/numbers.js");
  const values = [0];
  for (let k = -40; k <= 40; k += 1) {
    for (const digits of [1, 1.5, 2, 9.994, 9.996, 1.0049]) values.push(digits * 10 ** (k / 4));
  }
  for (let n = 1; n <= 400; n += 1) values.push(n, 10 * n, 1000 * n);
  const both = values.flatMap((one) => [one, -one]);
  return both.map((one) => [one, plain(one), fixed(one, 2),
    ...[3, 5, 2].map((digits) => quantity(one, "V", digits))]);
}"""
PREFIXES = {"G": 1e9, "M": 1e6, "k": 1e3, "": 1.0, "m": 1e-3, "µ": 1e-6, "n": 1e-9, "p": 1e-12}


def number_in(text: str) -> float:
    assert "-" not in text
    return float(text.replace("−", "-"))


def test_numbers_and_axes_say_what_they_mean(seen: Watched) -> None:
    seen.go("help")
    for value, bare, decimals, *volts in seen.page.evaluate(NUMBERS):
        assert abs(number_in(bare) - value) <= 5.001e-3 * abs(value)
        assert abs(number_in(decimals) - value) < 0.00501
        for text, digits in zip(volts, (3, 5, 2), strict=True):
            number, unit = text.split()
            assert unit.endswith("V")
            said = number_in(number) * PREFIXES[unit[:-1]]
            assert abs(said - value) <= max(5.001 * 10.0**-digits * abs(value), 1e-13), text
            if 1e-12 <= abs(value) < 9e11:
                assert 1 <= abs(number_in(number)) < 1000
    largest = [1.0, 7.0, 10.0, 15.0, 100.0, 142.857, 150.0, 190.476, 200.0, 1500.0, 2e4, 0.02]
    for high, marks in zip(largest, seen.page.evaluate(AXES, largest), strict=True):
        wanted = [1.05 * high * k / 4 for k in range(5)]
        assert [number_in(one) for one in marks] == pytest.approx(wanted, rel=5.001e-3)
    # Below 0 and unchanging, it still has its place.
    (marks,) = seen.page.evaluate(AXES, [-8.0])
    assert [number_in(one) for one in marks] == [-8, -6, -4, -2, 0]


NODES = """async (along) => {
  const { PlanView } = await import("/static/plan_view.js");
  const canvas = document.createElement("canvas");
  canvas.style = "width: 400px; height: 300px";
  document.body.append(canvas);
  const g = canvas.getContext("2d"), lines = [];
  let from = null;
  g.moveTo = (x, y) => { from = [x, y]; };
  g.lineTo = (x, y) => g.getLineDash().join() === "2,4" && lines.push([...from, x, y]);
  const view = new PlanView(canvas);
  view.set({ kind: "plate", length_m: 0.08, width_m: 0.04, patches: [] },
    { along, position_m: [0, 0.04], deflection: [1, -1], nodal_positions_m: [0.01, 0.03] }, null);
  view.draw(0);
  canvas.remove();
  return lines;
}"""


def test_nodal_lines_lie_where_the_mode_has_them(seen: Watched) -> None:
    seen.go("help")
    across = seen.page.evaluate(NODES, "y")
    assert [one[1] == one[3] for one in across] == [True, True]
    # y goes up: the first line is the lower one.
    assert across[0][1] > across[1][1]
    along = seen.page.evaluate(NODES, "x")
    assert [one[0] == one[2] for one in along] == [True, True]
    assert along[0][0] < along[1][0]


def test_what_cannot_be_is_said_beside_its_field(seen: Watched) -> None:
    page = seen.page
    page.set_viewport_size({"width": 412, "height": 915})
    seen.go("design")
    for path, says in (
        ("actuator.thickness", "'abc' is no quantity"),
        ("actuator.nodal_lines", "'abc' is no whole number"),
        ("finger.ridge_period", "'abc' is no quantity"),
    ):
        field = page.locator(f"input[type=text][data-path='{path}']")
        was = field.input_value()
        field.fill("abc")
        field.press("Enter")
        wrong = page.locator(".field", has=field).locator(".error")
        wrong.filter(has_text=says).wait_for()
        assert field.get_attribute("aria-invalid") == "true"
        assert wrong.get_attribute("id") in str(field.get_attribute("aria-describedby")).split()
        field.fill(was)
        field.press("Enter")
        wrong.wait_for(state="hidden")
        assert field.get_attribute("aria-invalid") == "false"


def test_a_texture_and_a_stroke_are_there_after_another_area(seen: Watched) -> None:
    page = seen.page
    seen.go("feel")
    heading = page.locator("h2", has_text="square, 7 mm")
    page.get_by_text("Compose a grating").click()
    page.get_by_label("lowest relative friction").fill("abc")
    page.get_by_role("button", name="Use this grating").click()
    page.locator(".error", has_text="'abc', is no number").wait_for()
    page.get_by_label("lowest relative friction").fill("0.75")
    page.get_by_label("spatial period").fill("7 mm")
    page.get_by_role("button", name="Use this grating").click()
    heading.wait_for(timeout=SOLVED)
    page.get_by_role("button", name="Record").click()
    page.locator("canvas.surface").focus()
    for _ in range(12):
        page.keyboard.press("ArrowRight")
    page.get_by_role("button", name="Stop recording").click()
    page.locator("small", has_text="12 samples").wait_for()
    seen.go("results")
    seen.go("feel")
    heading.wait_for(timeout=SOLVED)
    page.locator("small", has_text="12 samples").wait_for()
    assert page.get_by_role("button", name="Download CSV").is_enabled()
    assert page.get_by_label("spatial period").input_value() == "7 mm"
    # The texture, like the display, outlives a reload as well.
    page.reload()
    heading.wait_for(timeout=SOLVED)


def test_a_button_stays_where_it_is_under_the_first_touch(seen: Watched) -> None:
    """One that moves between the pointer's down and up is not clicked."""
    page = seen.page
    seen.go("help")
    seen.go("feel")
    page.locator("#area h2", has_text=", on ").wait_for(timeout=SOLVED)
    record = page.get_by_role("button", name="Record")
    before = record.bounding_box()
    page.locator("canvas.surface").focus()
    page.keyboard.press("ArrowRight")
    page.locator(".number small", has_text="95 %").wait_for()
    assert record.bounding_box() == before


def test_a_texture_that_was_asked_for_before_the_list_of_textures_is_shown(seen: Watched) -> None:
    page = seen.page
    seen.go("help")
    page.evaluate("sessionStorage.clear()")
    seen.late = "textures"
    seen.go("feel")
    seen.keeps()
    page.get_by_text("Compose a grating").click()
    page.get_by_label("spatial period").fill("7 mm")
    seen.late = "load texture"
    page.get_by_role("button", name="Use this grating").click()
    seen.let_go()
    page.locator("h2", has_text="square, 7 mm").wait_for(timeout=SOLVED)


def test_results_follow_who_takes_part(seen: Watched) -> None:
    page = seen.page
    seen.said("create study", design="biet2008-gratings", study="followed", seed=1)
    seen.go("help")
    seen.go("results")
    page.locator("#results-study").select_option("followed")
    page.locator(".side", has_text="nobody yet").wait_for()
    seen.said("enrol", study="followed")
    page.locator(".person").wait_for()
    assert page.get_by_text("nobody yet").count() == 0
