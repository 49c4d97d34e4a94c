"""A calibrated display in the lab, in a real browser: what was measured beside the model."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from squeezefilm.core.calibration_record import CalibrationRecord, ComparedAnswer, UsedRecording
from squeezefilm.core.config.schema import text_of
from squeezefilm.physics.display import load_display

from .test_lab_areas import CUT_OFF
from .test_lab_pages import CONTRAST, keep, opened

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

    from .conftest import RunningLab

pytestmark = [pytest.mark.chromium, pytest.mark.slow]

# Made up: what stands in a file is shown as it stands there.
RECORD = CalibrationRecord(
    when="2026-11-20",
    version="0.2.0",
    fits=True,
    said=("µ′/µ = 0.40 (0.20–0.60).",),
    recordings=(UsedRecording("scan.csv", "frequency response", "A. Builder", "2026-11-19"),),
    compared=(
        ComparedAnswer(
            "resonance frequency", "40.4 kHz", 1e-4, (0.97, 1.0, 1.03), (0.999, 1.0, 1.001),
            "scan.csv",
        ),
        ComparedAnswer(
            "amplitude per volt", "14 nm/V", 0.01, (0.5, 0.9, 1.5), (0.98, 1.0, 1.02), "scan.csv"
        ),
        ComparedAnswer(
            "relative friction at 1 µm", "0.62", 0.05, (0.3, 0.9, 1.4), (0.9, 1.01, 1.1),
            "friction.csv", 0.62, 1e-6,
        ),
        ComparedAnswer("mass", "12 g", 0.001),
    ),
)  # fmt: skip


def calibrated(folder: Path) -> Path:
    display = load_display("biet2008-stator")
    found = dataclasses.replace(display, calibration=RECORD)
    file = folder / "calibrated.toml"
    file.write_text(text_of(found, found.provenance), encoding="utf-8")
    return file


ORANGE = """(number) => {
  const canvas = document.querySelectorAll(".pair canvas")[number];
  const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
  let found = 0;
  // The diamonds' own colour; curves of that colour are thin, and blended at their edges.
  for (let k = 0; k < data.length; k += 4) {
    const [red, green, blue, alpha] = data.slice(k, k + 4);
    if (red > 160 && green > 55 && green < 95 && blue < 40 && alpha > 250) found += 1;
  }
  return found;
}"""


def compared(page: Page) -> list[str]:
    rows = page.locator(".compared tbody tr")
    return [" ".join(rows.nth(k).inner_text().split()) for k in range(1, rows.count())]


def test_design_shows_what_was_measured_beside_the_model(
    chromium: Browser, shared_lab: RunningLab, tmp_path: Path
) -> None:
    page, complaints = opened(chromium, shared_lab, "design")
    page.get_by_role("button", name="No tour").click()
    card = page.locator("section.card", has_text="Predicted against measured")
    page.locator("#display-choice").wait_for()
    page.locator(".numbers b", has_text="Hz").first.wait_for()
    assert not card.is_visible()
    before = page.evaluate(ORANGE, 1)
    page.locator("input[type=file]").first.set_input_files(calibrated(tmp_path))
    card.wait_for()
    said = card.locator("p.calibrated").inner_text()
    assert "Calibrated on 2026-11-20 from 4 measured numbers of 1 recording" in said
    assert "The model explains them" in said
    rows = compared(page)
    assert len(rows) == 4
    assert "resonance frequency scan.csv 40.4 kHz ± 0.01 %" in rows[0]
    assert "+0 % (−0.1 % to +0.1 %); before −3 % to +3 %" in rows[0]
    assert "the model has none" in rows[3]
    page.locator(".results:not(.older)").wait_for()
    page.wait_for_timeout(200)
    assert page.evaluate(ORANGE, 1) > before + 20, "the measured resonance is not drawn"
    # A bar's two ends are as far from the middle as the interval's ends are from what was measured.
    ends = page.evaluate(
        "() => [...document.querySelectorAll('.compared line.after')].slice(0, 2)"
        ".map((one) => [one.x1.baseVal.value, one.x2.baseVal.value])"
    )
    (left, right), (far_left, far_right) = ends
    assert left < 150 < right
    assert far_left < left
    assert right < far_right
    card.locator("summary").click()
    assert "by A. Builder" in card.inner_text()
    assert page.evaluate(CONTRAST) == []
    keep(page, "design-calibrated")
    for width, height in ((390, 844), (768, 1024), (1280, 900)):
        page.set_viewport_size({"width": width, "height": height})
        assert page.evaluate(CUT_OFF) == [], (width, height)
    page.set_viewport_size({"width": 390, "height": 844})
    card.scroll_into_view_if_needed()
    keep(page, "design-calibrated-390")
    # A drawing folded away has no room to be drawn to scale; two frames pass over it.
    for height in ("0", "30px"):
        page.evaluate(
            "(height) => new Promise((done) => {"
            " document.querySelector('section canvas').style.height = height;"
            " requestAnimationFrame(() => requestAnimationFrame(done)); })",
            height,
        )
    # The reading back of pixels is this test's own.
    assert [one for one in complaints if "getImageData" not in one] == []


def test_one_that_the_model_does_not_explain_says_so(
    chromium: Browser, shared_lab: RunningLab, tmp_path: Path
) -> None:
    file = calibrated(tmp_path)
    text = file.read_text(encoding="utf-8")
    assert text.count("fits = true") == 1
    file.write_text(text.replace("fits = true", "fits = false"), encoding="utf-8")
    page, _ = opened(chromium, shared_lab, "design")
    page.get_by_role("button", name="No tour").click()
    page.locator("#display-choice").wait_for()
    page.locator("input[type=file]").first.set_input_files(file)
    said = page.locator("p.calibrated")
    said.wait_for()
    assert "does NOT explain them" in said.inner_text()
    assert "error" in str(said.get_attribute("class"))
    # Opening another display takes it away.
    page.locator("#display-choice").select_option("preset:biet2008-stator")
    said.wait_for(state="hidden")
