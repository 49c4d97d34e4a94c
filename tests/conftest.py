"""What every test needs before NumPy loads, and how far properties are explored.

One thread for linear algebra: small blocks are many times slower with threaded BLAS, most of all
when tests run side by side. Properties draw the same few examples every time in `make test`, and
many new ones in `make nightly`, which sets SQUEEZEFILM_EXPLORE and prints its seed.
"""

import gc
import os
import signal
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    # A shell that starts tests in the background has them, and all they start, ignore Ctrl-C.
    signal.signal(signal.SIGINT, signal.default_int_handler)
_ON_INTERRUPT = signal.getsignal(signal.SIGINT)

for _library in ("OMP", "OPENBLAS", "MKL"):
    os.environ.setdefault(f"{_library}_NUM_THREADS", "1")
# Solved plates and films are kept from one process and run to the next under a hash of the whole
# package, so that none is of another source; `off` keeps nothing, as `make coverage` asks.
_KEPT = str(Path(__file__).parents[1] / "out" / "test-cache")
if os.environ.get("SQUEEZEFILM_CACHE") != "off":
    os.environ["SQUEEZEFILM_CACHE"] = _KEPT
_AT_START = os.environ["SQUEEZEFILM_CACHE"]

from hypothesis import settings  # noqa: E402

_EXPLORES = "SQUEEZEFILM_EXPLORE" in os.environ
_HOW = {
    "deadline": None,
    "derandomize": not _EXPLORES,
    "print_blob": _EXPLORES,
    "database": None,
}
settings.register_profile("properties", max_examples=120 if _EXPLORES else 12, **_HOW)
# For properties whose every example is a solve, a process or a session.
settings.register_profile("dear", max_examples=24 if _EXPLORES else 5, **_HOW)
settings.load_profile("properties")

_approx = pytest.approx


def _approx_of_any_size(
    expected: Any, rel: Any = None, abs: Any = None, nan_ok: bool = False
) -> Any:
    """Compare by share alone unless a test says otherwise: pytest's own absolute tolerance, 1e-12,
    is a picofarad, a micrometre's millionth and a tenth of what a ceramic yields per volt."""
    if abs is None:
        rel, abs = 1e-6 if rel is None else rel, 0.0
    return _approx(expected, rel=rel, abs=abs, nan_ok=nan_ok)


pytest.approx = _approx_of_any_size

# Tests that may go to any process, one by one; of other files one process takes all, since they
# share what is dear. (xdist's own groups are passed over under pytest 9.2: it names tests anew.)
_SPREAD = (
    "tests/e2e/",
    "tests/faults/",
    "tests/properties/",
    "tests/verification/test_verbs_agree.py",
)
_TOGETHER = ("tests/e2e/test_lab_", "tests/e2e/test_report_page.py")


_setattr = pytest.MonkeyPatch.setattr


def _setattr_and_keep_nothing(self: pytest.MonkeyPatch, *target: Any, **how: Any) -> None:
    """Replace an attribute, and until it is back keep nothing for other tests, nor read what is."""
    if os.environ.get("SQUEEZEFILM_CACHE") == _KEPT:
        self.setenv("SQUEEZEFILM_CACHE", "off")
    _setattr(self, *target, **how)


def pytest_sessionstart() -> None:
    """Watch what tests replace, and not what pytest itself did while it was configured."""
    pytest.MonkeyPatch.setattr = _setattr_and_keep_nothing  # type: ignore[method-assign]


@pytest.fixture(scope="session")
def shared_cache() -> str:
    """The folder in which the tests of this run keep what they solve, or `off`."""
    return _AT_START


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Iterator[None]:
    """Look for no garbage among thousands of tests while they are collected, nor ever after."""
    gc.disable()
    try:
        yield
    finally:
        gc.enable()
        gc.freeze()
        # Figures and solves make objects by the hundred thousand, most of which no cycle holds.
        gc.set_threshold(100_000, 50, 100)
        # A session that is played thaws everything when it ends: each collection after it would
        # look through all that was loaded, which takes a second.
        gc.unfreeze = _leave_frozen


def _leave_frozen() -> None:
    """Thaw nothing."""


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: Any, log: Any) -> Any:
    """Schedule by files, in their order: the longest tests are the first."""
    from xdist.scheduler import LoadScopeScheduling

    class ByFiles(LoadScopeScheduling):
        def _split_scope(self, nodeid: str) -> str:
            file = nodeid.partition("::")[0]
            spread = file.startswith(_SPREAD) and not file.startswith(_TOGETHER)
            return nodeid if spread else file

    config.option.loadscopereorder = False
    return ByFiles(config, log)


@pytest.hookimpl(trylast=True)
def pytest_runtest_teardown() -> None:
    """No test leaves the next one deaf to Ctrl-C."""
    if signal.getsignal(signal.SIGINT) is not _ON_INTERRUPT:
        signal.signal(signal.SIGINT, _ON_INTERRUPT)
