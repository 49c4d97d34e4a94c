"""Yes–no, direction and detection: known people are found again, beside a probit model's numbers;
a session of each goes from its plan to its page and its exports."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path

import numpy as np
import pytest
from scipy.special import ndtr, ndtri

from squeezefilm.core.errors import InputError
from squeezefilm.physics.perception.senses import D_PRIME_OF_75
from squeezefilm.study.conduct.run import Acknowledgement, Presentation
from squeezefilm.study.conduct.terminal_run import Desk, open_study, run_session
from squeezefilm.study.design.plan import plan_study
from squeezefilm.study.design.study_design import StudyDesign, load_design
from squeezefilm.study.design.tasks.surfaces import DETECTION, DIRECTION, QUARTILE, YES_NO
from squeezefilm.study.design.tasks.task import Percepts
from squeezefilm.study.record.answers import Answers
from squeezefilm.study.record.exports import export_study
from squeezefilm.study.report.page import write_study
from squeezefilm.study.simulated.planned_power import pair_scores
from squeezefilm.study.simulated.planned_precision import person_values
from squeezefilm.study.tasks.analyze import analyze_answers, analyze_study
from squeezefilm.study.tasks.findings import TaskAnalysis
from squeezefilm.study.tasks.measures import comparisons
from squeezefilm.study.tasks.thresholds import on_grid

PRESETS = (
    "friction-yes-no",
    "period-direction",
    "friction-detection",
    "period-odd-one-out",
    "period-pairs",
    "period-ranking",
    "period-adjustment",
    "friction-limits",
)
DEPTHS = load_design("friction-yes-no")


def made_up(
    design: StudyDesign, people: int, deviation: float, bias: float, seed: int, lapse: float = 0.02
) -> Answers:
    """Answers of people who give the counted one with Φ((Δ − bias)/deviation), and lapse."""
    random = np.random.default_rng(seed)
    plans = [[t for t in s if t.asks] for s in plan_study(design, people).schedules]
    rows = [trial for plan in plans for trial in plan]
    surfaces = (*design.stimuli, *(one.stimulus for one in design.catch))
    number = {one.name: k for k, one in enumerate(surfaces)}
    shown = np.array([[number[name] for name in trial.stimuli] for trial in rows]).T
    nothing, none = np.full(len(rows), np.nan), np.full(len(rows), -1)
    answers = Answers(
        design=design,
        origin="made up",
        people=tuple(f"p{k}" for k in range(people)),
        surfaces=surfaces,
        participant=np.repeat(np.arange(people), len(plans[0])),
        number=np.array([trial.number for trial in rows]),
        phase=np.array([trial.phase for trial in rows]),
        display=np.zeros(len(rows), dtype=np.int64),
        series=none,
        presented=shown,
        intensity=nothing,
        choice=none,
        right=np.array([(*design.answers, "").index(trial.answer) for trial in rows]),
        estimate=nothing,
        response_time=nothing,
    )
    right = np.where(answers.right == len(design.answers), -1, answers.right)
    counted = ndtr((answers.differences - bias) / deviation)
    said = random.random(len(rows)) < 0.5 * lapse + (1 - lapse) * counted
    return dataclasses.replace(answers, right=right, choice=np.where(said, 0, 1))


def analysed(answers: Answers) -> TaskAnalysis:
    (found,) = analyze_answers(answers, "made up").values()
    assert isinstance(found, TaskAnalysis)
    return found


@pytest.mark.parametrize(
    ("name", "deviation", "bias", "threshold", "measure"),
    [
        ("friction-yes-no", 0.025, 0.03, D_PRIME_OF_75 * 0.025, "threshold"),
        ("friction-detection", 0.04, 0.005, QUARTILE * 0.04, "threshold"),
        ("period-direction", 0.12, 0.05, math.expm1(QUARTILE * 0.12), "Weber fraction"),
    ],
)
def test_a_known_threshold_comes_back_to_its_page(
    name: str, deviation: float, bias: float, threshold: float, measure: str, tmp_path: Path
) -> None:
    design = load_design(name)
    answers = made_up(design, 8, deviation, bias, 3)
    found = analysed(answers)
    assert found.measure == measure
    assert found.pooled is not None
    assert found.pooled.low < threshold < found.pooled.high
    assert found.pooled.high / found.pooled.low < 1.8
    assert found.screening is not None
    assert not found.screening.named
    assert design.spoken_question in found.methods
    assert "mixed model" in found.methods
    if name == "friction-yes-no":
        page = write_study(found, tmp_path / "page").read_text(encoding="utf-8")
        assert "Half of the answers are “yes” at" in page
    shares = [one.share.value for one in found.conditions if one.share is not None]
    assert shares[-1] > shares[0] + 0.3
    scores = pair_scores(answers, design.reference, design.stimuli[-1].name)
    assert scores.mean() > 0.3
    assert person_values(answers.main(0))[0] == measure


@pytest.mark.slow
def test_yes_no_agrees_with_a_probit_model_of_all_answers() -> None:
    api = pytest.importorskip("statsmodels.api")
    design = dataclasses.replace(DEPTHS, repetitions=30)
    main = made_up(design, 1, 0.02, 0.03, 5, lapse=0.0).main(0)
    probit = api.families.Binomial(api.families.links.Probit())
    model = api.GLM(main.told.astype(float), api.add_constant(main.differences), family=probit)
    constant, slope = model.fit().params
    (mine,) = on_grid(main).estimates(0.95)
    # Ours holds lapses possible, which the probit model does not.
    assert mine.estimate.value == pytest.approx(D_PRIME_OF_75 / slope, rel=0.15)
    assert on_grid(main).bias[0] == pytest.approx(-constant / slope, rel=0.1)


def test_d_prime_and_false_alarms_are_those_of_the_rates() -> None:
    answers = made_up(DEPTHS, 6, 0.02, 0.03, 7)
    found = analysed(answers)
    main = answers.main(0)
    flat = main.presented[0] == [one.name for one in main.surfaces].index("flat")
    alarms = found.more["false alarms (no called yes)"]
    rates = [main.told[flat & (main.participant == k)].mean() for k in range(6)]
    assert alarms.value == pytest.approx(np.mean(rates))
    last = next(one for one in found.conditions if one.name == "6 %")
    assert last.d_prime is not None
    assert last.d_prime.value == pytest.approx(0.06 / 0.02, abs=0.9)
    half = found.more["half of the answers are “yes” at"]
    assert half.low < 0.03 < half.high
    other, hit = comparisons(main)
    assert np.array_equal(other, main.presented[0])
    assert np.array_equal(hit, main.choice == 0)


def test_somebody_who_always_says_yes_is_named() -> None:
    answers = made_up(DEPTHS, 6, 0.02, 0.03, 9)
    always = dataclasses.replace(
        answers, choice=np.where(answers.participant == 2, 0, answers.choice)
    )
    found = analysed(always)
    assert found.screening is not None
    assert [one.person for one in found.screening.named] == ["p2"]


def test_an_orientation_is_judged_in_its_own_unit() -> None:
    turned = tuple(
        dataclasses.replace(DEPTHS.stimuli[-1], name=f"{angle} deg", orientation=angle)
        for angle in (-0.3, -0.1, 0.0, 0.1, 0.3)
    )
    design = load_design("period-direction")
    design = dataclasses.replace(
        design, stimuli=turned, reference="0.0 deg", judged="orientation", catch=(), repetitions=12
    )
    found = analysed(made_up(design, 4, 0.15, 0.0, 2))
    assert found.measure == "threshold"
    assert found.pooled is not None
    assert found.pooled.low < QUARTILE * 0.15 < found.pooled.high
    assert "standard_rad" in found.summary()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"reference": "1 %"}, "flat one"),
        ({"reference": ""}, "flat one"),
        ({"judged": "spatial_period"}, "flat one"),
        ({"task": "direction"}, "has no friction_depth"),
    ],
)
def test_what_cannot_be_detected_is_refused(change: dict[str, str], message: str) -> None:
    with pytest.raises(InputError, match=message):
        dataclasses.replace(DEPTHS, catch=(), **change)  # type: ignore[arg-type]


def test_who_perceives_clearly_answers_rightly() -> None:
    felt, one = np.ones((2, 2), dtype=bool), np.ones(2)
    strong = Percepts(np.array([[5.0, -1.0]]), felt[:1], one, 1.0)
    assert YES_NO.decides is not None
    assert YES_NO.decides(strong).choice.tolist() == [0, 1]
    assert DIRECTION.decides is not None
    above = DIRECTION.decides(dataclasses.replace(strong, reference=np.array([2.0, 2.0])))
    assert above.choice.tolist() == [0, 1]
    assert DETECTION.decides is not None
    pair = DETECTION.decides(Percepts(np.array([[5.0, 0.0], [0.0, 5.0]]), felt, one, 1.0))
    assert pair.choice.tolist() == [0, 1]
    assert float(ndtri(0.75)) == pytest.approx(QUARTILE)


class Script:
    """Answers each trial by what is right, or by its first answer."""

    def rest(self, duration: float) -> None:
        assert duration >= 0

    def feel(self, presentation: Presentation, place: int) -> None:
        assert 0 <= place < len(presentation.surfaces)

    def ask(self, presentation: Presentation) -> str | float:
        return presentation.trial.answer or presentation.trial.alternatives[0]

    def acknowledge(self, presentation: Presentation, told: Acknowledgement) -> None:
        assert told.correct is not False


@pytest.mark.parametrize("name", PRESETS)
def test_a_session_is_held_analysed_and_exported(name: str, tmp_path: Path) -> None:
    text = Path(str(_preset(name))).read_text("utf-8")
    file = tmp_path / "own.toml"
    short = text.replace("blocks = { value = 3", "blocks = { value = 1")
    for times in (3, 4):
        short = short.replace(f"repetitions = {{ value = {times}", "repetitions = { value = 1")
    file.write_text(short, "utf-8")
    with open_study(tmp_path / "own.sqlite", file, 1) as store:
        said = run_session(store, None, Desk(tell=lambda _: None, consent=True), Script())
        assert "trials on biet2008-plate recorded" in said
        (found,) = analyze_study(store).values()
        schedule = plan_study(load_design(file)).schedules[0]
        assert found.trials == sum(trial.phase == "main" for trial in schedule)
        written = export_study(store, "csv", tmp_path / "out")
        reference = store.design.reference
    tables = [path.read_text("utf-8") for path in written.rglob("*.csv")]
    (answers,) = [table for table in tables if "third_stimulus_period_m" in table]
    # Runs of limits present no flat surface.
    assert name == "friction-limits" or reference in answers


def _preset(name: str) -> Path:
    from squeezefilm.core import presets

    return Path(str(presets.resolve(name, "study")))


def test_a_flat_surface_is_described_by_its_name_and_has_no_d_prime() -> None:
    found = analysed(made_up(DEPTHS, 2, 0.02, 0.03, 4))
    assert "“flat” (constant" in found.methods
    assert "nan" not in found.methods
    assert found.conditions[0].name == "flat"
    assert found.conditions[0].d_prime is None
