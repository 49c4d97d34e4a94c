"""The messages of the Study and Results areas, and of the participant's page."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING, Any, TypeVar

from pydantic import Field

from squeezefilm.errors import DeviceError, InputError
from squeezefilm.lab.keys import CODE_LIFE
from squeezefilm.lab.studying.devices import Measured, StudyDevices, require_device
from squeezefilm.lab.studying.jobs import analysis_of, rehearsed, report_of
from squeezefilm.lab.studying.studies import Studies
from squeezefilm.lab.wire import Answer, Request
from squeezefilm.lab.worker import PAGE
from squeezefilm.study.conduct.exposure import Exposure, exposure
from squeezefilm.study.conduct.run import Response
from squeezefilm.study.conduct.study_device import (
    DeviceIdentity,
    DeviceVerification,
    Exploration,
    NoDevice,
    StudyDevice,
)
from squeezefilm.study.record.sittings import Sitting

if TYPE_CHECKING:
    from starlette.websockets import WebSocket

    from squeezefilm.lab.server import Lab

T = TypeVar("T")
_LONGEST_SESSION = 3600.0


class NamedStudy(Request):
    """A study by the name of its file."""

    study: str = Field(max_length=100)


class PlanStudy(Request):
    """A preset design."""

    design: str = Field(max_length=100)


class CreateStudy(PlanStudy):
    """A new study's file."""

    study: str = Field(max_length=64)
    seed: int = Field(ge=0, le=2**53)


class OfParticipant(NamedStudy):
    """A participant of a study."""

    participant: str = Field(max_length=100)


class DeleteParticipant(OfParticipant):
    """Deleting asks for the pseudonym twice."""

    confirm: str = Field(max_length=100)


class PrepareSitting(OfParticipant):
    """A sitting: what a `SessionConditions` has, and the consent's text."""

    device: str = Field(max_length=100)
    consent: str = Field(min_length=20, max_length=20_000)
    conditions: dict[str, str | float | None] = Field(default_factory=dict, max_length=20)
    acknowledged: bool = False


class OfSitting(Request):
    """A sitting by its id."""

    sitting: str = Field(max_length=100)


class FeelSurface(OfSitting):
    """A surface of the trial with this token to be played, by its place from 0."""

    token: str = Field(max_length=100)
    place: int = Field(ge=0, le=9)


class SurfacesFelt(OfSitting):
    """All surfaces of the trial with this token were felt."""

    token: str = Field(max_length=100)


class Respond(OfSitting):
    """An answer to the trial with this token."""

    token: str = Field(max_length=100)
    choice: str = Field("", max_length=200)
    estimate: float | None = None
    response_time: float | None = Field(None, ge=0.0, le=86400.0)
    started_monotonic: float = Field(0.0, ge=0.0, le=1e12)
    ended_monotonic: float = Field(0.0, ge=0.0, le=1e12)


class RehearseStudy(NamedStudy):
    """How many simulated participants do the study."""

    participants: int = Field(ge=1, le=200)


class ExportStudy(NamedStudy):
    """A study's export."""

    format: str = Field(max_length=20)


class MergeStudy(NamedStudy):
    """Another station's file."""

    other: str = Field(max_length=100)


class StudyThread:
    """The one thread on which all studies of a lab live."""

    def __init__(self, lab: Lab) -> None:
        self._pool = ThreadPoolExecutor(1, thread_name_prefix="studies")
        self._lab = lab
        self._studies: Studies | None = None
        lab.closing.append(self.close)

    async def do(self, work: Callable[..., T], *arguments: Any) -> T:
        """`work(studies, *arguments)` on the thread."""
        return await asyncio.get_running_loop().run_in_executor(
            self._pool, lambda: work(self._opened(), *arguments)
        )

    def _opened(self) -> Studies:
        if self._studies is None:
            self._studies = Studies(self._lab.folder)
        return self._studies

    def close(self) -> None:
        """Close the files and end the thread."""
        if self._studies is not None:
            self._pool.submit(self._studies.close).result(timeout=10)
            self._studies = None
        self._pool.shutdown(wait=True)


