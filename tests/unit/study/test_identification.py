"""The whole analysis: right numbers in the summary, honest notes where data are too few."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.known_observers import ordered_observer

from squeezefilm.core.errors import InputError
from squeezefilm.study.identification.analysis import analyze_identification

LABELS = ("0.4 mm", "2 mm", "4 mm", "8 mm", "10 mm")


def trials(people: int, per: int, spacing: float = 1.5) -> dict[str, Any]:
    """Trials of people who all follow one ordered observer."""
    random = np.random.default_rng(7)
    who = np.repeat(np.arange(people), 5 * per)
    stimulus = np.tile(np.repeat(np.arange(5), per), people)
    edges = np.cumsum(ordered_observer(spacing), axis=0).T[stimulus]
    choice = (random.random(who.size)[:, None] > edges[:, :4]).sum(axis=1)
    return {"participant": who, "stimulus": stimulus, "choice": choice}


def test_summary_has_the_papers_layout() -> None:
    data = trials(12, 5)
    found = analyze_identification(**data, labels=LABELS, origin="simulated", resamples=200)
    summary = json.loads(json.dumps(found.summary(), allow_nan=False))
    for answer in range(5):
        for shown in range(5):
            pair = (data["choice"] == answer) & (data["stimulus"] == shown)
            assert summary["confusion"][answer][shown] == pair.sum()
    assert summary["proportion_correct"] == np.mean(data["choice"] == data["stimulus"])
    assert np.sum(summary["confusion_percent"], axis=0) == pytest.approx([100] * 5)
    assert summary["information_transfer_bit"] == pytest.approx(1.06, abs=0.2)
    assert summary["information_transfer_estimator"] == "jackknife by stimulus"
    assert summary["origin"] == "simulated"
    assert {i["method"] for i in summary["proportion_correct_intervals"]} == {
        "Wilson", "participant bootstrap",
    }  # fmt: skip
    assert summary["sensitivity"]["total"] == pytest.approx(6, abs=1)
    assert summary["permutation_p"] < 0.01
    assert summary["provenance"]["seed"] == 0


def test_the_same_seed_gives_the_same() -> None:
    data = trials(6, 2)
    one, other = (
        analyze_identification(**data, labels=LABELS, resamples=50, seed=3).summary()
        for _ in range(2)
    )
    for summary in (one, other):
        del summary["provenance"]["created_utc"]
    assert one == other


def test_names_and_order_of_trials_do_not_matter() -> None:
    data = trials(6, 2)
    turned = {key: value[::-1] for key, value in data.items()}
    turned["participant"] = np.array([f"p{who:02d}" for who in turned["participant"]])
    one, other = (
        analyze_identification(**d, labels=LABELS, resamples=50).summary() for d in (data, turned)
    )
    for summary in (one, other):
        del summary["provenance"]
    assert one == other


def test_one_person_is_said_to_be_one() -> None:
    found = analyze_identification(**trials(1, 12), labels=LABELS, resamples=50)
    assert found.main_number.method == "Wilson"
    assert any("one participant" in note for note in found.notes)
    assert found.information.interval is None


def test_the_papers_own_size_has_one_answer_a_person() -> None:
    data = trials(12, 1)
    found = analyze_identification(
        **data, labels=LABELS, resamples=50, response_time=np.full(60, 2.0)
    )
    assert found.matrix.trials == 60
    json.dumps(found.summary(), allow_nan=False)


@settings(settings.get_profile("dear"))
@given(
    st.lists(st.tuples(st.integers(0, 3), st.integers(0, 2), st.integers(0, 2)), min_size=1,
             max_size=12),
)  # fmt: skip
def test_no_trials_are_too_odd_to_analyse(rows: list[tuple[int, int, int]]) -> None:
    who, stimulus, choice = (list(column) for column in zip(*rows, strict=True))
    found = analyze_identification(who, stimulus, choice, ("a", "b", "c"), resamples=20)
    json.dumps(found.summary(), allow_nan=False)
    assert (found.sensitivity is None) == any(note.startswith("d′: d′") for note in found.notes)
    assert found.proportion_correct in found.main_number


def test_times_and_exploration_come_by_stimulus() -> None:
    data = trials(8, 3)
    random = np.random.default_rng(1)
    times = 0.5 + 0.5 * data["stimulus"] + random.exponential(0.2, data["stimulus"].size)
    found = analyze_identification(
        **data, labels=LABELS, resamples=50, response_time=times,
        exploration={"mean_speed_m_per_s": 0.08 + 0 * times},
    )  # fmt: skip
    means = [item.geometric_mean for item in found.response_times]
    assert means == sorted(means)
    assert found.exploration["mean_speed_m_per_s"][4].mean == pytest.approx(0.08)
    assert "geometric_mean_s" in found.summary()["response_times"][0]


def test_one_label_is_refused() -> None:
    with pytest.raises(InputError, match="at least 2"):
        analyze_identification([0], [0], [0], ("a",))
