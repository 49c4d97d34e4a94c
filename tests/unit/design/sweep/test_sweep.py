"""Sweeps as a whole, mostly of a stator, whose points take milliseconds."""

import dataclasses
import functools
import os
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import squeezefilm as sf
from squeezefilm.core.errors import InputError
from squeezefilm.core.results import config_hash
from squeezefilm.design.sweep import sweep as sweeps
from squeezefilm.design.sweep.answers import FOLLOWED, AskedNumber
from squeezefilm.design.sweep.followed import FollowedMode
from squeezefilm.design.sweep.points import Answer, KeptAnswers, Point, answer_of
from squeezefilm.design.sweep.sweep import SweepRequest, SweepRun, sweep, sweep_until_stopped
from squeezefilm.design.sweep.swept import NOT_YET, counted
from squeezefilm.physics.plate.solid import working
from squeezefilm.physics.plate.solid.solve import solved_classes

STATOR = "biet2008-stator"
VOLTS = {"voltage": "50 V..100 V:3"}


def test_every_point_is_what_the_verb_says_there() -> None:
    found = sweep(
        STATOR,
        vary={"voltage": ["60 V", "100 V"], "finger.normal_force": "0.4 N, 0.5 N"},
        ask="relative_friction,vibration_amplitude",
    )
    assert found.shape == (2, 2)
    assert found.names == ("relative_friction", "vibration_amplitude_m")
    assert found.settings() == {
        "voltage_V": [60.0, 60.0, 100.0, 100.0], "finger.normal_force_N": [0.4, 0.5, 0.4, 0.5],
    }  # fmt: skip
    for k, volts in enumerate((60.0, 100.0)):
        for j, force in enumerate((0.4, 0.5)):
            display = sf.replaced(STATOR, {"finger.normal_force": force})
            one = sf.predict(display, voltage=volts)
            assert found.grid("relative_friction")[k, j] == one.relative_friction
            assert found.grid("vibration_amplitude")[k, j] == one.vibration_amplitude
    assert (found.answered, found.missing, found.computed, found.kept) == (4, 0, 4, 0)
    assert found.verbs == ("predict",)
    table = found.to_dict()
    assert table["rows"][0]["voltage_V"] == 60.0
    assert table["rows"][0]["reason"] == ""
    with pytest.raises(InputError, match=r"Did you mean 'relative_friction'\?"):
        found.column("relative_fricton")


@pytest.mark.slow
@pytest.mark.parametrize("name", [STATOR, "winfield2007-tpad"])
def test_what_a_sweep_answers_put_in_as_a_question_returns_itself(name: str) -> None:
    volts = [0.5 * sf.load_display(name).drive.voltage, sf.load_display(name).drive.voltage]
    numbers = "vibration_amplitude", "relative_friction"
    driven = sweep(name, vary={"voltage": [f"{v!r} V" for v in volts]}, ask=numbers)
    amplitude, friction = (driven.column(one) for one in driven.names)
    given = sweep(name, vary={"vibration_amplitude": [f"{a!r} m" for a in amplitude.tolist()]},
                  ask=numbers)  # fmt: skip
    wanted = sweep(
        name,
        vary={"wanted_friction": [repr(value) for value in friction.tolist()]},
        ask=("wanted.voltage", "wanted.vibration_amplitude", "wanted.relative_friction"),
    )
    for found, expected in (
        (given.column("vibration_amplitude_m"), amplitude),
        (given.column("relative_friction"), friction),
        (wanted.column("wanted.voltage_V"), volts),
        (wanted.column("wanted.vibration_amplitude_m"), amplitude),
        (wanted.column("wanted.relative_friction"), friction),
    ):
        assert found.tolist() == pytest.approx(list(expected), rel=1e-9, abs=0.0)


def test_a_point_that_cannot_be_is_a_row_with_its_reason() -> None:
    found = sweep(
        STATOR, vary={"actuator.radial_width": ["10 mm", "60 mm"]}, ask=["relative_friction"]
    )
    assert found.answered == 1
    assert np.isnan(found.column("relative_friction")[1])
    assert found.reasons[0] == ""
    assert "radial_width" in found.reasons[1]
    assert found.table()["relative_friction"][1] is None
    with pytest.raises(InputError, match="no point of the sweep can be computed"):
        sweep(STATOR, vary={"actuator.radial_width": ["60 mm", "70 mm"]}, ask="relative_friction")


def test_what_is_kept_is_not_computed_again_and_more_is_asked_for_nothing(tmp_path: Path) -> None:
    first = sweep(STATOR, vary=VOLTS, ask="relative_friction", out=tmp_path)
    again = sweep(
        STATOR, vary={"voltage": "50 V..100 V:5"}, ask="tangential_force,relative_friction",
        out=tmp_path,
    )  # fmt: skip
    assert (first.computed, first.kept) == (3, 0)
    assert (again.computed, again.kept) == (2, 3)
    assert again.column("relative_friction")[::2] == pytest.approx(
        first.column("relative_friction"), rel=0, abs=0
    )
    assert np.isfinite(again.column("tangential_force_N")).all()
    fresh = sweep(STATOR, vary=VOLTS, ask="relative_friction", out=tmp_path, fresh=True)
    assert (fresh.computed, fresh.kept) == (3, 0)


