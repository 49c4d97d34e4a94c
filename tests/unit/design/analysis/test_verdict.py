"""The verdict's sentences, word for word, and on which side of each bound they stand."""

from __future__ import annotations

import dataclasses
from collections import Counter
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.config.provenance import UNSTATED, Provenance
from squeezefilm.design.analysis.area_odds import AreaOdds, JudgedArea
from squeezefilm.design.analysis.curves import FrictionCurve
from squeezefilm.design.analysis.felt import GratingsLeft
from squeezefilm.design.analysis.verdict import (
    Finding,
    friction_verdict,
    model_form,
    rival_frictions,
    verdict,
)
from squeezefilm.physics.chain.active_area import ActiveArea
from squeezefilm.physics.chain.prediction import Prediction, predict
from squeezefilm.physics.display import load_display
from squeezefilm.physics.uncertainty.draws import Refusals
from squeezefilm.physics.uncertainty.uncertainty import UncertainFriction

STATOR = dataclasses.replace(load_display("biet2008-stator"), provenance={})
SHARED = "partial-levitation"


def findings(*about: Any) -> tuple[Finding, ...]:
    return tuple(verdict(*about))


@pytest.fixture(scope="module")
def point() -> Prediction:
    return predict(STATOR, position=0.0)


def curve(needed: float | None, surface: str = "adhesive", model: str = SHARED) -> FrictionCurve:
    one = np.array([0.0, 1e-6])
    return FrictionCurve(surface, 1e-6, one, one, needed, None, model)


def said(p: Prediction, needed: float | None = 2.5e-6, **changes: Any) -> tuple[Finding, ...]:
    """The verdict of a point changed."""
    p = dataclasses.replace(p, **changes)
    return findings(STATOR, p, None, curve(needed, model=p.model), None)


def unsure(low: float, high: float, samples: list[float], refused: int = 0) -> Any:
    return UncertainFriction(
        nominal=0.51, median=0.4, interval=(low, high), level=0.9, samples=np.array(samples),
        amplitudes=np.zeros(len(samples)), draws=len(samples) + refused, influences=(),
        groups=(),
        refused=Refusals(100, Counter({"why": refused})), seed=1, model="a-model",
    )  # fmt: skip


def test_a_verdict_is_the_probability_of_the_criterion(point: Prediction) -> None:
    p = dataclasses.replace(point, vibration_amplitude=2e-6)
    (inside,) = friction_verdict(p, unsure(0.2, 0.81, [0.2, 0.5, 0.75, 0.9]), "")
    half = f"{1e3 * p.mode.half_wavelength:.3g} mm"
    assert inside == Finding(
        "limit",
        "µ′/µ is 0.51 as described at the antinode, x 0 mm, y 5 mm, taken as an even wave of "
        f"half wavelength {half}, at 2 µm. When the uncertain inputs and models "
        "vary, its median is 0.40 "
        "(90 % interval 0.20–0.81); it is below 0.70, as the paper asks, with probability 0.50, "
        "and below 0.80, where people notice it, with probability 0.75. The criterion lies inside "
        "the interval: whether it is met is open.",
    )
    (good,) = friction_verdict(p, unsure(0.2, 0.69, [0.2, 0.5, 0.6, 0.69]), "")
    assert good.kind == "good"
    assert "(90 % interval 0.20–0.69); it is below 0.70" in good.text
    assert "asks, with probability above 0.99, and" in good.text
    assert good.text.endswith("notice it, with probability above 0.99.")
    # Never good where the criterion is at the very end of the interval, nor where it is missed.
    assert friction_verdict(p, unsure(0.2, 0.7, [0.2, 0.7]), "")[0].kind == "limit"
    (missed,) = friction_verdict(p, unsure(0.75, 0.9, [0.75, 0.9]), "")
    assert missed.kind == "limit"
    assert "probability below 0.01" in missed.text
    assert "open" not in missed.text


def test_refused_draws_do_not_meet_the_criterion(point: Prediction) -> None:
    (found,) = friction_verdict(point, unsure(0.2, 0.9, [0.2, 0.9], refused=2), "")
    # 1 of 4.
    assert "with probability 0.25" in found.text


def test_without_an_interval_nothing_is_good(point: Prediction) -> None:
    p = dataclasses.replace(point, vibration_amplitude=2e-6, relative_friction=0.3)
    half = f"{1e3 * p.mode.half_wavelength:.3g} mm"
    (found,) = friction_verdict(p, None, "too many draws are refused")
    assert found == Finding(
        "doubt",
        "µ′/µ is 0.30 as described at the antinode, x 0 mm, y 5 mm, taken as an even wave of "
        f"half wavelength {half}, at 2 µm by the model '{p.model}'. How probable it is that it "
        "lies below 0.70, as the paper asks, is not known: too many draws are refused.",
    )
    assert friction_verdict(p, None, "")[0].text.endswith("not known: no interval was computed.")
    assert said(point)[0].kind == "doubt"


