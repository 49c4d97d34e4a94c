"""Files of a rendered texture: waveforms, table and page hold what was rendered, or nothing is
written."""

from __future__ import annotations

import dataclasses
import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.unit.core.formats.read_sound import read_sound

from squeezefilm.core.errors import InputError
from squeezefilm.core.formats.traces import csv_text, table_from_csv
from squeezefilm.core.kit import style
from squeezefilm.design.report import texture_page
from squeezefilm.design.report.texture_page import (
    drive_waveform,
    envelope_waveform,
    hjif_export,
    trace_table,
    write_render,
)
from squeezefilm.physics.chain.rendered_texture import RenderAnalysis, render_texture
from squeezefilm.physics.render.motion.stroke import Stroke
from squeezefilm.physics.render.texture.levels import Amplitude, FrictionReduction, RelativeFriction
from squeezefilm.physics.render.texture.shapes import SineWave
from squeezefilm.physics.texture_files.hjif import friction_along
from squeezefilm.physics.texture_files.texture_file import TextureFile

HOSTILE = "<script>alert(1)</script> & more"
SINE = SineWave(2e-3)
FILES = {
    "trace.csv", "envelope.wav", "drive.wav", "texture.hjif", "fidelity.json", "index.html",
    "render-friction.png", "render-drive.png", "render-way.png",
    "render-wave.png",
}  # fmt: skip


def rendered(texture: Any, **changes: Any) -> RenderAnalysis:
    # The paper's closed form: no film to solve. Starts and ends between micrometres.
    stroke = Stroke(0.1, 12.0004e-3, start=1.0003e-3)
    return render_texture(
        "biet2008-stator", TextureFile(texture, HOSTILE), stroke, model="paper2008", **changes
    )


@pytest.fixture(scope="module")
def felt() -> RenderAnalysis:
    return rendered(RelativeFriction(SINE, 0.7, 0.9), wave="felt", seed=7)


@pytest.fixture(autouse=True)
def _quick_pictures(monkeypatch: pytest.MonkeyPatch) -> None:
    # A picture of its title: which goes where is what counts, and PNGs are slow.
    monkeypatch.setattr(style, "png", lambda one: " ".join(one.get_suptitle().split()).encode())


