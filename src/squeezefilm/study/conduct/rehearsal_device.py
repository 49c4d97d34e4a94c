"""A study's device that is a display's twin: to rehearse a study, its files and its analysis.

Loop, link, device and plate are those of a session, on a virtual clock
(`instruments.session.play.simulated`): with the plate's drift, its amplifier and the noise of its
pickup, so that a verification measures something and may fail. Nobody can feel it; a simulated hand
explores every surface instead, which says how a finger moves, not what a person would answer.
"""

from __future__ import annotations

import dataclasses
import tempfile
from pathlib import Path

from squeezefilm.core import quantities as si
from squeezefilm.core.drive_limits import Limits
from squeezefilm.core.errors import DeviceError
from squeezefilm.core.results import config_hash
from squeezefilm.instruments.bench.resonance_sweep import ResonanceSweep, sweep_resonance
from squeezefilm.instruments.bench.setup import KnownDevice, play_setup
from squeezefilm.instruments.device.host import DeviceHost
from squeezefilm.instruments.device.wire.link import Link
from squeezefilm.instruments.session.play.plan import Ending
from squeezefilm.instruments.session.play.simulated import VirtualStream, virtual_play
from squeezefilm.instruments.session.record.trace import read_trace
from squeezefilm.instruments.twin.device import TwinDevice
from squeezefilm.instruments.twin.hand import Hand, hand_from
from squeezefilm.instruments.twin.settings import PickupModel, TwinSettings
from squeezefilm.instruments.twin.working_point import WorkingPoint, working_point
from squeezefilm.physics.display import Display
from squeezefilm.physics.perception.stimuli import Stimulus
from squeezefilm.physics.render.motion.sensor import LVDT_10_KHZ
from squeezefilm.physics.texture_files.texture_file import TextureFile
from squeezefilm.study.conduct.playing_process import explored, resonance_verified
from squeezefilm.study.conduct.study_device import DeviceIdentity, DeviceVerification, TrialMotion


class StudyTwin:
    """A `StudyDevice` made of a display's twin on its own virtual clock.

    Args:
        display: whose twin; driven at its own voltage.
        settings: what is assumed of it; all defaults are assumed.
        hand: that explores each surface; one there and back at people's speed if None.
        point: the display's working point where it has been solved before.

    Raises what `working_point` raises.
    """

    def __init__(
        self,
        display: Display,
        settings: TwinSettings | None = None,
        hand: Hand | None = None,
        point: WorkingPoint | None = None,
    ) -> None:
        self.display = display
        own = TwinSettings(sensor=LVDT_10_KHZ, pickup=PickupModel(kind="sensing_patch"))
        self.settings = settings or own
        self.hand = hand or hand_from(begin=0.05, repeats=2)
        self.point = point or working_point(display, self.settings)
        self._presented: Stimulus | None = None

    def identity(self) -> DeviceIdentity:
        """ "rehearsal", with the hashes of the display and of the twin's settings."""
        return DeviceIdentity("rehearsal", config_hash(self.display), config_hash(self.settings))

    def verify_device(self) -> DeviceVerification:
        """The resonance swept on the twin without a finger, see `resonance_verified`."""
        per_volt = self._twin().plant.pickup_calibration
        return resonance_verified(self.display, self.point.mode, per_volt, self._swept, twin=True)

    def present(self, stimulus: Stimulus, seed: int) -> None:
        """Take the surface; the hand explores it when it is stopped. The twin's noise is fixed by
        its settings, not by `seed`."""
        self._presented = stimulus

    def stop(self) -> TrialMotion:
        """Let the hand explore the surface presented, and say how it went.

        Raises `DeviceError` where the twin faulted.
        """
        if self._presented is None:
            return TrialMotion()
        stimulus, self._presented = self._presented, None
        setup = play_setup(
            self.display,
            TextureFile(stimulus.surface(), stimulus.name),
            device=KnownDevice(self.settings.sensor, twin=True),
        )
        device = self._twin(self.hand)
        end = self.hand.begin + (self.hand.repeats or 1) * self.hand.motion.duration
        about = {
            "device": "rehearsal",
            "settings_sha256": config_hash(self.settings),
            "stimulus": stimulus.name,
            "surface_sha256": stimulus.surface_sha256,
        }
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "trace.sqft"
            outcome = virtual_play(setup.plan, device, path, about, duration=end)
            if outcome.ending is not Ending.DURATION:
                raise DeviceError(f"the twin stopped: {outcome.ending.value} ({outcome.message})")
            felt = explored(read_trace(path), "")
        return dataclasses.replace(felt, mean_normal_force=self.hand.normal_force)

    def _twin(self, hand: Hand | None = None) -> TwinDevice:
        return TwinDevice(self.display, self.settings, hand=hand, point=self.point)

    def _swept(
        self, limits: Limits, carriers: si.HertzArray, voltage: si.Volt, settle: si.Second
    ) -> ResonanceSweep | None:
        stream = VirtualStream(self._twin())
        host = DeviceHost(Link(stream, stream.clock, stream.wait))
        return sweep_resonance(host, limits, carriers, voltage, settle=settle, wait=stream.wait)
