"""A two-interval experiment in PsychoPy whose surfaces squeezefilm plays.

    squeezefilm study plan friction-jnd --participants 12 --orders orders
    python two_surfaces.py orders/order-000.csv answers.csv

Each trial: one surface, the other, and which of them was felt more strongly (arrow keys). A trial
in which the display failed comes again at the end.
"""

import csv
import sys
import time
from pathlib import Path

from psychopy import core, event, visual

import squeezefilm as sf

DISPLAY, DRIVE = "biet2008-plate", "twin"  # or "serial:/dev/ttyACM0"
FELT = 2.0  # seconds for each surface
KEPT = ("display", "trial", "phase", "stimulus", "second_stimulus")
KEYS = {"left": "first", "right": "second", "escape": ""}


def shown(window, text, duration=0.0):
    """Show a text, for a while."""
    visual.TextStim(window, text=text, height=0.08).draw()
    window.flip()
    core.wait(duration)


def felt(window, handle, surface, text):
    """Let a surface be felt; what was played. Raises sf.SqueezefilmError if the display fails."""
    shown(window, "+")
    handle.start(surface)
    until = time.monotonic() + FELT
    while time.monotonic() < until and handle.state == "playing":
        shown(window, text)
    return handle.stop()


def trial(window, handle, design, row):
    """One trial: what is to be kept of it. Ends the experiment on Escape."""
    first = felt(window, handle, design.stimulus(row["stimulus"]), "first surface")
    second = felt(window, handle, design.stimulus(row["second_stimulus"]), "second surface")
    shown(window, "Which was more strongly felt?\n\n<- first     second ->")
    asked = time.monotonic()
    key = event.waitKeys(keyList=list(KEYS))[0]
    answered = time.monotonic()
    handle.mark(f"answer {KEYS[key]}", answered)
    return {
        **{
            name: row[name] for name in ("display", "trial", "phase", "stimulus", "second_stimulus")
        },
        "participant_id": f"participant {row['participant_number']}",
        "choice": KEYS[key],
        "response_time_s": answered - asked,
        "mean_speed_m_per_s": first.exploration.mean_speed,
        "started_monotonic_s": first.started,
        "second_started_monotonic_s": second.started,
        "ended_monotonic_s": answered,
    }


def main(order, answers):
    """All trials of an order file, answered into a CSV file."""
    with Path(order).open(newline="", encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if row["phase"] != "familiarisation"]
    design = sf.plan_study("friction-jnd", participants=1).design
    window = visual.Window(fullscr=True, units="height")
    shown(window, "One moment: the display gets ready")
    with (
        sf.play(DISPLAY, "biet2008-square-4mm", drive=DRIVE, out="records") as handle,
        Path(answers).open("w", newline="", encoding="utf-8") as file,
    ):
        writer = None
        while rows:
            row = rows.pop(0)
            try:
                kept = trial(window, handle, design, row)
            except sf.SqueezefilmError as error:
                print(f"trial {row['trial']} comes again: {error}", file=sys.stderr)
                rows.append(row)
                continue
            if not kept["choice"]:
                break
            if writer is None:
                writer = csv.DictWriter(file, list(kept))
                writer.writeheader()
            writer.writerow(kept)
            file.flush()  # what was answered is kept, whatever comes
    window.close()


if __name__ == "__main__":
    main(*sys.argv[1:])
