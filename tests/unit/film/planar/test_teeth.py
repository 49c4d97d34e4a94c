"""A toothed surface's film is solved once and then found on disk."""

from pathlib import Path

import pytest

from squeezefilm.film.planar import teeth
from squeezefilm.film.planar.gap import PlanarGap


def test_teeth_that_were_solved_are_not_solved_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SQUEEZEFILM_CACHE", str(tmp_path))
    solved = []

    def over_teeth(gap: PlanarGap, *_: object) -> float:
        solved.append(gap)
        return 0.01 * gap.excursion_ratio

    monkeypatch.setattr(teeth, "_over_teeth", over_teeth)

    def compared(excursion: float) -> float:
        gap = PlanarGap(excursion)
        return teeth.compare_teeth(10.0, gap, tooth_width=0.1, tooth_pitch=0.2).toothed

    first = compared(0.5)
    assert compared(0.5) == first == pytest.approx(0.0025)
    assert len(solved) == 1
    assert compared(0.25) == pytest.approx(first / 2)
    assert len(solved) == 2
