"""Changed plates and their working points, of modes that are made up here."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.errors import ContradictionError, InputError
from squeezefilm.core.materials import VACUUM_PERMITTIVITY, ElasticMaterial
from squeezefilm.design.plate import solved
from squeezefilm.design.plate.solved import (
    LOSSLESS,
    with_ceramic_stiffness,
    with_glue,
    with_loss_in_ceramic_alone,
    with_other_data_set,
    working_point,
)
from squeezefilm.physics.display import load_display
from squeezefilm.physics.plate.layout import CeramicPatch, GlueLayer, RectangularPlate
from squeezefilm.physics.uncertainty.parameters import with_values


@dataclasses.dataclass(frozen=True, eq=False)
class Solved:
    """What a working point takes of solved modes: two of them, the first labelled (6,0)."""

    frequencies: np.ndarray
    errors: np.ndarray
    quality_factors: np.ndarray
    open_frequencies: np.ndarray
    labels: tuple[tuple[int, int], ...] = ((6, 0), (8, 0))
    _fields: tuple[Any, ...] = ("large",)
    _again: Any = None

    @property
    def count(self) -> int:
        return self.frequencies.size

    def index(self, label: tuple[int, int]) -> int:
        return self.labels.index(label)


@dataclasses.dataclass
class Bench:
    """Plates whose frequency rises with E and whose amplitude falls with it; and what was asked."""

    solved: list[Any]
    driven: list[tuple[float, np.ndarray]]

    def solve(self, plate: RectangularPlate, *, mode: Any) -> Solved:
        self.solved.append((plate, mode))
        share = plate.substrate.young_modulus / 123e9
        return Solved(
            np.array([20e3, 33e3 * share]), np.array([1.0, 7.0]), np.array([30.0, 60.0]),
            np.array([21e3, 34e3 * share]),
        )  # fmt: skip

    def respond(self, plate: RectangularPlate, frequencies: np.ndarray) -> Any:
        self.driven.append((plate.substrate.young_modulus, frequencies))
        top = 1e-7 * 123e9 / plate.substrate.young_modulus
        maximum = np.full(frequencies.size, 0.5 * top)
        maximum[3] = top

        @dataclasses.dataclass
        class Response:
            maximum: np.ndarray

        return Response(maximum)


@pytest.fixture
def bench(monkeypatch: pytest.MonkeyPatch) -> Iterator[Bench]:
    made = Bench([], [])
    monkeypatch.setattr(solved, "solve_modes", made.solve)
    monkeypatch.setattr(solved, "harmonic_response", made.respond)
    # What is kept of plates that were solved is neither asked here nor left behind.
    kept = (solved._solved, solved._amplitude)
    for one in kept:
        one.cache_clear()
    yield made
    for one in kept:
        one.cache_clear()


@pytest.fixture
def paper() -> RectangularPlate:
    plate = load_display("biet2008-plate").actuator
    assert isinstance(plate, RectangularPlate)
    return plate


def test_a_working_point_is_that_of_its_mode(bench: Bench, paper: RectangularPlate) -> None:
    found = working_point(paper)
    assert (found.label, found.frequency, found.frequency_error) == ((8, 0), 33e3, 7.0)
    assert (found.quality_factor, found.open_frequency) == (60.0, 34e3)
    assert found.largest_per_volt == pytest.approx(1e-7)
    assert bench.solved == [(paper, (8, 0))]
    # Around the mode, by four half-power widths to either side, densest in the middle.
    ((_, swept),) = bench.driven
    assert swept[[0, -1]] == pytest.approx([33e3 * (1 - 4 / 60), 33e3 * (1 + 4 / 60)])
    assert swept[swept.size // 2] == pytest.approx(33e3)
    steps = np.diff(swept)
    assert np.all(steps > 0)
    assert np.argmin(steps) in (swept.size // 2, swept.size // 2 - 1)
    # Within the half-power width there are enough to meet the peak.
    assert np.sum(np.abs(swept / 33e3 - 1) < 0.5 / 60) >= 15
    other = working_point(paper, (6, 0), amplitude=False)
    assert (other.label, other.frequency, other.largest_per_volt) == ((6, 0), 20e3, None)
    assert len(bench.driven) == 1


def test_a_sharp_resonance_is_swept_over_a_per_cent(
    bench: Bench, paper: RectangularPlate, monkeypatch: pytest.MonkeyPatch
) -> None:
    def sharp(plate: RectangularPlate, *, mode: Any) -> Solved:
        return dataclasses.replace(bench.solve(plate, mode=mode), quality_factors=np.full(2, 4e3))

    monkeypatch.setattr(solved, "solve_modes", sharp)
    working_point(paper)
    ((_, swept),) = bench.driven
    assert swept[[0, -1]] == pytest.approx([0.99 * 33e3, 1.01 * 33e3])


def test_a_plate_is_solved_once_and_its_fields_are_not_kept(
    bench: Bench, paper: RectangularPlate
) -> None:
    for _ in range(2):
        working_point(paper)
    assert (len(bench.solved), len(bench.driven)) == (1, 1)
    kept = solved._solved(paper, (8, 0))
    assert (kept._fields, kept._again) == ((), None)


def test_what_was_solved_before_a_kill_is_read_from_disk(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SQUEEZEFILM_CACHE", str(tmp_path))
    steel = ElasticMaterial("steel", 200e9, 0.3, 7800.0)
    ceramic = CeramicPatch(12e-3, 0.0, 16e-3, 20e-3, 0.5e-3)
    paper = load_display("biet2008-plate").actuator
    assert isinstance(paper, RectangularPlate)
    plate = RectangularPlate(40e-3, 20e-3, 1.5e-3, 3, 60.0, steel, paper.ceramic, (ceramic,))
    found = working_point(plate)
    # As in another process, which solves nothing.
    for one in (solved._solved, solved._amplitude):
        one.cache_clear()
    for name in ("solve_modes", "harmonic_response"):
        monkeypatch.setattr(solved, name, None)
    assert working_point(plate) == found
    assert {one.name for one in tmp_path.iterdir()} == {"compared-modes", "compared-amplitudes"}


def test_what_nothing_drives_has_no_amplitude(bench: Bench, paper: RectangularPlate) -> None:
    silent = tuple(dataclasses.replace(patch, electrode="open") for patch in paper.patches)
    undriven = dataclasses.replace(paper, patches=silent)
    assert working_point(undriven).largest_per_volt is None
    assert bench.driven == []


def test_each_way_to_change_a_plate_leaves_the_rest(paper: RectangularPlate) -> None:
    assert with_values(paper, {"thickness": 1e-3}) == dataclasses.replace(paper, thickness=1e-3)
    assert with_values(paper, {"quality_factor": 9.0}) == dataclasses.replace(
        paper, quality_factor=9.0
    )
    assert with_glue(paper, 3e-5, 2e9) == dataclasses.replace(paper, glue=GlueLayer(3e-5, 2e9))
    assert with_other_data_set(with_other_data_set(paper)) == paper
    lossless = with_loss_in_ceramic_alone(paper)
    assert lossless.substrate == dataclasses.replace(paper.substrate, quality_factor=LOSSLESS)


def test_a_softer_ceramic_forgets_what_was_stated_of_the_stiffer_one(
    paper: RectangularPlate,
) -> None:
    full = paper.ceramic.full_constants
    # What is stated twice has to agree: each number as it follows from the other constants.
    free, e = full.free_permittivity_matrix / VACUUM_PERMITTIVITY, full.stress_matrix
    stated = dataclasses.replace(
        full, free_permittivity_11=free[0, 0], free_permittivity_33=free[2, 2],
        stress_coefficient_31=e[2, 0], stress_coefficient_33=e[2, 2],
        stress_coefficient_15=e[0, 4],
    )  # fmt: skip
    given = dataclasses.replace(paper, ceramic=dataclasses.replace(paper.ceramic, constants=stated))
    softer = with_ceramic_stiffness(given, 0.8).ceramic
    assert softer.in_plane_stiffness == pytest.approx(0.8 * paper.ceramic.in_plane_stiffness)
    assert softer.constants is not None
    for pair in (11, 12, 13, 33, 44, 66):
        name = f"compliance_{pair}"
        assert getattr(softer.constants, name) == pytest.approx(getattr(full, name) / 0.8)
    for name in ("free_permittivity_11", "free_permittivity_33", "stress_coefficient_31",
                 "stress_coefficient_33", "stress_coefficient_15"):  # fmt: skip
        assert getattr(softer.constants, name) is None


def test_a_value_of_a_ceramic_takes_the_constants_of_its_kind_along() -> None:
    """By a sweep, a draw or a sensitivity: all stiffnesses, or all d, in proportion."""
    display = load_display("touchpad-glass")
    assert isinstance(display.actuator, RectangularPlate)
    own = display.actuator.ceramic
    assert own.constants is not None
    path = "actuator.ceramic."
    other = with_values(display, {path + "charge_coefficient": 1.2 * own.charge_coefficient})
    found = other.actuator.ceramic  # type: ignore[union-attr]
    assert found == own.scaled(charge=1.2)
    assert found.constants is not None
    for pair in (31, 33, 15):
        name = f"charge_coefficient_{pair}"
        assert getattr(found.constants, name) == pytest.approx(1.2 * getattr(own.constants, name))
    assert found.constants.compliance_11 == own.constants.compliance_11
    both = {"charge_coefficient": 0.9, "in_plane_stiffness": 1.1}
    other = with_values(display, {path + k: by * getattr(own, k) for k, by in both.items()})
    found = other.actuator.ceramic  # type: ignore[union-attr]
    stiffer = own.scaled(stiffness=1.1, charge=0.9).constants
    assert found.constants is not None
    assert stiffer is not None
    assert dataclasses.astuple(found.constants)[:9] == pytest.approx(
        dataclasses.astuple(stiffer)[:9]
    )
    # One of another sign contradicts the constants, as it would in a file.
    with pytest.raises(ContradictionError, match="charge_coefficient"):
        with_values(display, {path + "charge_coefficient": -own.charge_coefficient})
    # Nothing is changed where nothing is asked for, and no factor may turn a sign.
    assert own.scaled() is own
    with pytest.raises(InputError, match="charge"):
        own.scaled(charge=-1.0)
