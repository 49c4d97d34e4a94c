"""Universal Files written by pyuff and read back, whole, cut short and damaged."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from squeezefilm.core.errors import ConfigError
from squeezefilm.measure.recordings import kinds
from squeezefilm.measure.recordings.files.universal import read_universal
from squeezefilm.measure.recordings.read import check_recording, read_recording

F = np.linspace(29e3, 31e3, 41)
H = 1e-7 / (1 - (F / 30e3) ** 2 + 1j * F / 30e3 / 60)
RESPONSE = """\
kind = "frequency response"
[columns]
frequency = { column = "x", unit = "Hz" }
displacement = { column = "58.1 real", unit = "m/V" }
displacement_imaginary = { column = "58.1 imaginary", unit = "m/V" }
"""
GRID = """\
kind = "grid scan"
frequency = "30 kHz"
[columns]
x = { column = "x", unit = "m" }
y = { column = "y", unit = "m" }
displacement = { column = "VALUE real", unit = "m", given_as = "zero-to-peak" }
displacement_imaginary = { column = "VALUE imaginary", unit = "m", given_as = "zero-to-peak" }
"""
PLACES = np.array([[0.01 * (k % 4), 0.01 * (k // 4), 0.0] for k in range(12)])


def written(path: Path, *sets: dict[str, Any]) -> Path:
    """A Universal File of data sets."""
    import pyuff

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        # In its mode "overwrite" the writer loses the head of binary functions.
        pyuff.UFF(str(path)).write_sets(list(sets), mode="add")
    return path


def function(
    values: Any, node: int = 1, x: Any = F, binary: int = 0, **said: Any
) -> dict[str, Any]:
    """A frequency response as type 58, with what its head says besides."""
    import pyuff

    return dict(
        pyuff.prepare_58(
            binary=binary, func_type=4, rsp_node=node, rsp_dir=3, ref_node=1, ref_dir=3,
            data=values, x=x, id1="vibrometer", id2="", id3="", id4="", id5="", load_case_id=0,
            rsp_ent_name="NONE", ref_ent_name="NONE", abscissa_spacing=1,
            abscissa_spec_data_type=18, orddenom_spec_data_type=13, z_axis_spec_data_type=0,
            byte_ordering=1, **{"ordinate_spec_data_type": 8} | said,
        )
    )  # fmt: skip


def nodes() -> dict[str, Any]:
    """The places of twelve nodes as type 15."""
    import pyuff

    zeros = np.zeros(12, dtype=int)
    x, y, z = PLACES.T
    return dict(
        pyuff.prepare_15(
            node_nums=np.arange(1, 13), def_cs=zeros, disp_cs=zeros, color=zeros, x=x, y=y, z=z
        )
    )


@pytest.mark.parametrize("binary", [0, 1])
def test_a_function_is_read_as_it_was_written(binary: int, tmp_path: Path) -> None:
    path = written(tmp_path / "a.uff", function(H, binary=binary))
    path.with_suffix(".toml").write_text(RESPONSE, encoding="utf-8")
    found = check_recording(path)
    assert isinstance(found.recording, kinds.FrequencyResponse)
    assert np.allclose(found.recording.frequency, F, rtol=1e-6)
    assert np.allclose(found.recording.displacement_per_volt, H, rtol=1e-4)
    assert any("says: vibrometer" in how for _, how in found.facts)


@pytest.mark.parametrize(
    ("said", "told", "message"),
    [
        ({"ordinate_spec_data_type": 11}, None, "holds velocity; write velocity = …"),
        ({"ordinate_spec_data_type": 12}, None, "holds acceleration; export velocity or"),
        ({"ordinate_axis_units_lab": "m", "orddenom_axis_units_lab": "V"}, "um/V", 'unit = "m/V"'),
        ({"ordinate_axis_units_lab": "m", "orddenom_axis_units_lab": "V"}, None, ""),
        ({"ordinate_axis_units_lab": "m"}, None, ""),
    ],
)
def test_a_function_s_own_words_are_told_and_checked(
    said: dict[str, Any], told: str | None, message: str, tmp_path: Path
) -> None:
    path = written(tmp_path / "a.uff", nodes(), function(H, 6, **said))
    text = RESPONSE if told is None else RESPONSE.replace("m/V", told)
    path.with_suffix(".toml").write_text(text, encoding="utf-8")
    if message:
        with pytest.raises(ConfigError, match=message):
            read_recording(path)
        return
    found = check_recording(path)
    assert np.allclose(found.recording.displacement_per_volt, H, rtol=1e-4)
    unit = "unit m/V" if "orddenom_axis_units_lab" in said else "no unit"
    words = f"vibrometer, displacement, {unit}, at node 6 along z (0.01, 0.01, 0 in the file"
    assert any(words in how for _, how in found.facts)


def test_functions_at_nodes_become_a_scan_at_the_frequency_told(tmp_path: Path) -> None:
    shape = np.cos(2 * np.pi * PLACES[:, 0] / 0.02)
    sets = [function(one * H, number) for number, one in enumerate(shape, 1)]
    path = written(tmp_path / "a.unv", nodes(), *sets)
    path.with_suffix(".toml").write_text(GRID.replace("VALUE", "58"), encoding="utf-8")
    scan = read_recording(path)
    assert isinstance(scan, kinds.GridScan)
    assert np.allclose(scan.displacement, shape * H[20], atol=1e-10)
    assert np.allclose(scan.x, PLACES[:, 0])
    path.with_suffix(".toml").write_text(
        GRID.replace("VALUE", "58").replace("30 kHz", "40 kHz"), encoding="utf-8"
    )
    with pytest.raises(ConfigError, match="does not reach the frequency told"):
        read_recording(path)
    mixed = written(
        tmp_path / "c.unv", nodes(), sets[0], function(H, 2, ordinate_spec_data_type=11)
    )
    with pytest.raises(ConfigError, match="several quantities or units"):
        read_universal(mixed, 30e3)
    lonely = written(tmp_path / "b.unv", nodes(), function(H, 77))
    with pytest.raises(ConfigError, match="node 77, whose place no data set of type 15 gives"):
        read_universal(lonely, 30e3)


def test_data_at_nodes_become_a_scan(tmp_path: Path) -> None:
    import pyuff

    shape = np.exp(1j * PLACES[:, 0] * 40)
    data = pyuff.prepare_55(
        model_type=1, id1="m", id2="", id3="", id4="", id5="", analysis_type=5, data_ch=2,
        spec_data_type=8, data_type=5, n_data_per_node=3, r1=0 * shape, r2=0 * shape, r3=shape,
        node_nums=np.arange(1, 13), freq=30e3, freq_step_n=1, load_case=0,
    )  # fmt: skip
    path = written(tmp_path / "a.uff", nodes(), dict(data))
    path.with_suffix(".toml").write_text(
        GRID.replace("VALUE", "r3").replace('"m", given', '"um", given'), encoding="utf-8"
    )
    scan = read_recording(path)
    assert isinstance(scan, kinds.GridScan)
    assert np.allclose(scan.displacement, 1e-6 * shape, atol=1e-10)


def test_damage_is_refused_where_its_data_set_begins(tmp_path: Path) -> None:
    path = written(tmp_path / "a.uff", function(H), function(2 * H))
    whole = path.read_text().split("\n")
    marks = [number for number, line in enumerate(whole, 1) if line.rstrip() == "    -1"]
    broken = {
        "is not closed: the file is cut short": (whole[: marks[2] + 20], marks[2]),
        "cannot be read": ([*whole[:16], "  x" + whole[16][3:], *whole[17:]], marks[0]),
        "its head says 41": ([*whole[:20], *whole[25:]], marks[0]),
    }
    for says, (lines, at) in broken.items():
        path.write_text("\n".join(lines))
        with pytest.raises(ConfigError, match=says) as caught:
            read_universal(path)
        assert caught.value.line == at, says
    path.write_text("no such thing\n")
    with pytest.raises(ConfigError, match="is no Universal File"):
        read_universal(path)
    two = written(tmp_path / "b.uff", function(H), function(H, x=F + 7))
    with pytest.raises(ConfigError, match="stands over another abscissa"):
        read_universal(two)
    with pytest.raises(ConfigError, match=r"no functions \(type 58\)"):
        read_universal(written(tmp_path / "c.uff", nodes()))


@given(at=st.integers(0, 1000), binary=st.sampled_from([0, 1]))
def test_a_file_cut_anywhere_is_refused_or_holds_whole_functions(
    at: int, binary: int, tmp_path_factory: pytest.TempPathFactory
) -> None:
    path = written(tmp_path_factory.mktemp("cut") / "a.uff", function(H, binary=binary), nodes())
    data = path.read_bytes()
    path.write_bytes(data[: at * len(data) // 1000])
    try:
        table = read_universal(path)
    except ConfigError:
        return
    assert table.values.shape == (41, 3)
