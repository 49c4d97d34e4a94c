"""A fit of what no instrument should give: a message, where numbers run out of range on the way."""

from __future__ import annotations

import functools
import warnings
from collections.abc import Callable
from typing import ParamSpec, Protocol, TypeVar

import numpy as np

from squeezefilm.core.errors import InputError
from squeezefilm.measure.fits.estimate import Observation

_P = ParamSpec("_P")


class Observing(Protocol):
    """A fit: it has observations."""

    @property
    def observations(self) -> tuple[Observation, ...]:
        """What a calibration may use."""


_F = TypeVar("_F", bound=Observing)


def guarded_fit(fit: Callable[_P, _F]) -> Callable[_P, _F]:
    """Have a fit raise `InputError` where its arithmetic ends, or gives what is not finite.

    Trial steps of a search may overflow; that is no message to anybody, and none comes of it.
    """

    @functools.wraps(fit)
    def guarded(*args: _P.args, **kwargs: _P.kwargs) -> _F:
        try:
            with np.errstate(all="ignore"), warnings.catch_warnings():
                warnings.simplefilter("ignore", RuntimeWarning)
                warnings.simplefilter("ignore", np.exceptions.RankWarning)
                found = fit(*args, **kwargs)
                known = found.observations
        except (ArithmeticError, np.linalg.LinAlgError) as error:
            raise _no_fit(str(error)) from error
        if not all(np.isfinite([one.value, one.standard_error]).all() for one in known):
            raise _no_fit("its numbers are not finite")
        return found

    return guarded


def _no_fit(why: str) -> InputError:
    return InputError(
        f"the recording has no fit ({why}): its values are all alike, jump by many orders of "
        "magnitude, or show nothing of what is to be fitted. Look at it with squeezefilm measure "
        "check"
    )
