"""A twin on a pseudo-terminal that tells at its end when it last heard a frame, and all levels.

    python observed_twin.py OUT.json LEVELS.npy

Times are the device's own: no wall clock enters what is judged.
"""

from __future__ import annotations

import json
import os
import signal
import sys
from pathlib import Path

import numpy as np

from squeezefilm.instruments.device.machine.device import Machine
from squeezefilm.instruments.device.wire.frames import Fault
from squeezefilm.instruments.twin.device import TwinDevice
from squeezefilm.instruments.twin.hand import hand_from
from squeezefilm.instruments.twin.pty_server import PtyServer
from squeezefilm.instruments.twin.settings import PickupModel, TwinSettings
from squeezefilm.physics.display import load_display
from squeezefilm.physics.render.motion.estimator import LVDT_10_KHZ


class Observed(Machine):
    """A device that remembers each fault: when it came, when a frame was last accepted before it,
    and when the output was at zero."""

    faults: list[dict[str, int]]

    def _fail(self, fault: Fault) -> None:
        before = self.fault
        super()._fail(fault)
        if before != self.fault:
            seen = {"fault": int(fault), "at_us": self._now, "heard_us": self._heard}
            self.faults.append(seen)

    def tick(self, now: int) -> int:
        level = super().tick(now)
        if level == 0 and self.faults and "zero_us" not in self.faults[-1]:
            self.faults[-1]["zero_us"] = self._now
        return level


def main(said: Path, levels: Path) -> None:
    settings = TwinSettings(
        sensor=LVDT_10_KHZ, pickup=PickupModel(kind="sensing_patch"), truth_period=200e-6
    )
    device = TwinDevice(
        load_display("biet2008-plate"), settings, hand=hand_from("60 mm/s over 4 cm")
    )
    own = device.machine
    device.machine = Observed(
        own.seed, own.own, sensor=own.sensor, pickup=own.pickup, tick_period=own.tick_period
    )
    device.machine.faults = []
    # Compiled before its clock starts; a device does not pause for that.
    spare = TwinDevice(device.display, settings, hand=hand_from(), point=device.plant.point)
    spare.advance(200_000)
    spare.close()
    server = PtyServer(device)
    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, lambda *_: server.stop())
    print(server.port, flush=True)
    server.serve(os.getppid())
    truth = device.truth
    rows = np.column_stack([truth.column("time_s"), truth.column("level_V")])
    np.save(levels, rows)
    said.write_text(json.dumps(device.machine.faults))
    server.close()


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
