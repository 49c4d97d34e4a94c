"""What is doubtful of a calibration: too few independent draws, too many refused."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from squeezefilm.measure.calibration.calibrate import FEWEST, MOST_REFUSED, _doubts


def worth(effective: float) -> Any:
    return SimpleNamespace(posterior=SimpleNamespace(effective=effective))


NOTHING: Any = SimpleNamespace(posterior=None)
PLATE, FINGER = "The draws of the plate are worth", "The draws of finger and laws are worth"


@pytest.mark.parametrize(
    ("plate", "finger", "refused", "begins"),
    [
        (None, NOTHING, 0.0, []),
        (None, NOTHING, MOST_REFUSED, []),
        (worth(200), worth(FEWEST), 0.0, []),
        (worth(199.0), worth(FEWEST), 0.0, [f"{PLATE} 199 "]),
        (worth(200), worth(FEWEST - 1), 0.0, [f"{FINGER} {FEWEST - 1:.0f} "]),
        (worth(200), worth(FEWEST), 0.5, ["50.0 % of the draws have no friction"]),
        (worth(20), worth(3), 0.5, [f"{PLATE} 20 ", f"{FINGER} 3 ", "50.0 %"]),
    ],
)
def test_what_is_doubtful_is_said_and_only_that(
    plate: Any, finger: Any, refused: float, begins: list[str]
) -> None:
    said = _doubts(plate, finger, refused)
    assert len(said) == len(begins)
    for sentence, begin in zip(said, begins, strict=True):
        assert sentence.startswith(begin)
