"""Changes of a plate, and the table of what they do: the plates themselves are made up here."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.errors import ContradictionError, InputError
from squeezefilm.core.materials import VACUUM_PERMITTIVITY, ElasticMaterial
from squeezefilm.design.plate import sensitivity
from squeezefilm.design.plate.sensitivity import (
    LOSSLESS,
    Change,
    plate_sensitivity,
    usual_changes,
    with_ceramic_stiffness,
    with_glue,
    with_loss_in_ceramic_alone,
    with_open_ceramics,
    with_other_data_set,
    working_point,
)
from squeezefilm.physics.display import load_display
from squeezefilm.physics.plate.layout import CeramicPatch, GlueLayer, RectangularPlate
from squeezefilm.physics.uncertainty.parameters import with_values


@dataclasses.dataclass(frozen=True, eq=False)
class Solved:
    """What the table asks of solved modes: two of them, the first labelled (6,0)."""

    frequencies: np.ndarray
    errors: np.ndarray
    quality_factors: np.ndarray
    open_frequencies: np.ndarray
    shapes: np.ndarray
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
    """Plates whose frequency rises with E, whose amplitude falls with it, and whose shape turns
    with the density; and what was asked for."""

    solved: list[Any]
    driven: list[tuple[float, np.ndarray]]

    def solve(self, plate: RectangularPlate, *, mode: Any) -> Solved:
        self.solved.append((plate, mode))
        share = plate.substrate.young_modulus / 123e9
        turn = np.radians(90 * (plate.substrate.density / 8250 - 1))
        shape = np.array([[np.cos(turn), np.sin(turn), 0.0]])
        other = np.array([[0.0, 0.0, 1.0]])
        return Solved(
            np.array([20e3, 33e3 * share]), np.array([1.0, 7.0]), np.array([30.0, 60.0]),
            np.array([21e3, 34e3 * share]), np.stack([other, shape]),
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
    monkeypatch.setattr(sensitivity, "solve_modes", made.solve)
    monkeypatch.setattr(sensitivity, "harmonic_response", made.respond)
    # What is kept of plates that were solved is neither asked here nor left behind.
    kept = (sensitivity._solved, sensitivity._amplitude)
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


def with_modulus(plate: RectangularPlate, value: float) -> RectangularPlate:
    return with_values(plate, {"substrate.young_modulus": value})


def with_density(plate: RectangularPlate, value: float) -> RectangularPlate:
    return with_values(plate, {"substrate.density": value})


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

    monkeypatch.setattr(sensitivity, "solve_modes", sharp)
    working_point(paper)
    ((_, swept),) = bench.driven
    assert swept[[0, -1]] == pytest.approx([0.99 * 33e3, 1.01 * 33e3])


def test_a_plate_is_solved_once_and_its_fields_are_not_kept(
    bench: Bench, paper: RectangularPlate
) -> None:
    for _ in range(2):
        working_point(paper)
    assert (len(bench.solved), len(bench.driven)) == (1, 1)
    kept = sensitivity._solved(paper, (8, 0))
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
    for one in (sensitivity._solved, sensitivity._amplitude):
        one.cache_clear()
    for name in ("solve_modes", "harmonic_response"):
        monkeypatch.setattr(sensitivity, name, None)
    assert working_point(plate) == found
    assert {one.name for one in tmp_path.iterdir()} == {"compared-modes", "compared-amplitudes"}


def test_what_nothing_drives_has_no_amplitude(bench: Bench, paper: RectangularPlate) -> None:
    assert working_point(with_open_ceramics(paper)).largest_per_volt is None
    assert bench.driven == []


def test_the_table_has_relative_shifts_and_likeness(bench: Bench, paper: RectangularPlate) -> None:
    told: list[str] = []
    changes = [
        Change("E", "half", lambda plate: with_modulus(plate, 123e9 / 2)),
        Change(
            "E",
            "more",
            lambda plate: with_modulus(plate, 1.1 * 123e9),
            True,
        ),
        Change("mass", "a third", lambda plate: with_density(plate, 8250 * 4 / 3)),
        Change("terminals", "open", with_open_ceramics),
    ]
    table = plate_sensitivity(paper, changes, progress=told.append)
    assert table.reference == working_point(paper)
    half, more, mass, terminals = table.rows
    assert (half.name, half.change, half.frequency) == ("E", "half", 16.5e3)
    assert half.frequency_shift == pytest.approx(-0.5)
    assert half.largest_per_volt == pytest.approx(2e-7)
    assert half.amplitude_shift == pytest.approx(1.0)
    assert half.likeness == pytest.approx(1.0)
    assert more.frequency_shift == pytest.approx(0.1)
    assert (more.largest_per_volt, more.amplitude_shift) == (None, None)
    # Turned by 30°: the square of the cosine.
    assert mass.likeness == pytest.approx(0.75)
    assert (terminals.largest_per_volt, terminals.amplitude_shift) == (None, None)
    assert told == [
        "the unchanged plate", "change 1 of 4: E half", "change 2 of 4: E more",
        "change 3 of 4: mass a third", "change 4 of 4: terminals open",
    ]  # fmt: skip


def test_without_amplitudes_nothing_is_driven(bench: Bench, paper: RectangularPlate) -> None:
    changes = [Change("E", "half", lambda plate: with_modulus(plate, 123e9 / 2))]
    table = plate_sensitivity(paper, changes, amplitude=False)
    assert table.reference.largest_per_volt is None
    assert (table.rows[0].largest_per_volt, table.rows[0].amplitude_shift) == (None, None)
    assert bench.driven == []


def test_an_undriven_plate_that_gets_driven_has_no_shift(
    bench: Bench, paper: RectangularPlate
) -> None:
    table = plate_sensitivity(with_open_ceramics(paper), [Change("all", "on", lambda _: paper)])
    assert table.reference.largest_per_volt is None
    assert table.rows[0].largest_per_volt == pytest.approx(1e-7)
    assert table.rows[0].amplitude_shift is None


def test_a_mode_that_moves_in_another_shape_is_not_compared(
    bench: Bench, paper: RectangularPlate
) -> None:
    for degrees, likeness in ((60, "0.25"), (40, "0.59")):
        turned = Change(
            "mass",
            "up",
            lambda p, a=degrees: with_density(p, 8250 * (1 + a / 90)),
        )  # type: ignore[misc]
        with pytest.raises(InputError, match=rf"mass up the mode \(8, 0\).*{likeness}, at least"):
            plate_sensitivity(paper, [turned], label=(8, 0))
    table = plate_sensitivity(paper, [Change("m", "up", lambda p: with_density(p, 8250 * 1.4))])
    assert table.rows[0].likeness == pytest.approx(np.cos(np.radians(36)) ** 2)


def test_usual_changes_are_those_of_the_papers_plate(paper: RectangularPlate) -> None:
    """The list in the specification; each makes what it says, of another plate too."""
    found: dict[tuple[str, str], Change] = {(c.name, c.change): c for c in usual_changes(paper)}
    c11 = paper.ceramic.in_plane_stiffness
    expected: dict[tuple[str, str], tuple[Callable[[RectangularPlate], float], float]] = {
        ("plate Young's modulus", "115 GPa"): (lambda p: p.substrate.young_modulus, 115e9),
        ("plate Young's modulus", "131 GPa"): (lambda p: p.substrate.young_modulus, 131e9),
        ("ceramic stiffness c11_p", "−10 %"): (lambda p: p.ceramic.in_plane_stiffness, 0.9 * c11),
        ("ceramic stiffness c11_p", "+10 %"): (lambda p: p.ceramic.in_plane_stiffness, 1.1 * c11),
        ("plate thickness", "1.95 mm"): (lambda p: p.thickness, 1.95e-3),
        ("plate thickness", "2.05 mm"): (lambda p: p.thickness, 2.05e-3),
        ("ceramic thickness", "950 µm"): (lambda p: p.ceramic_thickness, 0.95e-3),
        ("ceramic thickness", "1.05 mm"): (lambda p: p.ceramic_thickness, 1.05e-3),
        ("plate density", "8140 kg/m³"): (lambda p: p.substrate.density, 8140.0),
        ("plate density", "8360 kg/m³"): (lambda p: p.substrate.density, 8360.0),
        ("plate Poisson's ratio", "0.27"): (lambda p: p.substrate.poisson_ratio, 0.27),
        ("plate Poisson's ratio", "0.33"): (lambda p: p.substrate.poisson_ratio, 0.33),
        ("quality factor, all materials", "60 → 48"): (lambda p: p.quality_factor, 48.0),
        ("quality factor, all materials", "60 → 72"): (lambda p: p.quality_factor, 72.0),
        ("losses", "in the ceramic alone"): (lambda p: p.substrate.quality_factor or 0, 1e5),
    }
    for key, (read, value) in expected.items():
        assert read(found.pop(key).make(paper)) == pytest.approx(value), key
    for modulus, text in ((3e9, "3 GPa"), (1e9, "1 GPa")):
        for thickness, size in ((20e-6, "20 µm"), (50e-6, "50 µm")):
            glue = found.pop((f"glue of {text}", size)).make(paper).glue
            assert glue is not None
            assert (glue.thickness, glue.young_modulus) == pytest.approx((thickness, modulus))
    terminals = found.pop(("ceramics open", "each on its own"))
    assert terminals.frequency_only
    assert {p.electrode for p in terminals.make(paper).patches} == {"open"}
    (rest,) = found.values()
    assert (rest.name, rest.change) == ("ceramic data set", "from_d31 → printed_e31")
    assert rest.make(paper).ceramic.data_set == "printed_e31"
    assert sum(c.frequency_only for c in usual_changes(paper)) == 1


def test_what_is_known_of_a_plate_is_not_changed(paper: RectangularPlate) -> None:
    def names(plate: RectangularPlate) -> set[str]:
        return {change.name for change in usual_changes(plate)}

    # Of a glued plate the glue that it has is varied, of another one glues that it may have.
    glued = {one for one in names(with_glue(paper, 20e-6, 2e9)) if "glue" in one}
    assert glued == {"glue thickness", "glue Young's modulus"}
    # Materials that have their own losses have no quality factor of the whole.
    own = names(with_loss_in_ceramic_alone(paper))
    assert not {"quality factor, all materials", "losses"} & own
    bare = dataclasses.replace(paper.ceramic, stress_coefficient=None)
    assert "ceramic data set" not in names(dataclasses.replace(paper, ceramic=bare))
    soft = dataclasses.replace(paper.substrate, poisson_ratio=0.48)
    changes = usual_changes(dataclasses.replace(paper, substrate=soft))
    ratios = [c.change for c in changes if c.name == "plate Poisson's ratio"]
    assert ratios == ["0.45", "0.49"]  # what is incompressible cannot be solved
    other = with_other_data_set(paper)
    assert [c.change for c in usual_changes(other) if "data set" in c.name] == [
        "printed_e31 → from_d31"
    ]


def test_each_way_to_change_a_plate_leaves_the_rest(paper: RectangularPlate) -> None:
    assert with_values(paper, {"thickness": 1e-3}) == dataclasses.replace(paper, thickness=1e-3)
    assert with_values(paper, {"quality_factor": 9.0}) == dataclasses.replace(
        paper, quality_factor=9.0
    )
    assert with_glue(paper, 3e-5, 2e9) == dataclasses.replace(paper, glue=GlueLayer(3e-5, 2e9))
    assert with_other_data_set(with_other_data_set(paper)) == paper
    lossless = with_loss_in_ceramic_alone(paper)
    assert lossless.substrate == dataclasses.replace(paper.substrate, quality_factor=LOSSLESS)
    shunted = dataclasses.replace(paper.patches[0], electrode="shunted", shunt_resistance=1e3)
    plate = dataclasses.replace(paper, patches=(shunted, *paper.patches[1:]))
    opened = with_open_ceramics(plate).patches
    assert opened == tuple(dataclasses.replace(one, electrode="open") for one in paper.patches)


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