def area(worst: float, draws: list[float] | None) -> JudgedArea:
    """An area from 0.2 to `worst`; draws at the worst place where there are any."""
    friction = np.repeat(np.linspace(0.2, worst, 5)[:, None], 3, axis=1)
    ones = np.ones_like(friction)
    whole = ActiveArea(
        x=np.linspace(0, 1, 5), y=np.linspace(0, 1, 3), amplitude=ones, lobe_amplitude=ones,
        amplitude_under_pad=ones, relative_friction=friction, contact_side=1e-2, rule="by hand",
        shape_model="a-model", shape_words="by hand",
    )  # fmt: skip
    if draws is None:
        return JudgedArea(whole, None)
    samples = np.array([[0.2, 0.5, one] for one in draws])
    return JudgedArea(whole, AreaOdds(samples))


def test_good_is_only_what_is_good_at_the_worst_place_too(point: Prediction) -> None:
    sure = unsure(0.2, 0.69, [0.2, 0.5, 0.6, 0.69])

    def kinds(over: JudgedArea) -> list[str]:
        return [one.kind for one in friction_verdict(point, sure, "", over)]

    assert kinds(area(0.6, [0.3, 0.5, 0.65])) == ["good", "good"]
    assert kinds(area(0.6, None)) == ["good", "good"]
    # As described, or in some draws, the worst place misses it.
    assert kinds(area(0.72, None)) == ["limit", "limit"]
    at_place, missed = friction_verdict(point, sure, "", area(0.6, [0.3, 0.5, 0.75, 0.9]))
    assert (at_place.kind, missed.kind) == ("limit", "limit")
    assert "active area" not in at_place.text
    assert missed.text.endswith(
        "it is below 0.70 with probability above 0.99 at the best place, above 0.99 in the median "
        "and 0.50 at the worst."
    )
    assert "µ′/µ is 0.20 at the best place" in missed.text


def test_draws_without_a_friction_over_the_area_are_counted(point: Prediction) -> None:
    judged = area(0.6, [0.3, 0.5, 0.65])
    assert "no friction" not in friction_verdict(point, None, "", judged)[1].text
    assert judged.odds is not None
    judged.odds.samples[1] = np.nan
    assert friction_verdict(point, None, "", judged)[1].text.endswith(
        "0.67 in the median and 0.67 at the worst; 1 of the 3 draws give no friction there and "
        "count as not below it."
    )


def test_what_the_criterion_takes_is_said_where_it_is_missed(point: Prediction) -> None:
    second = said(point, relative_friction=0.75, vibration_amplitude=1.234567e-6)[1]
    assert second == Finding(
        "limit",
        f"By the model '{point.model}' µ′/µ is 0.75 as described; 2.5 µm would bring it to 0.70.",
    )
    out = said(point, needed=None, relative_friction=0.81)[1]
    assert out.text.endswith("no amplitude would bring it to 0.70.")
    assert "would bring it" not in said(point, relative_friction=0.7)[1].text
    # The paper's own number has no interval: it stands beside that of the draws.
    paper = said(point, relative_friction=0.1234, model="paper2008")[1]
    assert paper.text.startswith("By the paper's model µ′/µ is 0.12 as described")


def test_an_amplitude_beyond_belief_is_doubted(point: Prediction) -> None:
    told = Finding(
        "doubt",
        "10.1 µm is more than any bonded plate of this kind is known to do; ceramics turn "
        "nonlinear and bonds fail long before, and nothing here sees that.",
    )
    assert told in said(point, vibration_amplitude=10.1e-6)
    assert not any("bonded plate" in one.text for one in said(point, vibration_amplitude=10e-6))


def table(fastest: list[float]) -> GratingsLeft:
    return GratingsLeft(
        kept=0.9,
        fundamental=0.684,
        spatial_periods=np.array([2e-3, 0.4e-3, 8e-3]),
        speeds=np.array([0.05, 0.15]),
        finest_period=np.array([1e-3, 1e-3]),
        fastest_speed=np.array(fastest),
    )


