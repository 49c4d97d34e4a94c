from __future__ import annotations

from pathlib import Path

import optuna
from optuna.storages import JournalStorage
from optuna.storages.journal import JournalFileBackend

from squeezefilm.search.design.journal import journal


def test_optuna_reads_what_was_written_and_goes_on(tmp_path: Path) -> None:
    """Both ways: the file is Optuna's own."""
    file = tmp_path / "journal.log"
    ours = optuna.create_study(study_name="a", storage=journal(file))
    ours.add_trial(_trial(0.25))
    theirs = optuna.load_study(
        study_name="a", storage=JournalStorage(JournalFileBackend(str(file)))
    )
    theirs.add_trial(_trial(0.5))
    again = optuna.load_study(study_name="a", storage=journal(file))
    assert [one.params["x"] for one in again.trials] == [0.25, 0.5]
    assert again.best_value == 1.25


def test_a_line_that_was_cut_off_costs_itself_only(tmp_path: Path) -> None:
    """As by a computer that lost its power: some of the bytes, or zeros in their place."""
    file = tmp_path / "journal.log"
    ours = optuna.create_study(study_name="a", storage=journal(file))
    ours.add_trial(_trial(0.25))
    before = file.read_bytes()
    ours.add_trial(_trial(0.5))
    cut = file.read_bytes()[len(before) :][:20]
    for rest in (cut, cut[:1], bytes(30)):
        file.write_bytes(before + rest)
        again = optuna.load_study(study_name="a", storage=journal(file))
        assert [one.params["x"] for one in again.trials] == [0.25]
        again.add_trial(_trial(0.75))
        more = optuna.load_study(study_name="a", storage=journal(file))
        assert [one.params["x"] for one in more.trials] == [0.25, 0.75]


def _trial(x: float) -> optuna.trial.FrozenTrial:
    among = {"x": optuna.distributions.FloatDistribution(0.0, 1.0)}
    return optuna.trial.create_trial(params={"x": x}, distributions=among, value=1 + x)
