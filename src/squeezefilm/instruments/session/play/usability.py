"""Usability of what was played: ticks made, the longest gap, commands that came in time.

A session may end as it should and still have played next to nothing: where a computer, or a whole
virtual one, was held up, no link breaks and a twin's watchdog counts its own time. So every session
is counted while its device plays, and judged by three numbers. The limits are ours: a tick that is
missing here and there leaves the command before it for one period more, which no finger notices,
and a gap of `WATCHDOG` is what a real device takes for a dead host.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.drive_limits import WATCHDOG
from squeezefilm.core.results import to_json
from squeezefilm.instruments.session.loop import rows as column

LEAST_MADE: si.Dimensionless = 0.9
"""Share of the ticks due while the device plays that must be made and recorded."""
LONGEST_GAP: si.Second = WATCHDOG
"""The longest time without a tick that a usable session may have."""
MOST_LATE: si.Dimensionless = 0.1
"""Share of the ticks due whose command may come too late to be sent."""


@dataclass(frozen=True, slots=True)
class Usability:
    """Usability of a session by its ticks, with the limits that they are held to.

    Attributes:
        usable: whether all three limits are kept; never where nothing was played.
        ticks: due while the device played.
        share_made: of these, made with a host that was heard, and recorded; NaN without any.
        longest_gap: the longest time between two of them (s).
        share_late: of these, commands too late to be sent; NaN without any.
        sentence: what happened and what to do; empty where it is usable.
    """

    usable: bool
    ticks: int
    share_made: si.Dimensionless
    longest_gap: si.Second
    share_late: si.Dimensionless
    sentence: str

    def to_json(self) -> dict[str, Any]:
        """The fields and the limits, as a record keeps them."""
        limits = {
            "least_share_made": LEAST_MADE,
            "longest_gap_s": LONGEST_GAP,
            "most_share_late": MOST_LATE,
        }
        fields: dict[str, Any] = to_json(self)
        return {**fields, "limits": limits}


class TickCount:
    """Counts a session's ticks as its rows are taken; `period` is the loop's (s)."""

    def __init__(self, period: si.Second) -> None:
        self._period = period
        self._first = self._last = self._good = math.nan
        self._made = 0
        self._gap = 0.0

    def take(self, rows: si.FloatArray) -> None:
        """Rows of the time in which the device plays, shape (n, columns), in their order."""
        times, flags = rows[:, column.TIME], rows[:, column.FLAGS].astype(np.int64)
        if math.isnan(self._first):
            self._first = self._good = float(times[0])
        self._last = float(times[-1])
        # A host that is not heard sends nothing on, whatever the loop makes.
        good = times[(flags & column.HOST_SILENT) == 0]
        if good.size:
            steps = np.diff(good, prepend=self._good)
            self._gap = max(self._gap, float(steps.max()))
            self._good, self._made = float(good[-1]), self._made + int(good.size)

    def judged(self, late_commands: int) -> Usability:
        """The verdict, given how many commands came too late to be sent."""
        if math.isnan(self._first):
            said = "the device never played, so that nothing was felt: look why, and play again"
            return Usability(False, 0, math.nan, math.nan, math.nan, said)
        due = max(round((self._last - self._first) / self._period) + 1, self._made, 1)
        gap = max(self._gap, self._last - self._good)
        made, late = self._made / due, min(late_commands / due, 1.0)
        wrong = []
        if made < LEAST_MADE:
            wrong.append(
                f"{100 * made:.3g} % of {due} ticks were made (at least {100 * LEAST_MADE:g} %)"
            )
        # A period is no gap, however slow the loop.
        if gap > max(LONGEST_GAP, 1.5 * self._period):
            wrong.append(
                f"nothing was played for {si.format_quantity(gap, si.Unit('s'), 3)} (at most "
                f"{si.format_quantity(LONGEST_GAP, si.Unit('s'))})"
            )
        if late > MOST_LATE:
            wrong.append(
                f"{100 * late:.3g} % of the commands came too late (at most {100 * MOST_LATE:g} %)"
            )
        said = ""
        if wrong:
            said = (
                f"{'; '.join(wrong)}. This computer was held up or is too slow: close "
                "other programs, allow real-time priority, lower the rate, and play again"
            )
        return Usability(not wrong, due, made, gap, late, said)
