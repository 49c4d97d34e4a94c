"""The tables of docs/explanation/perception.md from the answers of the campaign.

    python tools/interval_tables.py

writes them into the page, below the heads that it has. Of each test the last answer counts; parts
of a run are put together. A test asks that the page has these very rows.
"""

from __future__ import annotations

import ast
import json
import re
from pathlib import Path

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs" / "explanation" / "perception.md"
ANSWERS = ROOT / "campaigns" / "statistics.jsonl"
PEOPLE = {
    "constant": "constant stimuli", "adaptive": "adaptive series",
    "same-different": "same or different", "magnitude": "magnitude estimation",
    "same-different, adaptive": "same or different, adaptive series",
    "direction": "direction", "direction, adaptive": "direction, adaptive series",
    "odd-one-out": "odd one out of three", "odd-one-out-of-four": "odd one out of four",
    "odd-one-out, adaptive": "odd one out of three, adaptive series",
    "yes-no": "yes or no", "yes-no, adaptive": "yes or no, adaptive series",
    "detection": "detection", "pairs": "paired comparison", "ranking": "ranking",
    "adjustment": "adjustment",
}  # fmt: skip
PEOPLES_STUDIES = {"magnitude": 2000, "ranking": 2000, "adjustment": 2000}


def printed(test: str, path: Path = ANSWERS) -> list[str]:
    """What the tests whose name begins so printed last, passed or not."""
    last = {}
    for line in path.read_text(encoding="utf-8").splitlines():
        one = json.loads(line)
        if one["test"].split("::")[1].startswith(test):
            last[one["test"]] = one["printed"]
    return [line for text in last.values() for line in text.splitlines()]


def people_rows() -> list[str]:
    """Rows of the table of people together."""
    rows = []
    for line in printed("test_intervals_of_many_studies_hold_the_truth"):
        name, rest = line.split(" {", 1)
        # A task without a spread prints nan for it.
        of = ast.literal_eval(f"{{{rest}".replace(": nan", ": None"))
        cells = [
            "–" if of[part] is None else f"{100 * of[part]:.1f} %"
            for part in ("persons", "population", "spread")
        ]
        cells += [f"{100 * of['error']:+.1f} %", f"{100 * of['named']:.1f} %"]
        rows.append(f"| {PEOPLE[name]} | {PEOPLES_STUDIES.get(name, 500)} | {' | '.join(cells)} |")
    return sorted(rows)


def power_rows() -> list[str]:
    """Rows of the table of errors of the first kind and of power."""
    first = dict(line.split(": ", 1) for line in printed("test_a_pair_that_is_felt_alike"))
    first |= dict(line.split(": ", 1) for line in printed("test_displays_that_are_alike"))
    both = dict(line.split(": ", 1) for line in printed("test_planned_power_is_that_of"))
    both |= dict(line.split(": ", 1) for line in printed("test_planned_contrasts_are"))
    rows = []
    for name in sorted({*first, *both}):
        wrong = re.match(r"([\d.]+)", first.get(name, ""))
        power = re.match(r"planned ([\d.]+).*done ([\d.]+)", both.get(name, ""))
        cells = [wrong.group(1)] if wrong else [""]
        cells += list(power.groups()) if power else ["", ""]
        shown = (f"{100 * float(one):.1f} %" if one else "not yet run" for one in cells)
        rows.append(f"| {name} | {' | '.join(shown)} |")
    return rows


def written(page: str) -> str:
    """The page with these rows below each head."""
    for head, rows in (
        ("| task | studies |", people_rows()),
        ("| task | found where", power_rows()),
    ):
        table = re.compile(
            rf"(^{re.escape(head)}[^\n]*\n\|[-| ]+\n)((?:\|[^\n]*\n)*)", re.MULTILINE
        )
        page, count = table.subn(lambda found, rows=rows: found[1] + "\n".join(rows) + "\n", page)
        assert count == 1, head
    return page


if __name__ == "__main__":
    PAGE.write_text(written(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
