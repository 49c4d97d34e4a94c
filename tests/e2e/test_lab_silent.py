"""The lab's pages while the server does not answer, and while nobody does anything."""

from __future__ import annotations

import signal
import time
from typing import TYPE_CHECKING

import pytest

from .test_lab_pages import SOLVED, keep, opened

if TYPE_CHECKING:
    from playwright.sync_api import Browser

    from .conftest import RunningLab, Start

pytestmark = [pytest.mark.chromium, pytest.mark.slow]

GREY = "() => getComputedStyle(document.querySelector('.results > *')).filter"


def test_a_server_that_stands_still_is_noticed_and_its_numbers_are_grey(
    chromium: Browser, running_lab: RunningLab
) -> None:
    page, complaints = opened(chromium, running_lab, "design")
    page.locator(".quality", has_text=":").wait_for(timeout=SOLVED)
    page.locator(".age", has_text="computed").wait_for()
    state = page.locator("#connection")
    state.filter(has_text="connected").wait_for()
    assert page.evaluate(GREY) == "none"
    running_lab.process.send_signal(signal.SIGSTOP)
    try:
        # The websocket stays open: nothing but the silence tells.
        state.filter(has_text="the lab has not answered for").wait_for(timeout=10_000)
        assert page.evaluate(GREY) == "grayscale(1)"
        keep(page, "lab-silent-1280")
    finally:
        running_lab.process.send_signal(signal.SIGCONT)
    state.filter(has_text="connected").wait_for(timeout=30_000)
    assert page.evaluate(GREY) == "none"
    assert complaints == []


LATE = """async () => {
  const { Socket } = await import("/static/socket.js");
  const socket = Object.create(Socket.prototype), said = [];
  Object.assign(socket, { open: true, silent: false, listeners: new Map() });
  socket.heard = performance.now();
  socket.on("silence", ({ seconds }) => said.push(seconds));
  socket.listen();
  socket.heard -= 1700;
  socket.listen();
  socket.heard = performance.now();
  socket.listen();
  socket.listen();
  return said;
}"""


def test_less_than_two_seconds_of_silence_are_said_and_so_is_their_end(
    chromium: Browser, shared_lab: RunningLab
) -> None:
    page, _ = opened(chromium, shared_lab, "help")
    silent, ended = page.evaluate(LATE)
    assert 1.7 <= silent < 2.0
    assert ended == 0


def test_a_page_on_which_nothing_happens_leaves_the_computer_alone(
    chromium: Browser, shared_lab: RunningLab
) -> None:
    page, complaints = opened(chromium, shared_lab, "help", reduced_motion="no-preference")
    page.add_init_script(
        """window.frames_drawn = 0;
        const ask = requestAnimationFrame.bind(window);
        window.requestAnimationFrame = (draw) => ask((now) => { frames_drawn += 1; draw(now); });"""
    )
    for area in ("design", "feel", "device"):
        page.goto(f"{shared_lab.address}#{area}")
        page.reload()
        page.locator("main canvas").first.wait_for()
        if area == "design":
            page.locator(".quality", has_text="solved:").wait_for(timeout=SOLVED)
            page.locator(".work").wait_for(state="hidden", timeout=SOLVED)
        elif area == "feel":
            page.locator(".parity", has_text="agree").wait_for(timeout=SOLVED)
        # The mode of a new answer moves for three cycles of two seconds.
        until = time.monotonic() + 60.0
        drawn = -1
        while drawn != (drawn := page.evaluate("frames_drawn")) and time.monotonic() < until:
            page.wait_for_timeout(1000)
        assert page.evaluate("frames_drawn") == drawn > 0, area
    page.goto(f"{shared_lab.address}#design")
    page.locator(".quality", has_text="solved:").wait_for(timeout=SOLVED)
    page.locator("canvas.plan").hover()
    before = page.evaluate("frames_drawn")
    page.wait_for_function("before => frames_drawn > before + 5", arg=before)
    assert complaints == []


