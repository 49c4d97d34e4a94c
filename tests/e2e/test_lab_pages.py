"""The lab's Design and Feel areas in a real browser, from start to a saved file."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from squeezefilm.physics.display import load_display
from squeezefilm.physics.texture_files.trajectories import read_trajectory

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

    from .conftest import RunningLab

pytestmark = [pytest.mark.chromium, pytest.mark.slow]

SOLVED = 180_000
CONTRAST = """() => {
  const parse = (text) => (text.match(/[\\d.]+/g) || []).map(Number)
    .map((one, k) => (text.startsWith("color(srgb") && k < 3 ? 255 * one : one));
  const light = (c) => { const [r, g, b] = c.slice(0, 3).map((v) => { v /= 255;
    return v <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4; });
    return 0.2126 * r + 0.7152 * g + 0.0722 * b; };
  const bad = [];
  const walk = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  for (let node = walk.nextNode(); node; node = walk.nextNode()) {
    const owner = node.parentElement;
    const seen = node.textContent.trim() && owner.checkVisibility();
    if (!seen || owner.closest(":disabled")) continue;
    let behind = owner, back = [0, 0, 0, 0];
    while (behind && (back.length === 4 && back[3] === 0)) {
      back = parse(getComputedStyle(behind).backgroundColor);
      behind = behind.parentElement;
    }
    const a = light(parse(getComputedStyle(owner).color)), b = light(back);
    const ratio = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
    if (ratio < 4.5) bad.push([node.textContent.trim().slice(0, 40), ratio.toFixed(2)]);
  }
  return bad;
}"""


def opened(browser: Browser, lab: RunningLab, area: str, **options: Any) -> tuple[Page, list[str]]:
    # A mode in motion keeps the computer busy; where it moves is asked in test_lab_silent.
    usual = {"viewport": {"width": 1280, "height": 900}, "reduced_motion": "reduce"}
    context = browser.new_context(**usual | options)  # type: ignore[arg-type]
    page = context.new_page()
    complaints: list[str] = []
    page.on("console", lambda message: complaints.append(message.text))
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.on(
        "request",
        lambda request: (
            request.url.startswith((lab.address, "blob:", "data:"))
            or complaints.append(f"asked elsewhere: {request.url}")
        ),
    )
    # The printed link lets one browser in, whose cookie later pages have.
    context.add_cookies(lab.cookies)
    page.goto(lab.address if lab.cookies else lab.link)
    lab.cookies = context.cookies()
    page.goto(f"{lab.address}#{area}")
    return page, complaints


def keep(page: Page, name: str) -> None:
    """A screenshot for people to look at."""
    folder = Path("out") / "screenshots"
    folder.mkdir(parents=True, exist_ok=True)
    page.screenshot(path=folder / f"{name}.png", full_page=True)


AREAS = ("design", "search", "feel", "device", "study", "results", "help")


def test_what_is_pressed_before_the_lab_has_answered_breaks_nothing(
    chromium: Browser, shared_lab: RunningLab
) -> None:
    page, complaints = opened(chromium, shared_lab, "help")
    page.get_by_role("button", name="No tour").click()
    page.on("dialog", lambda dialog: dialog.accept("mine"))
    # A connection that opens and never answers.
    page.route_web_socket(re.compile("."), lambda _: None)
    for area in AREAS:
        page.goto(f"{shared_lab.address}#{area}")
        page.reload()
        page.locator("main > *").first.wait_for()
        for button in page.get_by_role("button").all():
            if button.is_visible() and button.is_enabled():
                button.click(force=True, no_wait_after=True)
        said = " ".join(page.locator(".error, #notice").all_inner_texts())
        assert not re.search("null|undefined|not a function", said), f"{area}: {said}"
    assert complaints == []


def test_a_disc_is_solved_and_gets_its_drive_numbers(
    chromium: Browser, running_lab: RunningLab
) -> None:
    page, complaints = opened(chromium, running_lab, "design")
    page.get_by_role("button", name="No tour").click()
    page.locator("#display-choice option", has_text="winfield2007-tpad").wait_for(state="attached")
    page.locator("#display-choice").select_option("preset:winfield2007-tpad")
    number = page.locator(".number")
    frequency = number.filter(has_text="resonance frequency").locator("b")
    frequency.filter(has_text=re.compile(r"^2[0-9.]+ kHz")).wait_for(timeout=SOLVED)
    page.locator(".quality", has_text="solved: vibration by").wait_for(timeout=SOLVED)
    for name, unit in (("drive current", "A"), ("drive power", "W"), ("matching inductor", "H")):
        said = number.filter(has_text=name).locator("b").inner_text()
        assert re.fullmatch(rf"[0-9.]+ [mµ]?{unit}", said), (name, said)
    keep(page, "lab-design-disc-light-1280")
    assert complaints == []


def test_a_display_is_changed_undone_saved_and_opened_again(
    chromium: Browser, shared_lab: RunningLab
) -> None:
    page, complaints = opened(chromium, shared_lab, "design")
    quality = page.locator(".quality")
    quality.filter(has_text="solved:").wait_for(timeout=SOLVED)
    frequency = page.locator(".number b").first
    solved = frequency.inner_text()
    assert solved.startswith("33.5")
    thickness = page.locator("input[type=text][data-path='actuator.thickness']")
    thickness.focus()
    assert page.locator(".field label").count() > 40
    assert page.locator(".field label:not([data-tip])").all_text_contents() == []
    assert page.locator(".number span:not([data-tip])").all_inner_texts() == []
    thickness.fill("2.2 mm")
    thickness.press("Enter")
    # On a busy machine the screening's own line may stand for an instant only.
    quality.filter(has_text=re.compile("screening|solving")).wait_for(timeout=SOLVED)
    quality.filter(has_text="solved:").wait_for(timeout=SOLVED)
    thicker = frequency.inner_text()
    assert float(thicker.split()[0]) > float(solved.split()[0]) + 1
    keep(page, "lab-design-light-1280")
    page.get_by_role("button", name="Undo").click()
    quality.filter(has_text="solved:").wait_for(timeout=SOLVED)
    page.wait_for_function(
        "text => document.querySelector('.number b').innerText === text", arg=solved, timeout=SOLVED
    )
    page.get_by_role("button", name="Redo").click()
    page.wait_for_function(
        "text => document.querySelector('.number b').innerText === text",
        arg=thicker,
        timeout=SOLVED,
    )
    thickness.fill("2.2")
    thickness.press("Enter")
    page.locator(".error", has_text="no unit").wait_for()
    page.on("dialog", lambda dialog: dialog.accept("thicker"))
    page.get_by_role("button", name="Save…").click()
    page.locator("#notice", has_text="Saved as thicker.toml").wait_for()
    kept = load_display(shared_lab.folder / "thicker.toml")
    assert kept.actuator.thickness == pytest.approx(2.2e-3)  # type: ignore[union-attr]
    page.reload()
    page.locator("input[data-path='actuator.thickness'][type=text]").wait_for()
    assert thickness.input_value() == "2.2 mm"
    assert complaints == []


def test_a_slider_moves_the_curve_and_says_which_model(
    chromium: Browser, shared_lab: RunningLab
) -> None:
    page, complaints = opened(chromium, shared_lab, "design", color_scheme="dark")
    page.locator(".quality", has_text="solved:").wait_for(timeout=SOLVED)
    slider = page.locator("input[type=range][data-path='drive.voltage']")
    amplitude = page.locator(".number b").nth(1)
    before = amplitude.inner_text()
    slider.focus()
    for _ in range(12):
        slider.press("ArrowRight")
    page.wait_for_function(
        "text => document.querySelectorAll('.number b')[1].innerText !== text", arg=before
    )
    assert page.locator("input[type=text][data-path='drive.voltage']").input_value() != "15 V"
    page.locator(".quality", has_text="solved:").wait_for(timeout=SOLVED)
    keep(page, "lab-design-dark-1280")
    assert page.evaluate(CONTRAST) == []
    assert complaints == []


def test_a_texture_is_felt_recorded_replayed_and_saved(
    chromium: Browser, shared_lab: RunningLab
) -> None:
    page, complaints = opened(chromium, shared_lab, "feel")
    page.locator(".parity", has_text="agree, greatest difference 0 m").wait_for(timeout=SOLVED)
    page.get_by_role("button", name="Record").click()
    box = page.locator("canvas.surface").bounding_box()
    assert box is not None
    page.mouse.move(box["x"] + 10, box["y"] + 50)
    page.mouse.down()
    frictions = set()
    for step in range(120):
        page.mouse.move(box["x"] + 10 + 2 * step, box["y"] + 50)
        if step % 6 == 0:
            frictions.add(page.locator(".number b").first.inner_text())
    assert len(frictions) >= 2
    page.mouse.up()
    page.get_by_role("button", name="Stop recording").click()
    keep(page, "lab-feel-light-1280")
    page.get_by_role("button", name="Replay").click()
    page.on("dialog", lambda dialog: dialog.accept("first"))
    page.get_by_role("button", name="Save the stroke…").click()
    page.locator("#notice", has_text="strokes/first.csv").wait_for()
    stroke = read_trajectory(shared_lab.folder / "strokes" / "first.csv")
    assert stroke.duration > 0.05
    felt = (shared_lab.folder / "strokes" / "first.felt.csv").read_text().splitlines()
    assert felt[0].startswith("time_s,x_m,y_m,speed_m_per_s")
    with page.expect_download() as download:
        page.get_by_role("button", name="Download CSV").click()
    text = Path(download.value.path()).read_text()
    assert text.splitlines()[0].startswith("time_s,x_m,y_m")
    assert len(text.splitlines()) > 60
    assert complaints == []


def test_friction_met_and_wanted_are_of_the_same_speed(
    chromium: Browser, shared_lab: RunningLab
) -> None:
    page, complaints = opened(chromium, shared_lab, "feel")
    page.locator(".parity", has_text="agree").wait_for(timeout=SOLVED)
    # An amplitude reached, without a wave: what is met is what is wanted, however fast.
    found = page.evaluate(
        """async () => {
          const { Finger, frictionAt } = await import("/static/finger.js");
          const ready = {
            finger_speed_m_per_s: [0, 0.04, 0.08], lowest_finger_speed_m_per_s: 0.02,
            relative_friction: [[1, 0], [1, 0.2], [1, 0.4]], largest_amplitude_m: 2e-6,
            friction_coefficient: 1, normal_force_N: 1, envelope_time_constant_s: 1e-3,
          };
          return [0, 0.01, 0.04, 0.3].map((speed) => {
            const one = { ready, x: 0, y: 0, speed, direction: 1, wanted: 2e-6, amplitude: 2e-6 };
            const met = Finger.prototype.met.call(one);
            return [met.friction, met.frictionWanted, met.pace, frictionAt(ready, 2e-6, -speed)];
          });
        }"""
    )
    for met, wanted, _, _ in found:
        assert met == wanted
    # At rest as at the slowest that amplitudes are chosen for; linear between; held beyond.
    assert [round(one[0], 9) for one in found] == [0.1, 0.1, 0.2, 0.4]
    assert [one[2] for one in found] == [0.02, 0.02, 0.04, 0.3]
    assert [round(one[3], 9) for one in found] == [0.0, 0.05, 0.2, 0.4]
    box = page.locator("canvas.surface").bounding_box()
    assert box is not None
    page.mouse.move(box["x"] + 30, box["y"] + 30)
    page.mouse.down()
    page.locator(".number small", has_text="at 5 mm/s").wait_for()
    page.mouse.up()
    assert complaints == []


def test_a_grating_is_composed_and_a_picture_dropped(
    chromium: Browser, shared_lab: RunningLab, tmp_path: Path
) -> None:
    import numpy as np
    from tests.pictures import picture_bytes

    page, complaints = opened(chromium, shared_lab, "feel")
    page.locator(".parity", has_text="agree").wait_for(timeout=SOLVED)
    page.get_by_text("Compose a grating").click()
    page.get_by_label("spatial period").fill("8")
    page.get_by_role("button", name="Use this grating").click()
    page.locator(".error", has_text="no unit").wait_for()
    page.get_by_label("spatial period").fill("8 mm")
    page.get_by_label("shape").select_option("sine_wave")
    page.get_by_role("button", name="Use this grating").click()
    page.locator("h2", has_text="sine, 8 mm").wait_for()
    picture = tmp_path / "stripes.png"
    picture.write_bytes(picture_bytes(np.tile([0.0, 1.0], (20, 30))))
    page.locator("input[type=file]").set_input_files(picture)
    page.locator("h2", has_text="stripes, 60 × 20 pixels of 0.2 mm").wait_for()
    page.locator(".parity", has_text="agree").wait_for(timeout=SOLVED)
    assert (shared_lab.folder / "textures" / "stripes.png").exists()
    assert complaints == []


def test_every_quantity_is_explained_and_keys_reach_everything(
    chromium: Browser, shared_lab: RunningLab
) -> None:
    page, complaints = opened(chromium, shared_lab, "help")
    page.get_by_text("relative friction, µ′/µ").wait_for()
    page.goto(f"{shared_lab.address}#feel")
    page.locator(".parity", has_text="agree").wait_for(timeout=SOLVED)
    unknown = page.evaluate(
        """async () => {
          const { GLOSSARY } = await import("/static/glossary.js");
          return [...document.querySelectorAll("[data-tip]")].map((one) => one.dataset.tip)
            .filter((key) => !(key in GLOSSARY));
        }"""
    )
    assert unknown == []
    page.locator("[data-tip=relative_friction]").first.hover()
    assert "fitted to published friction" in page.locator("#tip").inner_text()
    page.locator(".skip").focus()
    reached = set()
    for _ in range(60):
        page.keyboard.press("Tab")
        reached.add(
            page.evaluate(
                "() => document.activeElement.innerText || document.activeElement.className"
            )
        )
    assert {"Design", "Record"} <= reached
    assert any(re.search("surface", one) for one in reached)
    assert page.evaluate(CONTRAST) == []
    assert complaints == []
