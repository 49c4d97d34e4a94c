"""The rule by which people who do not do the task are told, fixed before anybody is asked."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

from squeezefilm.core import quantities as si

_Share = Annotated[si.Dimensionless, si.AtLeast(0.0), si.AtMost(1.0)]
_Chance = Annotated[si.Dimensionless, si.Above(0.0), si.AtMost(0.5)]


@si.checked_numbers
@dataclass(frozen=True)
class ExclusionRule:
    """Limits beyond which somebody counts as not doing the task.

    `identification.screening` applies them.

    It is part of the design and of its hash: whoever changes it after the answers has another
    design. Results are shown with and without the people whom it names, whatever `action` says.

    Args:
        action: "exclude" leaves them out of the results that are quoted; "mark" only names them.
        chance: probability at which somebody who guesses may pass as doing the task, or seem to
            mix up the answers (1).
        one_answer: share of one answer at which somebody only gives that one (1).
        turned: how many times likelier the answers must be, as a power of e, if the person guessed
            or mixed them up in a part of the session, than if nothing changed (1).
        lapses: lapse rate that somebody surely exceeds, with 95 % (1).
        catch: probability of so many missed catch trials from somebody who attends (1).
        fastest: response time below which nobody can have felt anything (s); 0 for no rule.
        fast: share of the answers below `fastest` that is allowed (1).
        complete: least share of the trials, of what the design or whoever has most answered (1).
    """

    action: Literal["mark", "exclude"] = "mark"
    chance: _Chance = 0.001
    one_answer: _Share = 0.9
    turned: Annotated[si.Dimensionless, si.AtLeast(0.0)] = 6.0
    lapses: _Share = 0.2
    catch: _Chance = 0.01
    fastest: Annotated[si.Second, si.AtLeast(0.0), si.AtMost(60.0)] = 0.15
    fast: _Share = 0.1
    complete: _Share = 0.75
