"""The lab in a headless Chromium: from an event to what the page shows, and frames while dragging.

Peer: the same quantities by way of the server. Each number is taken in the page by its own clock.
Needs a Chromium and playwright. Run: python benchmarks/lab.py
"""

from __future__ import annotations

import itertools
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from typing import Any

PINGS = """async (count) => {
  const { Socket } = await import("/static/socket.js");
  const socket = new Socket("/ws");
  await new Promise((done) => socket.on("connection", done));
  const took = [];
  for (let k = 0; k < count; k += 1) {
    const began = performance.now();
    await socket.ask("ping");
    took.push(performance.now() - began);
    await new Promise((done) => setTimeout(done, 4));
  }
  return took;
}"""

SLIDES = """async (count) => {
  const slider = document.querySelector("input[type=range][data-path='drive.voltage']");
  const shown = document.querySelectorAll(".number b")[1];
  const took = [];
  for (let k = 0; k < count; k += 1) {
    const changed = new Promise((done) => {
      const watch = new MutationObserver(() => { watch.disconnect(); done(); });
      watch.observe(shown, { childList: true, characterData: true, subtree: true });
    });
    const began = performance.now();
    slider.value = String(40 + 12 * (k % 20));
    slider.dispatchEvent(new Event("input"));
    await changed;
    took.push(performance.now() - began);
    await new Promise((done) => setTimeout(done, 30));
  }
  return took;
}"""

FRAMES = """async (seconds) => {
  const stamps = [];
  await new Promise((done) => {
    const step = (now) => {
      stamps.push(now);
      if (now - stamps[0] < seconds * 1000) requestAnimationFrame(step);
      else done();
    };
    requestAnimationFrame(step);
  });
  return stamps;
}"""


def quantiles(values: list[float]) -> str:
    ordered = sorted(values)
    p50, p95 = (ordered[int(share * (len(ordered) - 1))] for share in (0.5, 0.95))
    return f"p50 {p50:7.2f} ms   p95 {p95:7.2f} ms   ({len(values)} times)"


def started(folder: str) -> tuple[subprocess.Popen[str], str]:
    process = subprocess.Popen(
        [sys.executable, "-c", "from squeezefilm.cli import main; main()",
         "lab", "--no-browser", "--folder", folder, "--port", "8950"],
        stdout=subprocess.PIPE, text=True,
    )  # fmt: skip
    assert process.stdout is not None
    found = re.search(r"http\S+\?token=\S+", process.stdout.readline())
    assert found
    return process, found[0]


def main() -> None:
    from playwright.sync_api import sync_playwright

    path = next(
        (p for n in ("chromium", "chromium-browser", "google-chrome") if (p := shutil.which(n))),
        None,
    )
    if path is None:
        print("no Chromium found; install the package chromium")
        return
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        process, link = started(folder)
        browser = playwright.chromium.launch(executable_path=path, args=["--no-sandbox"])
        try:
            measure(browser.new_page(viewport={"width": 1280, "height": 900}), link)
        finally:
            browser.close()
            process.send_signal(signal.SIGINT)
            process.wait(30)


def measure(page: Any, link: str) -> None:
    address = link.split("?")[0]
    page.goto(link)
    page.locator(".quality", has_text="solved:").wait_for(timeout=120_000)
    slides = page.evaluate(SLIDES, 40)
    print(f"slider → curve, screening        {quantiles(slides)}   aim 200")
    page.goto(f"{address}#feel")
    page.locator(".parity", has_text="agree").wait_for(timeout=120_000)
    box = page.locator("canvas.surface").bounding_box()
    page.mouse.move(box["x"] + 5, box["y"] + 40)
    page.mouse.down()
    page.evaluate(f"window.counted = ({FRAMES})(6); 0")
    began, moves = time.monotonic(), 0
    while time.monotonic() - began < 6:
        page.mouse.move(box["x"] + 5 + (2 * moves) % 280, box["y"] + 40)
        moves += 1
    stamps = page.evaluate("() => window.counted")
    gaps = [b - a for a, b in itertools.pairwise(stamps)]
    rate = 1e3 * len(gaps) / (stamps[-1] - stamps[0])
    late = sum(gap > 1.5 * 1e3 / 60 for gap in gaps) / len(gaps)
    numbers = page.locator(".number").all_inner_texts()
    page.mouse.up()
    shown = next(one for one in numbers if "event" in one).replace("\n", " ")
    print(f"event → friction, in the page    {shown}   aim 1 (p50)")
    print(
        f"frames while dragging            {rate:.1f} a second, {100 * late:.1f} % late by half a "
        f"frame; {moves / 6:.0f} events a second; aim 60"
    )
    pings = page.evaluate(PINGS, 300)
    print(f"event → server → page (the peer) {quantiles(pings)}   aim 5")
    inside = float(re.search(r"([\d.]+) ms", shown)[1])  # type: ignore[index]
    print(f"by the server / in the page      {sorted(pings)[150] / max(inside, 1e-3):.1f}×")
    print("limits: the input pipeline of the browser and, by the server, two processes' wake-ups")


if __name__ == "__main__":
    main()
