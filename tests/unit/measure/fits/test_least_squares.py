"""A fit asks for residual and derivatives one after the other, and computes them once."""

import numpy as np

from squeezefilm.measure.fits.least_squares import remembering


def test_the_last_answer_is_kept_and_no_other() -> None:
    asked: list[float] = []

    def square(at: np.ndarray) -> float:
        asked.append(float(at[0]))
        return float(at[0] ** 2)

    remembered = remembering(square)
    answers = [remembered(np.array([value])) for value in (2.0, 2.0, 3.0, 3.0, 2.0)]
    assert answers == [4.0, 4.0, 9.0, 9.0, 4.0]
    assert asked == [2.0, 3.0, 2.0]