def test_a_sweep_that_is_stopped_keeps_what_it_has_and_goes_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def stopped(point: Point) -> Answer:
        if point.options["voltage"] == 100.0:
            raise KeyboardInterrupt
        return answer_of(point)

    asked = SweepRequest(sf.load_display(STATOR), vary=VOLTS, ask="relative_friction", out=tmp_path)
    with monkeypatch.context() as patched:
        patched.setattr(sweeps, "answer_of", stopped)
        half, why = sweep_until_stopped(asked)
        assert why == "stopped"
        with pytest.raises(KeyboardInterrupt):
            SweepRun(dataclasses.replace(asked, fresh=True)).finish()
    assert half.reasons == ("", "", NOT_YET)
    assert (half.missing, half.answered) == (1, 2)
    whole, why = sweep_until_stopped(asked)
    assert why == ""
    assert (whole.missing, whole.computed, whole.kept) == (0, 1, 2)


def volts(point: Point) -> Answer:
    """Answers without physics, and dies of 13 V."""
    if point.options["voltage"] == 13:
        os._exit(1)
    return Answer({"voltage_V": point.options["voltage"]})


def test_points_of_one_plate_follow_each_other(monkeypatch: pytest.MonkeyPatch) -> None:
    order: list[tuple[float, float]] = []

    def noted(point: Point) -> Answer:
        order.append((point.display.actuator.radial_width, point.options["voltage"]))  # type: ignore[union-attr]
        return volts(point)

    monkeypatch.setattr(sweeps, "answer_of", noted)
    vary = {"voltage": [1.0, 2.0], "actuator.radial_width": ["9 mm", "8 mm"]}
    found = sweep(STATOR, vary=vary, ask="voltage")
    assert order == [(9e-3, 1.0), (9e-3, 2.0), (8e-3, 1.0), (8e-3, 2.0)]
    assert found.column("voltage").tolist() == [1.0, 1.0, 2.0, 2.0]


@pytest.mark.slow
def test_a_point_that_processes_die_of_has_a_reason_and_is_asked_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sweeps, "answer_of", volts)
    vary = {"voltage": [float(k) for k in range(8, 20)]}
    found = sweep(STATOR, vary=vary, ask="voltage", jobs=2, out=tmp_path)
    for volt, reason, value in zip(
        vary["voltage"], found.reasons, found.column("voltage"), strict=True
    ):
        assert ("ended without an answer" in reason) == (volt == 13)
        assert value == volt or volt == 13
    assert len(KeptAnswers(tmp_path)) == 11


def test_progress_says_how_many_are_done_and_how_long_it_takes() -> None:
    told: list[str] = []
    sweep(STATOR, vary=VOLTS, ask="relative_friction", progress=told.append)
    assert told[0] == "0 of 3 points"
    assert re.fullmatch(r"1 of 3 points, (about \d+ s|less than 1 s) left", told[1])
    assert told[-1] == "3 of 3 points"


def test_several_displays_are_an_axis_and_answers_of_one_question_are_shared() -> None:
    found = sweep([STATOR, STATOR], vary=VOLTS, ask="relative_friction")
    assert found.shape == (2, 3)
    assert found.settings()["display"][::3] == [f"{STATOR} (1)", f"{STATOR} (2)"]
    # Those of the second display are copies made now, and not taken from before.
    assert (found.computed, found.kept) == (3, 0)
    first, second = found.grid("relative_friction")
    assert first.tolist() == second.tolist()


def test_a_file_gives_the_points(tmp_path: Path) -> None:
    file = tmp_path / "points.csv"
    file.write_text("voltage,finger.normal_force\n60 V,0.4 N\n100 V,0.5 N\n")
    found = sweep(STATOR, over=file, ask="relative_friction")
    assert found.shape == (2,)
    assert found.settings() == {"voltage_V": [60.0, 100.0], "finger.normal_force_N": [0.4, 0.5]}


@pytest.mark.parametrize(
    ("request_", "message"),
    [
        ({"vary": VOLTS}, "nothing is asked for"),
        ({"ask": "relative_friction"}, "a sweep varies something"),
        ({"vary": {"frequency": "40 kHz"}, "ask": "plate.current"}, "does not go with .* plate"),
        ({"vary": {"wanted_friction": 0.5}, "ask": "relative_friction"}, "goes with friction"),
        ({"vary": {"voltage": 1, "vibration_amplitude": 1e-6}, "ask": "squeeze_number"}, "both"),
        ({"vary": VOLTS, "ask": "lag_m"}, "needs a texture"),
        ({"vary": {"surface": "adhesiv"}, "ask": "relative_friction"}, "Did you mean 'adhesive'"),
        ({"vary": VOLTS, "ask": "relative_friction", "jobs": 0}, "jobs = 0"),
        (
            {"vary": {"voltage": "1 V..9 V:1000", "speed": "1 mm/s..9 mm/s:1000"},
             "ask": "relative_friction"}, "points of the sweep = 1 000 000",
        ),
    ],
)  # fmt: skip
def test_what_cannot_be_asked_is_refused_before_anything_is_computed(
    request_: dict[str, Any], message: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sweeps, "answer_of", lambda _: pytest.fail("computed"))
    with pytest.raises(InputError, match=message):
        sweep(STATOR, **request_)


