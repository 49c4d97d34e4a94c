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


def _trial(x: float) -> optuna.trial.FrozenTrial:
    among = {"x": optuna.distributions.FloatDistribution(0.0, 1.0)}
    return optuna.trial.create_trial(params={"x": x}, distributions=among, value=1 + x)