def test_gratings_that_survive_the_fastest_finger_are_named(point: Prediction) -> None:
    own = curve(1e-6)
    some = findings(STATOR, point, None, own, table([0.15, 0.0404, 0.8]))
    assert (
        Finding(
            "good",
            "Square gratings of 2, 8 mm keep 90 % of their swing, peak to peak, up to 150 mm/s; "
            "0.4 mm up to 40 mm/s. Of the fundamental 68 % are left there.",
        )
        in some
    )
    none = findings(STATOR, point, None, own, table([0.149, 0.0404, 0.1]))
    assert Finding(
        "limit",
        "Square gratings of no listed mm keep 90 % of their swing, peak to peak, up to 150 mm/s; "
        "0.4 mm up to 40 mm/s. Of the fundamental 68 % are left there.",
    ) in none  # fmt: skip


def test_only_the_papers_model_answers_for_its_assumptions(point: Prediction) -> None:
    failed = [Finding("doubt", check.sentence) for check in point.validity.failed]
    assert failed
    assert not set(failed) & set(said(point))
    assert set(failed) <= set(said(point, model="paper2008"))


def test_assumed_values_are_counted(point: Prediction) -> None:
    sources = {
        "a": Provenance("here", "assumed"),
        "b": Provenance("there", "published"),
        "c": Provenance("nowhere", "assumed"),
    }
    display = dataclasses.replace(STATOR, provenance=sources)
    found = findings(display, point, None, curve(1e-6), None)
    assert Finding(
        "doubt",
        "2 of 3 values of this display are assumed, not measured or published: squeezefilm show "
        "lists them.",
    ) in found  # fmt: skip
    bare = dataclasses.replace(STATOR, provenance={**sources, "d": Provenance("", UNSTATED)})
    found = findings(bare, point, None, curve(1e-6), None)
    assert Finding(
        "doubt",
        "1 of 4 values of this display have no source, and 2 are assumed, not measured or "
        "published: squeezefilm show lists them.",
    ) in found  # fmt: skip


def test_the_last_word_is_that_nothing_is_validated(point: Prediction) -> None:
    last = said(point)[-1]
    assert last == Finding(
        "doubt",
        "Friction is by a model fitted to published friction of people on glass, and to nothing "
        "else (squeezefilm reproduce --data published).",
    )
    # With what is said of the friction, and that no file says where these values are from.
    assert len(said(point, relative_friction=0.5)) == 3


def test_gratings_that_nobody_feels_are_not_good(point: Prediction) -> None:
    table = SimpleNamespace(
        fastest_speed=np.array([0.2]), spatial_periods=np.array([4e-3]), speeds=np.array([0.2]),
        fundamental=0.7,
    )  # fmt: skip
    for friction, kind in ((0.98, "limit"), (0.81, "limit"), (0.5, "good")):
        p = dataclasses.replace(point, relative_friction=friction)
        found = findings(STATOR, p, None, curve(1e-6, model=p.model), table)  # type: ignore[arg-type]
        (gratings,) = (one for one in found if one.text.startswith("Square gratings"))
        assert gratings.kind == kind
        assert ("None is good for that" in gratings.text) == (kind == "limit")


def test_an_interval_says_what_it_has_varied_and_how_far_rival_models_lie_apart() -> None:
    inputs = [SimpleNamespace(parameter=SimpleNamespace(path="a")) for _ in range(3)]
    law = SimpleNamespace(parameter=SimpleNamespace(path="friction_model", options=()), total=0.12)
    drawn = SimpleNamespace(
        interval=(0.3, 0.6), nominal=0.4, influences=(*inputs, law),
        groups=(SimpleNamespace(knowledge="unknown", total=0.25),),
    )  # fmt: skip
    wide = model_form(drawn, {"a": 0.1, "b": 0.9}, 30e3)  # type: ignore[arg-type]
    assert wide.kind == "doubt"
    assert "varies 3 inputs" in wide.text
    assert "1 laws (25 % of its variance), among them the friction model (12 %)," in wide.text
    assert "not the frequency (30 kHz):" in wide.text
    assert "0.10 ('a') to 0.90 ('b')" in wide.text
    assert "they span 0.80, more than the interval (0.30)" in wide.text
    narrow = model_form(drawn, {"a": 0.45}, 30e3)  # type: ignore[arg-type]
    assert "they span 0.05, no more than the interval (0.30)" in narrow.text
    assert model_form(drawn, {}, 30e3).text.endswith("not the frequency (30 kHz).")  # type: ignore[arg-type]


def test_rival_models_are_all_but_the_predictions_own(point: Prediction) -> None:
    rivals = rival_frictions(point)
    assert point.model not in rivals
    assert {"paper2008", "levitation-2016"} <= set(rivals)
    for model, friction in rivals.items():
        assert friction == pytest.approx(
            point.law.by(model).at(point.vibration_amplitude)  # type: ignore[arg-type]
        )