def test_no_display_is_no_sweep() -> None:
    with pytest.raises(InputError, match="no display to sweep"):
        sweep([], vary=VOLTS, ask="relative_friction")


def test_predict_is_not_asked_where_analyze_is_and_intervals_are_drawn_where_asked() -> None:
    from squeezefilm.design.sweep.sweep import plan_of

    asked, display = "relative_friction,envelope_bandwidth", sf.load_display(STATOR)
    both = plan_of(SweepRequest(display, vary=VOLTS, ask=asked))
    assert both.verbs == ("analyze",)
    assert [both.verb_of(one) for one in both.asked] == ["analyze", "analyze"]
    assert both.points[0][0]["analyze"].samples == 0
    drawn = plan_of(SweepRequest(display, vary=VOLTS, ask="friction.relative_friction_interval"))
    assert drawn.points[0][0]["friction"].samples > 0


def test_texts_that_differ_in_numbers_are_told_once() -> None:
    assert counted(["a of 1.5 mm", "b", "a of 2 mm", "a of 3 mm"]) == (("a of 1.5 mm", 3), ("b", 1))


def test_an_answer_that_lacks_a_number_has_none(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sweeps, "answer_of", lambda _: Answer({}))
    found = sweep(STATOR, vary=VOLTS, ask="relative_friction")
    assert np.isnan(found.column("relative_friction")).all()


@pytest.mark.slow
def test_a_plate_is_solved_once_for_its_voltages_and_forces(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Two plates, each at four points that need no other solve; voltages vary slowest."""
    solves: list[Any] = []

    def counted_solve(asked: Any, **kept: Any) -> Any:
        solves.append(asked.plate)
        return solved_classes(asked, **kept)

    # As if so many plates were kept as a sweep has: one.
    kept = functools.lru_cache(maxsize=1)(working._solid_mode.__wrapped__)
    monkeypatch.setattr(working, "_solid_mode", kept)
    monkeypatch.setattr(working, "solved_classes", counted_solve)
    found = sweep(
        "biet2008-plate",
        vary={
            "voltage": "8 V, 12 V",
            "finger.normal_force": "0.4 N, 0.5 N",
            # No other test has these: what another one solved would not be solved here.
            "actuator.thickness": "1.87 mm, 1.93 mm",
        },
        ask="relative_friction",
    )
    assert found.answered == 8
    assert len(solves) == 2


def test_an_option_of_another_verb_is_refused_with_who_takes_it() -> None:
    with pytest.raises(
        InputError, match=r"asked of predict; it goes with render: ask .* render\.N"
    ):
        sweep(STATOR, vary={"texture": "sine-3mm"}, ask="predict.relative_friction")


def test_a_table_says_of_which_descriptions_it_is() -> None:
    """One hash of one display; a list where there are several, each with its own."""
    one, other = (dataclasses.replace(sf.load_display(STATOR), name=name) for name in "ab")
    asked: dict[str, Any] = {"vary": VOLTS, "ask": "relative_friction"}
    alone = SweepRun(SweepRequest(one, **asked)).result()
    both = SweepRun(SweepRequest([one, other], **asked)).result()
    hashes = [config_hash(display) for display in (one, other)]
    assert alone.provenance["config_sha256"] == hashes[0]
    assert both.provenance["config_sha256"] == hashes
    assert both.provenance["finger"] == one.whose_finger
    # Nothing was computed of either.
    assert both.reasons == (NOT_YET,) * 6
    assert (both.computed, both.kept, both.warnings) == (0, 0, ())
    assert np.isnan(both.column("relative_friction")).all()


def test_modes_that_nothing_drives_have_two_columns(monkeypatch: pytest.MonkeyPatch) -> None:
    """Those that are driven have what is asked; of the others frequency and Q are known."""
    rows = [
        {"frequency_Hz": 30e3 + volts, "quality_factor": 90.0, "modal_mass_kg": 1e-3 * volts}
        for volts in (50, 75, 100)
    ]
    follows = [
        FollowedMode(label, (0, 0, 0), np.ones(3), driven)
        for label, driven in (("moved", True), ("still", False))
    ]
    run = SweepRun(SweepRequest(sf.load_display(STATOR), vary=VOLTS, ask="relative_friction"))
    monkeypatch.setattr(SweepRun, "_modes", lambda _: [{"modes": [row]} for row in rows])
    for key, labels in (
        ("modes.0.modal_mass_kg", ["moved"]),
        ("modes.0.frequency_Hz", ["moved", "still"]),
        ("modes.0.quality_factor", ["moved", "still"]),
    ):
        quantity = key.rpartition(".")[2]
        columns = list(run._columns(AskedNumber(FOLLOWED, key), follows))
        assert [one.name for one in columns] == [f"followed.{label}.{quantity}" for label in labels]
        for column in columns:
            assert column.values.tolist() == [row[quantity] for row in rows]
