"""The working mode that a display's chain goes on with: the solved one, or what stands for it."""

from __future__ import annotations

from squeezefilm.core.errors import InputError, OutOfTimeError
from squeezefilm.core.progress import NO_HURRY, Pace
from squeezefilm.physics.plate.layout import Actuator, RectangularPlate
from squeezefilm.physics.plate.working_mode import PlateTheory, WorkingMode, working_mode

Objections = tuple[str, ...]


def chosen_mode(
    actuator: Actuator,
    theory: PlateTheory | None = None,
    *,
    strict: bool = False,
    pace: Pace = NO_HURRY,
) -> tuple[WorkingMode, Objections]:
    """The working mode of an actuator, and what speaks against it, in sentences.

    Without a `theory` a plate is solved in three dimensions, and taken as a beam, with an
    objection, where that finds no such mode or the budget of `pace` does not allow it; with
    `strict` it raises then. Raises what `working_mode` raises.
    """
    if theory is not None or strict or not isinstance(actuator, RectangularPlate):
        mode = working_mode(actuator, theory or "solid", pace=pace)
        return mode, _coarseness(mode)
    try:
        mode = working_mode(actuator, "solid", pace=pace)
    except OutOfTimeError as error:
        return working_mode(actuator, "timoshenko"), (
            f"{error}; the numbers are those of a beam, whose frequency lies within 13 % of the "
            "solved one (on 95 random plates) and whose amplitude mostly within a factor of two",
        )
    except InputError as error:
        return working_mode(actuator, "timoshenko"), (
            f"the solved plate does not give the working mode ({error}); a beam's, whose numbers "
            "these are, need not exist in such a plate",
        )
    return mode, _coarseness(mode)


def _coarseness(mode: WorkingMode) -> Objections:
    if mode.solid is None or not mode.solid.coarseness:
        return ()
    return (mode.solid.coarseness,)
