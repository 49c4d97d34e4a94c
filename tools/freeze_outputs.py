"""Freeze what every read-only verb answers, on every preset and texture, and compare later.

    python tools/freeze_outputs.py freeze FOLDER     # before a change that must not change a number
    python tools/freeze_outputs.py compare FOLDER    # after it: equal to the last digit, or listed

Each case is one command line, run in this process, with its JSON as the answer. A refusal is an
answer too: its message is kept. What differs between two runs of the same code (the time of day,
how long something took) is left out.
"""

from __future__ import annotations

import contextlib
import io
import json
import os
import re
import shlex
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

for _library in ("OMP", "OPENBLAS", "MKL"):
    os.environ.setdefault(f"{_library}_NUM_THREADS", "1")

DISPLAYS = (
    "biet2008-plate",
    "biet2008-stator",
    "winfield2007-tpad",
    "basdogan2020-glass",
    "touchpad-glass",
)
TEXTURES = (
    *(f"biet2008-square-{period}mm" for period in ("0.4", "2", "4", "8", "10")),
    *("bump", "island-map", "noise", "pulse", "sine-3mm", "speed-stretched"),
)
STUDIES = (
    "biet2008-gratings",
    "biet2008-gratings-as-widths",
    "coarseness-magnitude",
    "friction-jnd",
    "period-jnd",
    "period-same-different",
)
_NOT_THE_ANSWER = re.compile(r"(utc|version|created|duration_of_the_run|wall|elapsed|generated)")


def cases() -> Iterator[str]:
    """Every command line, the quick ones first."""
    yield from ("textures --json", "presets --json", "study presets")
    yield from (f"show {display}" for display in DISPLAYS)
    yield from (f"study plan {study} --seed 3 --json" for study in STUDIES)
    yield "film --squeeze-number 10 --excursion 0.5 --json"
    yield "film --squeeze-number 100 --excursion 0.9 --shape disc --json"
    yield "film --squeeze-number 20 --excursion 0.3 --shape rectangle --aspect 2 --json"
    yield "film --squeeze-number 5 --excursion 0.5 --polytropic 1.4 --knudsen 0.026 --json"
    yield "reproduce --json"
    for display in DISPLAYS:
        for texture in TEXTURES:
            yield f"render {texture} --display {display} --stroke '60 mm/s over 1 cm' --json"
    on_plate = "--display biet2008-plate --stroke '60 mm/s over 2 cm' --json"
    yield f"render sine-3mm --compensate inverse --braking {on_plate}"
    yield f"render biet2008-square-2mm --wave compensated {on_plate}"
    for display in DISPLAYS:
        yield f"friction {display} --samples 64 --wanted 0.7 --json"
        yield f"friction {display} --samples 0 --speed '50 mm/s' --force '1 N' --json"
        yield f"analyze {display} --samples 32 --json"
        yield f"analyze {display} --samples 0 --model paper2008 --json"
        yield f"plate {display} --json"
    yield "analyze biet2008-plate --theory timoshenko --samples 0 --json"
    voltages = "--vary 'voltage=5 V..15 V:3'"
    yield f"sweep biet2008-plate {voltages} --ask relative_friction --jobs 1 --json"
    yield "study simulate biet2008-gratings --participants 2 --seed 7 --json"


def answer(case: str) -> Any:
    """What a command line prints: its JSON, its text, or the message with which it refuses."""
    from squeezefilm.cli import app
    from squeezefilm.core.errors import SqueezefilmError

    printed = io.StringIO()
    arguments = shlex.split(case)
    with contextlib.redirect_stdout(printed), contextlib.redirect_stderr(io.StringIO()):
        try:
            app(arguments, standalone_mode=False)
        except SqueezefilmError as error:
            return {"refused": str(error)}
        except SystemExit as end:
            return {"exit": end.code, "printed": printed.getvalue()}
        except Exception as error:  # an unknown option after a change is an answer too
            return {"failed": f"{type(error).__name__}: {error}"}
    text = printed.getvalue()
    return json.loads(text) if "--json" in arguments else text


def leaves(value: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """Every number and text of an answer with its path, without what differs between two runs."""
    if isinstance(value, dict):
        for key, inner in value.items():
            if not _NOT_THE_ANSWER.search(str(key).lower()):
                yield from leaves(inner, f"{path}.{key}")
    elif isinstance(value, list):
        for position, inner in enumerate(value):
            yield from leaves(inner, f"{path}[{position}]")
    else:
        yield path, value


def differences(case: str, before: Any, now: Any) -> list[str]:
    """One line for each leaf that is not what it was."""
    old, new = dict(leaves(before)), dict(leaves(now))
    missing = object()
    return [
        f"{case}: {path or 'text'}: {old.get(path, 'nothing')!r} → {new.get(path, 'nothing')!r}"
        for path in {**old, **new}
        if old.get(path, missing) != new.get(path, missing)
        and not (old.get(path) != old.get(path) and new.get(path) != new.get(path))
    ]


def main() -> int:
    """0 where nothing changed, 1 where something did, 2 for a wrong call."""
    if len(sys.argv) < 3 or sys.argv[1] not in ("freeze", "compare"):
        print(__doc__)
        return 2
    mode, folder, wanted = sys.argv[1], Path(sys.argv[2]).resolve(), sys.argv[3:]
    folder.mkdir(parents=True, exist_ok=True)
    changed = 0
    # Relative paths in answers must not depend on where this was started.
    os.chdir(tempfile.mkdtemp())
    for case in cases():
        if wanted and not any(word in case for word in wanted):
            continue
        name = re.sub(r"[^\w.]+", "-", case).strip("-") + ".json"
        if mode == "compare" and not (folder / name).exists():
            print(f"         not frozen  {case}", flush=True)
            continue
        start = time.monotonic()
        now = json.loads(json.dumps(answer(case)))
        took = time.monotonic() - start
        if mode == "freeze":
            (folder / name).write_text(json.dumps(now, indent=1), encoding="utf-8")
            print(f"{took:6.1f} s  {case}", flush=True)
            continue
        before = json.loads((folder / name).read_text(encoding="utf-8"))
        found = differences(case, before, now)
        changed += len(found)
        print(
            f"{took:6.1f} s  {'equal' if not found else f'{len(found)} differ'}  {case}", flush=True
        )
        for line in found[:8]:
            print(f"    {line[:400]}")
    return 1 if changed else 0


if __name__ == "__main__":
    sys.exit(main())
