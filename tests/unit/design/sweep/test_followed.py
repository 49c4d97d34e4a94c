"""Modes followed by their motions: through crossings, over grids, and lost where they are gone."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.design.sweep import followed
from squeezefilm.design.sweep.followed import followed_modes, modes_to_follow, packed, unpacked
from squeezefilm.physics.display import load_display

RANDOM = np.random.default_rng(4)
# Two motions of unit length that have nothing in common, and a third.
A, B, C = np.linalg.qr(RANDOM.normal(size=(60, 3)))[0].T


def said(*modes: tuple[str, float, np.ndarray], force: float = 1.0) -> dict[str, Any]:
    rows = [
        {"label": label, "frequency_Hz": frequency, "modal_force": force if label != "still" else 0}
        for label, frequency, _ in modes
    ]
    return {"modes": rows, "motions": packed(np.stack([motion for *_, motion in modes]))}


def test_modes_that_cross_keep_their_labels() -> None:
    points = []
    for k, t in enumerate(np.linspace(0, 1, 5)):
        one, other = ("a", 30e3 + 4e3 * t, A), ("b", 32e3 - 1e3 * t, B)
        # As a solver lists them: by frequency, and labelled anew.
        rising = sorted((one, other), key=lambda mode: mode[1])
        points.append(said(*((f"{n}-{k}", f, m) for n, f, m in rising)))
    first, second = followed_modes(points, (5,), 0)
    assert (first.label, second.label) == ("a-0", "b-0")
    assert first.values(points, "frequency_Hz") == pytest.approx(np.linspace(30e3, 34e3, 5))
    assert second.values(points, "frequency_Hz") == pytest.approx(np.linspace(32e3, 31e3, 5))
    assert first.least_likeness == pytest.approx(1, abs=2e-3)
    assert not first.lost


def test_a_motion_that_turns_slowly_is_followed_and_one_that_is_gone_is_lost() -> None:
    turns = [np.cos(a) * A + np.sin(a) * B for a in np.linspace(0, 1.4, 6)]
    points = [said(("a", 1.0 + k, motion), ("c", 10.0, C)) for k, motion in enumerate(turns)]
    turned, _ = followed_modes(points, (6,), 0)
    assert turned.values(points, "frequency_Hz").tolist() == [1, 2, 3, 4, 5, 6]
    assert turned.least_likeness == pytest.approx(np.cos(0.28) ** 2, abs=0.01)
    gone = [*points[:3], said(("c", 10.0, C)), *points[4:]]
    lost, kept = followed_modes(gone, (6,), 0)
    assert lost.lost
    assert lost.numbers == (0, 0, 0, None, None, None)
    assert np.isnan(lost.values(gone, "frequency_Hz")[3:]).all()
    assert kept.values(gone, "frequency_Hz").tolist() == [10.0] * 6


def test_over_a_grid_from_its_middle_and_past_a_point_without_an_answer() -> None:
    points: list[Any] = [said(("a", float(k), A), ("still", 50.0, B)) for k in range(9)]
    points[5] = None
    driven, still = followed_modes(points, (3, 3), 4)
    assert (driven.driven, still.driven) == (True, False)
    found = driven.values(points, "frequency_Hz")
    assert np.isnan(found[5])
    assert np.delete(found, 5).tolist() == [0, 1, 2, 3, 4, 6, 7, 8]
    assert followed_modes([None, *points[1:]], (3, 3), 0) == ()


def test_two_modes_of_one_label_are_told_apart() -> None:
    points = [said(("(6,3)", 1.0, A), ("(6,3)", 2.0, B))] * 2
    assert [one.label for one in followed_modes(points, (2,), 0)] == ["(6,3)", "(6,3) #2"]


def test_motions_come_back_from_text() -> None:
    motions = np.stack([A, B])
    back = unpacked(packed(motions))
    assert back == pytest.approx(motions, abs=1e-3)
    assert np.linalg.norm(back, axis=1) == pytest.approx(1)


def test_a_stator_is_not_followed() -> None:
    with pytest.raises(InputError, match=r"keep their labels: ask for plate\.modes\.0\.frequency"):
        modes_to_follow(load_display("biet2008-stator"))


def test_the_band_is_around_the_working_mode_unless_one_is_given(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    display: Any = load_display("biet2008-plate")
    asked: list[Any] = []

    class Solved:
        """Two modes: one that moves the upper face only, one that moves both alike."""

        plate = SimpleNamespace(length=80e-3, width=40e-3, thickness=2e-3)
        count, frequencies = 2, np.array([29e3, 30e3])

        def index(self, label: Any) -> int:
            assert label == display.actuator.working_label
            return 1

        def field(self, number: int, x: Any, y: Any, z: float) -> np.ndarray:
            assert (x[0], x[-1], y[0], y[-1]) == (0.0, 80e-3, 0.0, 40e-3)
            out = np.zeros((x.size, y.size, 3))
            out[..., 2] = number + (z > 0)
            return out

    def solve(plate: Any, **given: Any) -> Solved:
        asked.append(given)
        return Solved()

    monkeypatch.setattr(followed, "solve_modes", solve)
    monkeypatch.setattr(followed, "mode_row", lambda modes, index: {"label": f"m{index}"})
    found = modes_to_follow(display)
    assert asked[0] == {"mode": display.actuator.working_label}
    assert asked[1]["band"] == pytest.approx((0.88 * 30e3, 1.12 * 30e3))
    assert [row["label"] for row in found.rows] == ["m0", "m1"]
    # Lower face, upper face: 0 and 1, or 1 and 2, of unit length.
    likeness = found.motions @ found.motions.T
    assert likeness == pytest.approx(np.array([[1, 2 / 5**0.5], [2 / 5**0.5, 1]]))
    modes_to_follow(display, band=(1e3, 2e3))
    assert asked[2:] == [{"band": (1e3, 2e3)}]