TOUCHES = """async ([x, y]) => {
  const canvas = document.querySelector("canvas.surface"), box = canvas.getBoundingClientRect();
  canvas.setPointerCapture = () => {};
  const touch = (type, pointerId, dx) => canvas.dispatchEvent(new PointerEvent(type, {
    pointerId, pointerType: "touch", clientX: box.left + x + dx, clientY: box.top + y,
  }));
  const move = "onpointerrawupdate" in window ? "pointerrawupdate" : "pointermove";
  const pause = () => new Promise((later) => setTimeout(later, 8));
  touch("pointerdown", 1, 0);
  touch("pointerdown", 2, 150);
  let fastest = 0;
  const speed = document.querySelectorAll(".number b")[4];
  for (let k = 0; k < 60; k += 1) {
    touch(move, 1, 0);
    await pause();
    touch(move, 2, 150);
    await pause();
    fastest = Math.max(fastest, parseFloat(speed.textContent) || 0);
  }
  touch("pointerup", 2, 150);
  touch("pointerup", 1, 0);
  return fastest;
}"""


def test_a_second_finger_is_not_mixed_into_the_speed_of_the_first(
    chromium: Browser, shared_lab: RunningLab
) -> None:
    page, complaints = opened(chromium, shared_lab, "feel")
    page.locator(".parity", has_text="agree").wait_for(timeout=SOLVED)
    page.locator("canvas.surface").scroll_into_view_if_needed()
    assert page.evaluate(TOUCHES, [60, 40]) == 0
    assert complaints == []


def test_an_edit_without_the_lab_is_made_when_it_is_back_and_undone_after_a_reload(
    chromium: Browser, running_lab: RunningLab, start_lab: Start
) -> None:
    page, _ = opened(chromium, running_lab, "design")
    field = page.locator("input[type=text][data-path='actuator.thickness']")
    field.wait_for(timeout=SOLVED)
    other = page.locator("input[type=text][data-path='drive.voltage']")
    wrong = page.locator("input[type=text][data-path='finger.normal_force']")
    undo = page.get_by_role("button", name="Undo")
    running_lab.kill()
    page.locator("#connection", has_text="not running").wait_for()
    for box, value in ((field, "2.2 mm"), (other, "12 V"), (wrong, "-1 N")):
        box.fill(value)
        box.press("Enter")
        page.locator(".field", has=box).locator(".error", has_text="not written yet").wait_for()
    # Typed back to what it was: nothing waits to be written.
    other.fill("15 V")
    other.press("Enter")
    page.locator(".field", has=other).locator(".error").wait_for(state="hidden")
    start_lab(running_lab.folder, running_lab.port)
    page.locator(".field", has=wrong).locator(".error", has_text="-1 N was not written").wait_for(
        timeout=SOLVED
    )
    assert (field.input_value(), other.input_value()) == ("2.2 mm", "15 V")
    assert field.get_attribute("aria-invalid") != "true"
    page.reload()
    field.wait_for(timeout=SOLVED)
    assert field.input_value() == "2.2 mm"
    undo.click()
    page.wait_for_function(
        "() => document.querySelector(\"[data-path='actuator.thickness']\").value === '2 mm'"
    )
    assert undo.is_disabled()
    assert page.get_by_role("button", name="Redo").is_enabled()


STEPS = """async (steps) => {
  const { DisplayStore } = await import("/static/display_store.js");
  sessionStorage.clear();
  const wait = () => new Promise((later) => setTimeout(later, 5));
  const socket = { ask: async (_, { text, path, value }) => {
    await wait();
    return { text: path ? `${text}${path}${value};` : text };
  } };
  const store = new DisplayStore(socket);
  await store.open({ text: "x".repeat(steps.long) });
  // Each is of the text that the last one left, also where nobody waited for it.
  await Promise.all([store.edit("a", "1"), store.edit("b", "2"), store.edit("c", "3")]);
  const edited = store.current.text.replaceAll("x", "");
  for (let k = 0; k < steps.count; k += 1) await store.edit(`p${k}`, "1");
  const again = new DisplayStore(socket);
  await again.restore();
  return [edited, again.current.text === store.current.text, again.past.length];
}"""


def test_edits_follow_one_another_and_as_many_steps_are_kept_as_there_is_room_for(
    chromium: Browser, shared_lab: RunningLab
) -> None:
    page, complaints = opened(chromium, shared_lab, "help")
    assert page.evaluate(STEPS, {"long": 10, "count": 5}) == ["a1;b2;c3;", True, 8]
    edited, same, kept = page.evaluate(STEPS, {"long": 300_000, "count": 9})
    assert (edited, same) == ("a1;b2;c3;", True)
    assert 1 <= kept < 12
    assert complaints == []
