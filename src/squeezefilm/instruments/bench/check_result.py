"""Results of the checks of a device: passed, failed, or in doubt."""

from __future__ import annotations

from dataclasses import dataclass

from squeezefilm.core import quantities as si


@dataclass(frozen=True, slots=True)
class CheckResult:
    """A check: its name, whether it passed, what was measured, what is allowed, what to do.

    `advice` is empty where the check passed. `doubt` says why one that did not may be the fault of
    nobody; `explained_by` is for how long this computer must have been held up to be the reason
    (s), 0 where nothing excuses it.
    """

    name: str
    passed: bool
    measured: str
    allowed: str
    advice: str = ""
    explained_by: si.Second = 0.0
    doubt: str = ""

    @property
    def verdict(self) -> str:
        """One word: pass, doubt or FAIL."""
        return "pass" if self.passed else "doubt" if self.doubt else "FAIL"


@dataclass(frozen=True, slots=True)
class DeviceCheck:
    """All checks of one device."""

    drive: str
    results: tuple[CheckResult, ...]

    @property
    def passed(self) -> bool:
        """True where no check failed; some may be in doubt."""
        return all(result.passed or result.doubt for result in self.results)


def judged(
    name: str,
    passed: bool,
    measured: str,
    allowed: str,
    advice: str,
    explained_by: si.Second = 0.0,
) -> CheckResult:
    """The result of a check; advice and excuse only where it did not pass."""
    if passed:
        return CheckResult(name, True, measured, allowed)
    return CheckResult(name, False, measured, allowed, advice, explained_by)


def in_ms(value: si.Second) -> str:
    """A time (s) in ms, in words."""
    return f"{1e3 * value:.3g} ms"