def add_study(lab: Lab, devices: StudyDevices | None = None) -> StudyThread:
    """Let the lab answer the Study area's and the participants' messages.

    `devices` present the surfaces; real sessions on real devices and twins if None.
    """
    devices = devices or StudyDevices()
    devices.playing = lab.playing
    lab.closing.append(devices.close)
    thread = StudyThread(lab)
    pages: dict[str, WebSocket] = {}

    def left(page: WebSocket) -> None:
        # Nobody is there to feel it, or to stop it.
        for sitting in [sitting for sitting, one in pages.items() if one is page]:
            del pages[sitting]
            devices.halt(sitting)

    lab.left.append(left)
    exposures: dict[str, Exposure] = {}

    async def exposed(display: str) -> Exposure:
        if display not in exposures:
            exposures[display] = await lab.workers.slow.do(None, _exposure, display)
        return exposures[display]

    def changed(study: str) -> None:
        lab.tell({"type": "study changed", "study": study})

    async def listing(_: Request) -> Answer:
        found = await thread.do(Studies.listing)
        return {"type": "studies", **found, "tablets": lab.lan is not None}

    async def plan(asked: PlanStudy) -> Answer:
        return {"type": "plan", **await thread.do(Studies.plan, asked.design)}

    async def create(asked: CreateStudy) -> Answer:
        found = await thread.do(Studies.create, asked.design, asked.study, asked.seed)
        return {"type": "study", **found}

    async def status(asked: NamedStudy) -> Answer:
        return {"type": "study", **await thread.do(Studies.status, asked.study)}

    async def enrol(asked: NamedStudy) -> Answer:
        found = await thread.do(Studies.enrol, asked.study)
        changed(asked.study)
        return {"type": "study", **found}

    async def ultrasound(asked: OfParticipant) -> Answer:
        display = await thread.do(Studies.display_of, asked.study, asked.participant)
        if display is None:
            raise InputError(f"participant {asked.participant} has answered every trial")
        found = await exposed(display)
        return {"type": "exposure", "display": display, "statement": found.statement}

    async def prepare(asked: PrepareSitting) -> Answer:
        display = await thread.do(Studies.display_of, asked.study, asked.participant)
        require_device(asked.device, display)
        found = await thread.do(
            Studies.prepare, asked.study, asked.participant, asked.device, asked.consent,
            asked.conditions, asked.acknowledged,
        )  # fmt: skip
        await release_ended()
        return {"type": "study", **found}

    async def station(asked: OfSitting) -> Answer:
        await thread.do(lambda studies: studies.sittings.get(asked.sitting))
        token = lab.keys.new_link("participant", f"/participant#{asked.sitting}")
        return {"type": "link", "path": f"/?token={token}"}

    async def code(asked: OfSitting) -> Answer:
        if lab.lan is None:
            raise InputError("tablets are paired where the lab was started with --lan ADDRESS")
        await thread.do(lambda studies: studies.sittings.get(asked.sitting))
        return {
            "type": "code",
            "code": lab.keys.new_code(f"/participant#{asked.sitting}"),
            "link": lab.lan.link,
            "fingerprint": lab.lan.fingerprint,
            "life_s": CODE_LIFE,
        }

    async def end(asked: OfSitting) -> Answer:
        sitting = await thread.do(lambda studies: studies.sittings.get(asked.sitting))
        device, lost = await measured_last(sitting)
        found = await thread.do(Studies.end, asked.sitting, device)
        found["problems"] += [lost] if lost else []
        await release_ended()
        lab.tell({"type": "sitting ended", "sitting": asked.sitting}, participants=True)
        return {"type": "study", **found}

    async def delete(asked: DeleteParticipant) -> Answer:
        if asked.confirm != asked.participant:
            raise InputError(f"to delete {asked.participant}, type exactly that; nothing was done")
        for one in await thread.do(lambda studies: studies.sittings.of_study(asked.study)):
            if one.participant == asked.participant:
                await devices.release(one.id)
        found = await thread.do(Studies.delete, asked.study, asked.participant)
        changed(asked.study)
        return {"type": "study", **found}

    async def export(asked: ExportStudy) -> Answer:
        return {"type": "exported", **await thread.do(Studies.export, asked.study, asked.format)}

    async def rehearse(asked: RehearseStudy) -> Answer:
        path = await thread.do(Studies.path, asked.study)
        found = await lab.workers.slow.do(None, rehearsed, path, asked.participants)
        changed(asked.study)
        return {"type": "rehearsed", **found}

    async def analyze(asked: NamedStudy) -> Answer:
        path = await thread.do(Studies.path, asked.study)
        return {"type": "analysis", **await lab.workers.slow.do("analysis", analysis_of, path)}

    async def report(asked: NamedStudy) -> Answer:
        path = await thread.do(Studies.path, asked.study)
        return {"type": "report", **await lab.workers.slow.do("report", report_of, path)}

    async def merged(asked: MergeStudy) -> Answer:
        return {"type": "study", **await thread.do(Studies.merge, asked.study, asked.other)}

    async def measured(sitting: Sitting) -> StudyDevice:
        display = await thread.do(Studies.display_of_sitting, sitting.id)
        traces = await thread.do(Studies.traces, sitting.study)
        return await devices.measure(sitting.id, sitting.device, display, traces)

    async def measured_last(sitting: Sitting) -> tuple[StudyDevice, str]:
        """The device after a sitting, which ends also where its device is gone: that is said."""
        if sitting.session is None or sitting.ended:
            return NoDevice(), ""
        try:
            return await measured(sitting), ""
        except (DeviceError, InputError) as error:
            lost = f"the device could not be verified: {error}"
            found = DeviceVerification(measurable=False, remark=lost)
            return Measured(DeviceIdentity(sitting.device.partition(":")[0]), found), lost

    async def release_ended() -> None:
        for held in devices.holders():
            if await thread.do(Studies.has_ended, held):
                await devices.release(held)

    async def where(asked: OfSitting) -> Answer:
        return {"type": "where", **await thread.do(Studies.where, asked.sitting)}

    async def consent(asked: OfSitting) -> Answer:
        sitting = await thread.do(lambda studies: studies.sittings.get(asked.sitting))
        if sitting.session is not None or sitting.ended:
            return await where(asked)
        device, seen = await measured(sitting), None
        try:
            if sitting.device != "none":
                seen = await exposed(await thread.do(Studies.display_of_sitting, sitting.id))
            found = await thread.do(Studies.consent, asked.sitting, seen, device)
        except BaseException:
            await devices.release(sitting.id)
            raise
        changed(sitting.study)
        return {"type": "where", **found}

    async def present(asked: OfSitting) -> Answer:
        found = await thread.do(Studies.present, asked.sitting)
        study = found.pop("study", None)
        if study is not None:
            # Who presents by hand is told what; the participant's page is not.
            changed(study)
        return {"type": "where", **found}

    async def feel(asked: FeelSurface) -> Answer:
        sitting = await thread.do(lambda studies: studies.sittings.get(asked.sitting))
        if sitting.device == "none":
            raise InputError("this sitting has no device")
        surface = await thread.do(Studies.surface, sitting.id, asked.token, asked.place)
        display = await thread.do(Studies.display_of_sitting, sitting.id)
        traces = await thread.do(Studies.traces, sitting.study)
        pages[sitting.id] = PAGE.get()
        await devices.present(
            sitting.id, sitting.device, display, traces, surface, asked.token, asked.place
        )
        return {"type": "playing", "place": asked.place}

    async def felt(asked: SurfacesFelt) -> Answer:
        await devices.felt(asked.sitting, asked.token)
        return {"type": "silent"}

    async def stop(asked: OfSitting) -> Answer:
        devices.halt(asked.sitting)
        return {"type": "silent"}

    async def respond(asked: Respond) -> Answer:
        felt: tuple[Exploration, ...] = ()
        if await thread.do(Studies.needs_device, asked.sitting, asked.token):
            felt = await devices.felt(asked.sitting, asked.token)
        response = Response(
            choice=asked.choice,
            estimate=asked.estimate,
            response_time=asked.response_time,
            started_monotonic=asked.started_monotonic,
            ended_monotonic=asked.ended_monotonic,
            explorations=felt,
        )
        found = await thread.do(Studies.respond, asked.sitting, asked.token, response)
        devices.answered(asked.sitting, asked.token)
        changed(found.pop("study"))
        return {"type": "acknowledged", **found}

    add = lab.experimenter.add
    add("studies", Request, listing)
    add("plan study", PlanStudy, plan)
    add("create study", CreateStudy, create)
    add("study", NamedStudy, status)
    add("enrol", NamedStudy, enrol)
    add("exposure", OfParticipant, ultrasound)
    add("prepare sitting", PrepareSitting, prepare)
    add("station link", OfSitting, station)
    add("pairing code", OfSitting, code)
    add("end sitting", OfSitting, end)
    add("delete participant", DeleteParticipant, delete)
    add("export study", ExportStudy, export)
    add("merge study", MergeStudy, merged)
    add("rehearse study", RehearseStudy, rehearse)
    add("analyze study", NamedStudy, analyze)
    add("report study", NamedStudy, report)
    add = lab.participant.add
    add("where", OfSitting, where)
    add("consent", OfSitting, consent)
    add("next", OfSitting, present)
    add("feel", FeelSurface, feel)
    add("felt", SurfacesFelt, felt)
    add("stop surface", OfSitting, stop)
    add("respond", Respond, respond)
    return thread


def _exposure(display: str) -> Exposure:
    from squeezefilm.display import load_display

    return exposure(load_display(display), _LONGEST_SESSION)
