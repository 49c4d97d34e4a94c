"""A host that plays on a port until it is stopped, killed or unplugged; prints how it ended.

python playing_host.py PORT TRACE SECONDS
"""

from __future__ import annotations

import json
import sys
import warnings
from multiprocessing.connection import Connection
from pathlib import Path

from squeezefilm.core.drive_limits import Limits
from squeezefilm.core.errors import DeviceError
from squeezefilm.instruments.session.loop.plan import LoopPlan
from squeezefilm.instruments.session.play.plan import PlayPlan
from squeezefilm.instruments.session.play.real_time import run_play
from squeezefilm.physics.render.motion.estimator import LVDT_10_KHZ, MotionEstimator
from squeezefilm.physics.render.program.lowering import lower
from squeezefilm.physics.render.resonator.envelope import DrivenEnvelope
from squeezefilm.physics.render.texture.levels import Amplitude
from squeezefilm.physics.render.texture.shapes import SquareWave


def own_plan() -> PlayPlan:
    """What it plays."""
    # Never silent, so that an output at zero is the device's doing.
    square = Amplitude(SquareWave(2e-3), 0.5e-6, 1e-6)
    loop = LoopPlan(
        program=lower(square, largest_amplitude=1e-6),
        rate=2e3,
        envelope=DrivenEnvelope(1e-3, 1e-3, 1e-6),
        amplitude_per_volt=1e-7,
        estimator=MotionEstimator.for_sensor(LVDT_10_KHZ),
        output_delay=8e-3,
    )
    return PlayPlan(loop, Limits(15.0, 15e3, 15.0, 2e4, 30e3, 36e3), 33.5e3)


def played(port: str, trace: Path, seconds: float) -> dict[str, object]:
    """Play; how it ended, why, how many rows were recorded, and whether it is usable."""
    with warnings.catch_warnings():
        # Real-time priority may not be granted where tests run.
        warnings.simplefilter("ignore")
        done = run_play(own_plan(), f"serial:{port}", trace, {}, duration=seconds)
    return {
        "ending": done.ending.name, "message": done.message, "rows": done.rows,
        "usable": done.usable, "ticks": None if done.usability is None else done.usability.sentence,
    }  # fmt: skip


def tell_ending(tells: Connection, port: str, trace: Path, seconds: float) -> None:
    """Play, and tell how it ended; LINK where the port was lost before it could play."""
    try:
        tells.send(played(port, trace, seconds)["ending"])
    except DeviceError:
        tells.send("LINK")


if __name__ == "__main__":
    print(json.dumps(played(sys.argv[1], Path(sys.argv[2]), float(sys.argv[3]))))
