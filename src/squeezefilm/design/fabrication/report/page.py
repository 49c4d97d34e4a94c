"""`write_fabrication`: drawing, bodies, bill, plan and description of a display, and their page."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.config.schema import text_of
from squeezefilm.core.errors import InputError
from squeezefilm.core.formats.drawing import Drawing, dxf_text
from squeezefilm.core.kit import style
from squeezefilm.core.kit.folder import csv_text, json_text, require_folder, write_folder
from squeezefilm.core.kit.numbers import HZ, printable, shown
from squeezefilm.core.kit.page_style import (
    as_html,
    bullets,
    links,
    page,
    part,
    rows_section,
    section,
    stamped,
    text_table,
)
from squeezefilm.core.kit.sheet import pdf, sheet_figure, views_figure
from squeezefilm.core.kit.terminal import heading, say, table
from squeezefilm.core.results import stamp
from squeezefilm.design.analysis.report.rows import display_values, electronics_rows
from squeezefilm.design.fabrication.report.plans import rectangular_sheet, round_sheet
from squeezefilm.design.fabrication.report.rows import (
    BILL,
    EXPECTED,
    STEP,
    bill_csv,
    bill_rows,
    expected_rows,
    layout_rows,
    lead_rows,
    plan_csv,
    step_rows,
)
from squeezefilm.design.fabrication.step_file import (
    CHORD_ERROR,
    step_text,
    stl_bytes,
    triangles_of,
    volume_error,
)
from squeezefilm.design.fabrication.test_plan import TestStep
from squeezefilm.design.fabrication.wiring import ANTIPHASE, wiring_said
from squeezefilm.measure.calibration.blind import sealed
from squeezefilm.physics.plate.layout import RectangularPlate

if TYPE_CHECKING:
    from squeezefilm.design.fabrication.fabricate import Fabrication

PREDICTION = "prediction.json"
"""The name of the file that holds what is expected, sealed."""


def write_fabrication(made: Fabrication, folder: Path) -> Path:
    """Write everything that a workshop and a bench need into `folder`; the path of the page.

    A prediction that is there already stays, where it is the one that `made` has; raises
    `InputError` where it is another, and where the folder cannot be written to.
    """
    folder, display = require_folder(folder), made.display
    files: dict[str, str | bytes] = {}
    if made.blind is not None and not made.blind.sha256:
        if (folder / PREDICTION).exists():
            raise InputError(
                f"{folder / PREDICTION} is there already; a prediction is never overwritten, name "
                "another folder"
            )
        files[PREDICTION] = sealed(made.blind)
    drawing = drawing_sheet(made)
    title = f"Drawing of {style.plain(made.display.title, 80)}"
    views = style.svg(views_figure(drawing), "drawing", title)
    head, rows = layout_rows(made)
    files |= {
        "drawing.dxf": dxf_text(drawing),
        "drawing.pdf": pdf(sheet_figure(drawing)),
        "drawing.svg": _alone(style.svg(sheet_figure(drawing), "drawing", title)),
        **_bodies(made),
        "assembly.step": step_text(made.parts, display.name, stamp(display)["created_utc"]),
        "bill-of-materials.csv": bill_csv(made.bill),
        "electrodes.csv": csv_text(head, rows),
        "test-plan.csv": plan_csv(made),
        "display.toml": display_toml(made),
        "display.json": json_text(made.display),
        "fabrication.json": json_text(made.summary()),
    }
    names = [*files, *([PREDICTION] if made.blind is not None and made.blind.sha256 else [])]
    files["index.html"] = _page(made, drawing, views, sorted(names))
    return write_folder(folder, files)


def display_toml(made: Fabrication) -> str:
    """The display as a TOML file that reads back as the same description."""
    display = made.display
    name = printable(display.name)
    return (
        f"# {name}, as it is to be built: drawing.dxf and the other files beside this one are of\n"
        "# these values. It goes into analyze, twin, lab and measure calibrate as it is.\n\n"
        + text_of(display, display.provenance)
    )


def _alone(svg: str) -> str:
    """An SVG that is a file of its own: its colours as they are on paper."""
    for role, (light, _) in style.PALETTE.items():
        svg = svg.replace(f"var(--{role})", light)
    space = 'xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink"'
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + svg.replace("<svg ", f"<svg {space} ", 1)


def _bodies(made: Fabrication) -> dict[str, bytes]:
    """The assembly as one STL, and its parts of each kind as one."""
    by: dict[str, list[si.FloatArray]] = {}
    for body in made.parts:
        by.setdefault(body.kind, []).append(triangles_of(body))
    names = {"substrate": "substrate.stl", "ceramic": "ceramics.stl", "glue": "glue.stl"}
    title = made.display.name
    files = {
        names[kind]: stl_bytes(np.concatenate(surfaces), f"{title}, {kind}")
        for kind, surfaces in by.items()
    }
    whole = np.concatenate([surface for surfaces in by.values() for surface in surfaces])
    return {"assembly.stl": stl_bytes(whole, title), **files}


def _page(made: Fabrication, drawing: Drawing, views: str, names: list[str]) -> str:
    display = made.display
    title, name = as_html(display.title), as_html(display.name)
    parts = [
        section("What to expect", _expected(made)),
        section("Doubts and warnings", bullets(made.prediction.warnings)),
        section("Drawing", _drawing(drawing, views), "figure"),
        section("Ceramics, electrodes and poling", _layout(made)),
        section("Bill of materials", text_table(_BILL_SAID, BILL, bill_rows(made.bill))),
        rows_section("Drive electronics", "Without a finger", electronics_rows(made.load)),
        part("bench", "Test plan for the vibrometer", _PLAN_SAID),
        *(
            section(f"{n}. {escape(step.name)}", _step(step))
            for n, step in enumerate(made.steps, 1)
        ),
        part("assumed", "What is assumed", ""),
        section("What the intervals allow for", _allowed(made)),
        section("Assumed values of the description", _assumed(made)),
        section("Files", f"<p>{links(names)}</p>\n{_files_said(made)}"),
    ]
    stamp = made.summary()["provenance"]
    return page(
        f"{name}: fabrication",
        title,
        f"<code>{name}</code>, to be built and measured",
        "".join(parts),
        f"{stamped(stamp, 'description SHA-256')}.",
    )


_BILL_SAID = (
    "Everything is cut to size: squeezefilm has no maker's catalogue. Leads and foam are not in "
    "the display's mass"
)
_PLAN_SAID = (
    "In this order, without a finger until the last step. Expected is where the built display "
    "should lie; tick what does. Put the recordings into one folder under the names given here, "
    "each with the small TOML file that says what is in it (<code>squeezefilm measure check</code> "
    "asks for what is missing). Then <code>squeezefilm measure calibrate display.toml "
    "FOLDER</code> takes them, and <code>squeezefilm measure score prediction.json FOLDER "
    "display.toml</code> compares them with what was expected."
)


def _expected(made: Fabrication) -> str:
    p = made.prediction
    at = (
        f"{shown(p.voltage, si.Unit('V'))} (zero-to-peak), " if p.voltage else ""
    ) + f"{shown(p.frequency, HZ)}, {p.mode.label}"
    text = text_table(f"At {at}", EXPECTED, expected_rows(made))
    if made.no_intervals:
        text += f"\n<p>Without intervals of the plate: {as_html(made.no_intervals)}.</p>"
    return text


def _drawing(drawing: Drawing, views: str) -> str:
    said = (
        "The views of the A3 sheet that is drawing.pdf and drawing.dxf, in millimetres; print the "
        "PDF at full size."
    )
    return (
        '<figure id="figure-drawing">\n<div class="scroll" tabindex="0" role="region" '
        f'aria-label="Drawing">{views}</div>\n<figcaption>{said}</figcaption>\n</figure>\n'
        f"{bullets(drawing.notes)}"
    )


def _layout(made: Fabrication) -> str:
    head, rows = layout_rows(made)
    text = text_table("Lengths in millimetres, from the corner at x = y = 0", head, rows)
    joined = text_table("Leads", ("Lead", "Electrodes", "To"), lead_rows(made))
    return f"{text}\n<br>\n{joined}\n{bullets(wiring_said(made.electrodes))}"


def _step(step: TestStep) -> str:
    kept = ""
    if step.file:
        kept = f" Kept as <code>{step.file}</code>, kind <code>{step.kind}</code>."
    return f"<p>{as_html(step.do)}{kept}</p>\n" + text_table(
        "What to read", STEP, step_rows(step.checks)
    )


def _allowed(made: Fabrication) -> str:
    if not made.drawn:
        why = made.no_intervals or "no interval was computed"
        return f"<p>Nothing: {as_html(why)}.</p>"
    rows = []
    for parameter in made.drawn:
        low, high = parameter.spread
        whose = "as described" if parameter.origin == "given" else "assumed"
        rows.append((parameter.path, low, high, whose, parameter.source))
    caption = (
        "Plates with these values drawn at once were solved, each with what a solved plate is "
        "believed to be off by itself (assumed)"
    )
    return text_table(caption, ("Value", "From", "To", "Whose", "Why"), rows)


def _assumed(made: Fabrication) -> str:
    rows = [
        (display_value.path, display_value.text, display_value.source or "–")
        for display_value in display_values(made.display)
        if display_value.evidence == "assumed"
    ]
    if not rows:
        return "<p>None.</p>"
    return text_table("Check these before anything is cut", ("Key", "Value", "Source"), rows)


def _files_said(made: Fabrication) -> str:
    missed = max(volume_error(body) for body in made.parts)
    said = "STL files are in millimetres, every body closed by itself."
    if missed:
        said += (
            f" Circles are of flat facets that lie at most {1e6 * CHORD_ERROR:g} µm inside of "
            f"them: {missed:.1g} of the volume is left out."
        )
    return f"<p>{escape(said)}</p>"


def show_fabrication(made: Fabrication) -> None:
    """Print what to expect, the bill and the steps."""
    heading(printable(made.display.title))
    table(EXPECTED[:3], [row[:3] for row in expected_rows(made)], fixed=(0,))
    if made.no_intervals:
        say(f"without intervals of the plate: {printable(made.no_intervals)}")
    heading("Bill of materials")
    rows = [(row[2], row[1], row[3], row[4], row[6]) for row in bill_rows(made.bill)]
    table(("", "", "", "", ""), rows)
    heading("Test plan")
    steps = [(f"{n}", step.name, step.file) for n, step in enumerate(made.steps, 1)]
    table(("", "", ""), steps)
    for text in made.prediction.warnings:
        say(f"! {printable(text)}")


def drawing_sheet(made: Fabrication) -> Drawing:
    """The dimensioned drawing of a display, an A3 sheet."""
    common = tuple(_common(made))
    if isinstance(made.display.actuator, RectangularPlate):
        return rectangular_sheet(made, common)
    return round_sheet(made, common)


def _common(made: Fabrication) -> Iterable[str]:
    """Notes that a workshop needs for every display."""
    groups = {electrode.connection for electrode in made.electrodes}
    if ANTIPHASE in groups:
        yield "A is driven with +V, B with −V. The bonded side of every ceramic is ground."
    else:
        yield "A is driven with +V. The bonded side of every ceramic is ground."
    yield (
        "Poling: a circle with a dot points away from the plate, one with a cross towards it. "
        "Electrodes cover both faces of a ceramic."
    )
    nodal, mode = made.nodal, made.prediction.mode
    if nodal.positions or nodal.radii or nodal.angles:
        said = (
            f"Dash-dotted: nodal lines of {mode.label} at {shown(mode.resonance_frequency, HZ)}, "
            "as computed: where it may be held."
        )
        if nodal.positions:
            said += " They are drawn straight, from where they cross the middle."
        yield said
    yield _tolerances(made)
    evidence = [source.evidence for source in made.display.provenance.values()]
    if assumed := sum(word == "assumed" for word in evidence):
        yield (
            f"{assumed} of {len(evidence)} values of the description are assumed: index.html "
            "lists them. Check them before anything is cut."
        )


def _tolerances(made: Fabrication) -> str:
    given = [
        path
        for path, origin in made.display.provenance.items()
        if origin.distribution is not None and path.startswith("actuator.")
    ]
    if not given:
        return (
            "The description states no tolerance. Agree on tolerances with the workshop: "
            "index.html has what each value is taken to be off by in the expected numbers."
        )
    return (
        "Tolerances stand behind a number where the description states them (± is two standard "
        "deviations); none is stated for the others."
    )