@pytest.fixture(scope="module")
def written(felt: RenderAnalysis, tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    """Everything that can be written, by file name; and what was told meanwhile."""
    folder, told = tmp_path_factory.mktemp("render") / "deep", []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(style, "png", lambda one: " ".join(one.get_suptitle().split()).encode())
        found = write_render(felt, folder, drive=True, hjif=True, progress=told.append)
    assert found == folder / "index.html"
    assert told == ["figures", "trace"]
    return {one.name: one.read_bytes() for one in folder.iterdir()}


def test_the_trace_is_every_step_with_its_origin(felt: RenderAnalysis) -> None:
    table = trace_table(felt)
    assert table.columns["time_s"].size == math.floor(0.120004 * 19200) + 1
    assert table.columns["position_x_m"] is felt.finger.x
    assert table.metadata["texture"] == HOSTILE
    assert table.metadata["display"] == "biet2008-stator"
    assert table.metadata["seed"] == 7


def test_the_envelope_is_the_command_over_the_largest_amplitude(felt: RenderAnalysis) -> None:
    wave = envelope_waveform(felt)
    assert wave.samples is felt.stroke.command
    assert (wave.sample_rate, wave.unit) == (19200, "m")
    assert wave.full_scale == felt.prediction.vibration_amplitude
    assert wave.metadata["quantity"] == "amplitude commanded, zero-to-peak"
    assert wave.metadata["seed"] == 7


def test_the_drive_is_the_command_on_a_carrier_of_its_voltage(felt: RenderAnalysis) -> None:
    wave, p = drive_waveform(felt), felt.prediction
    assert (wave.sample_rate, wave.unit, wave.full_scale) == (192e3, "V", p.voltage)
    at = np.arange(wave.samples.size)
    assert at.size == 10 * felt.stroke.command.size
    level = np.repeat(felt.stroke.command / p.vibration_amplitude, 10)
    expected = (p.voltage or 0) * level * np.sin(2 * np.pi * p.frequency * at / 192e3)
    assert np.max(np.abs(wave.samples - expected)) < 1e-6 * wave.full_scale
    assert wave.metadata["carrier_frequency_Hz"] == p.frequency
    assert wave.metadata["seed"] == 7


def test_a_drive_that_no_converter_gives_is_refused(felt: RenderAnalysis) -> None:
    p, stroke = felt.prediction, felt.stroke
    given = dataclasses.replace(p, voltage=None)
    with pytest.raises(InputError, match="needs a display with a voltage"):
        drive_waveform(dataclasses.replace(felt, prediction=given))
    fast = dataclasses.replace(p, frequency=96e3)
    with pytest.raises(InputError, match="96000 Hz cannot be carried at 192000 samples"):
        drive_waveform(dataclasses.replace(felt, prediction=fast))
    drive_waveform(dataclasses.replace(felt, prediction=dataclasses.replace(p, frequency=95.9e3)))
    odd = dataclasses.replace(stroke, control_rate=19.1e3)
    with pytest.raises(InputError, match="does not divide"):
        drive_waveform(dataclasses.replace(felt, stroke=odd))


def test_an_export_holds_the_friction_whatever_the_texture_is_of(felt: RenderAnalysis) -> None:
    x = np.linspace(1.1e-3, 12.9e-3, 500)
    share = 0.5 + 0.5 * np.sin(2 * np.pi * x / 2e-3)
    # A grating of friction is exported as a wave, exactly; others by keyframes.
    document = hjif_export(felt).document
    assert friction_along(document, x) == pytest.approx(0.7 + 0.2 * share, abs=1e-6)
    assert HOSTILE in document["description"]
    (perception,) = document["perceptions"]
    device = json.dumps(perception["reference_devices"])
    assert "biet2008-stator" in device
    mu = felt.prediction.friction_coefficient
    reduced = hjif_export(rendered(FrictionReduction(SINE, 0.1 * mu, 0.3 * mu)))
    assert friction_along(reduced.document, x) == pytest.approx(0.9 - 0.2 * share, abs=2e-4)
    amplitude = rendered(Amplitude(SINE, 0.2e-6, 1.2e-6))
    law = amplitude.prediction.law.curve(0.2e-6 + 1e-6 * share)
    assert np.ptp(law) > 0.05
    exported = hjif_export(amplitude)
    assert friction_along(exported.document, x) == pytest.approx(law, abs=2e-3)
    # Keyframes lie on whole micrometres around the whole way.
    (band,) = exported.document["perceptions"][0]["channels"][0]["bands"]
    (effect,) = band["effects"]
    last = effect["position"] + effect["keyframes"][-1]["relative_position"]
    assert (effect["position"], last) == (1000, 13001)


def test_all_files_are_written_with_what_they_are_named_after(
    felt: RenderAnalysis, written: dict[str, bytes]
) -> None:
    assert set(written) == FILES
    # All but the first line, which has the time of writing.
    csv = csv_text(trace_table(felt)).partition("\n")[2]
    assert written["trace.csv"].decode().partition("\n")[2] == csv
    assert read_sound(written["envelope.wav"]).samples == pytest.approx(
        felt.stroke.command, abs=1e-12
    )
    volts = read_sound(written["drive.wav"])
    assert volts.samples == pytest.approx(drive_waveform(felt).samples, abs=1e-5)
    data = json.loads(written["fidelity.json"])
    assert data["friction_rms_error"] == pytest.approx(felt.rms_error)
    assert written["fidelity.json"].endswith(b"}\n")
    export = hjif_export(felt)
    assert data["hjif"] == {
        "lost": list(export.lost),
        "rms_error": export.rms_error,
        "largest_error": export.largest_error,
        "made_for_speed_m_per_s": pytest.approx(felt.mean_speed),
        "friction_error_at_half_speed": export.made_for.error_at_half,
        "friction_error_at_double_speed": export.made_for.error_at_double,
    }
    assert export.made_for.sentence() in export.document["description"]
    assert json.loads(written["texture.hjif"]) == export.document
    for name, begin in (
        ("friction", "friction is rendered within"), ("drive", "The drive is at a limit"),
        ("way", "of finger motion over"), ("wave", "Along the wave"),
    ):  # fmt: skip
        assert begin in written[f"render-{name}.png"].decode()


def test_the_page_shows_names_as_text_with_numbers_pictures_and_links(
    felt: RenderAnalysis, written: dict[str, bytes]
) -> None:
    text = written["index.html"].decode()
    escaped = "&lt;script&gt;alert(1)&lt;/script&gt; &amp; more"
    assert "<script>" not in text
    assert f"<title>{escaped}: rendered texture</title>" in text
    assert f"<header><h1>{escaped}</h1>" in text
    assert "rendered on <code>biet2008-stator</code> by squeezefilm" in text
    assert '<tr><th scope="row">RMS error of µ′/µ</th><td>' in text
    assert f"<td>{felt.rms_error:.3f}</td><td>rendered − asked for</td></tr>" in text
    headings = [
        "Numbers", "Friction along the stroke", "Drive and tangential force",
        "The finger's way over the texture", "The standing wave",
        "Warnings",
    ]  # fmt: skip
    places = [text.index(f"<h2>{one.replace(chr(39), '&#x27;')}</h2>") for one in headings]
    assert places == sorted(places)
    assert '<img src="render-wave.png" alt="Along the wave, every' in text
    links = ", ".join(
        f'<a href="{name}">{name}</a>'
        for name in ("drive.wav", "envelope.wav", "fidelity.json", "texture.hjif", "trace.csv")
    )
    assert f"seed 7. Beside this page: {links}.</p>" in text
    warned = felt.prediction.warnings
    assert warned
    assert text.count("<li>") == len(warned)
    assert f"<code>{felt.provenance()['config_sha256']}</code>" in text
    assert "squeezefilm " in text


def test_a_page_without_warnings_says_so_and_without_a_wave_has_no_figure_of_it(
    felt: RenderAnalysis, tmp_path: Path
) -> None:
    quiet = dataclasses.replace(
        felt, wave="ignored", prediction=dataclasses.replace(felt.prediction, warnings=())
    )
    text = write_render(quiet, tmp_path).read_text(encoding="utf-8")
    assert "<ul><li>None.</li></ul>" in text
    names = {one.name for one in tmp_path.iterdir()}
    assert names == FILES - {"drive.wav", "texture.hjif", "render-wave.png"}
    assert "hjif" not in json.loads((tmp_path / "fidelity.json").read_text(encoding="utf-8"))
    assert table_from_csv(tmp_path / "trace.csv").columns["time_s"] == pytest.approx(
        felt.stroke.time
    )


def test_what_cannot_be_written_is_refused_before_anything_is(
    felt: RenderAnalysis, tmp_path: Path
) -> None:
    with pytest.raises(InputError, match="a table cannot be 'xlsx'; it may be csv or parquet"):
        write_render(felt, tmp_path / "new", table="xlsx")
    assert not (tmp_path / "new").exists()
    (tmp_path / "taken").write_text("x")
    with pytest.raises(InputError, match="is a file, not a folder"):
        write_render(felt, tmp_path / "taken")


def test_a_failure_half_way_leaves_the_folder_as_it_was(
    felt: RenderAnalysis, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(texture_page, "drawn_figures", lambda *_: {})
    (tmp_path / "trace.csv").write_text("old")
    # The last file cannot be put in a folder's place.
    (tmp_path / "index.html").mkdir()
    with pytest.raises(InputError, match="cannot write"):
        write_render(felt, tmp_path)
    assert sorted(one.name for one in tmp_path.iterdir()) == ["index.html", "trace.csv"]
    assert (tmp_path / "trace.csv").read_text() == "old"
