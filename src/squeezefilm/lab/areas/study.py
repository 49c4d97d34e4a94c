"""The messages of the Study and Results areas, and of the participant's page."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING, Any, TypeVar

from squeezefilm.errors import DeviceError, InputError
from squeezefilm.lab.areas.study_requests import (
    CreateStudy,
    DeleteParticipant,
    ExportStudy,
    FeelSurface,
    MergeStudy,
    NamedStudy,
    OfParticipant,
    OfSitting,
    PlanStudy,
    PrepareSitting,
    RehearseStudy,
    Respond,
    SurfacesFelt,
)
from squeezefilm.lab.keys import CODE_LIFE
from squeezefilm.lab.studying.devices import Measured, StudyDevices, require_device
from squeezefilm.lab.studying.jobs import analysis_of, rehearsed, report_of
from squeezefilm.lab.studying.studies import Studies
from squeezefilm.lab.wire import Answer, Request
from squeezefilm.lab.worker import PAGE
from squeezefilm.study.conduct.run import Response
from squeezefilm.study.conduct.sessions import Exposure, exposure
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


class StudyArea:
    """What the Study area's and the participants' messages do; `thread` has the studies' files.

    `devices` present the surfaces; real sessions on real devices and twins if None.
    """

    def __init__(self, lab: Lab, devices: StudyDevices | None = None) -> None:
        self._lab, self.thread = lab, StudyThread(lab)
        self._devices = devices or StudyDevices()
        self._devices.playing = lab.playing
        self._pages: dict[str, WebSocket] = {}
        self._exposures: dict[str, Exposure] = {}
        lab.closing.append(self._devices.close)
        lab.left.append(self._left)
        add = lab.experimenter.add
        add("studies", Request, self._listing)
        add("plan study", PlanStudy, self._plan)
        add("create study", CreateStudy, self._create)
        add("study", NamedStudy, self._status)
        add("enrol", NamedStudy, self._enrol)
        add("exposure", OfParticipant, self._ultrasound)
        add("prepare sitting", PrepareSitting, self._prepare)
        add("station link", OfSitting, self._station)
        add("pairing code", OfSitting, self._code)
        add("end sitting", OfSitting, self._end)
        add("delete participant", DeleteParticipant, self._delete)
        add("export study", ExportStudy, self._export)
        add("merge study", MergeStudy, self._merged)
        add("rehearse study", RehearseStudy, self._rehearse)
        add("analyze study", NamedStudy, self._analyze)
        add("report study", NamedStudy, self._report)
        add = lab.participant.add
        add("where", OfSitting, self._where)
        add("consent", OfSitting, self._consent)
        add("next", OfSitting, self._present)
        add("feel", FeelSurface, self._feel)
        add("felt", SurfacesFelt, self._felt)
        add("stop surface", OfSitting, self._stop)
        add("respond", Respond, self._respond)

    def _left(self, page: WebSocket) -> None:
        # Nobody is there to feel it, or to stop it.
        for sitting in [sitting for sitting, one in self._pages.items() if one is page]:
            del self._pages[sitting]
            self._devices.halt(sitting)

    async def _exposed(self, display: str) -> Exposure:
        if display not in self._exposures:
            self._exposures[display] = await self._lab.workers.slow.do(None, _exposure, display)
        return self._exposures[display]

    def _changed(self, study: str) -> None:
        self._lab.tell({"type": "study changed", "study": study})

    async def _listing(self, _: Request) -> Answer:
        found = await self.thread.do(Studies.listing)
        return {"type": "studies", **found, "tablets": self._lab.lan is not None}

    async def _plan(self, asked: PlanStudy) -> Answer:
        return {"type": "plan", **await self.thread.do(Studies.plan, asked.design)}

    async def _create(self, asked: CreateStudy) -> Answer:
        found = await self.thread.do(Studies.create, asked.design, asked.study, asked.seed)
        return {"type": "study", **found}

    async def _status(self, asked: NamedStudy) -> Answer:
        return {"type": "study", **await self.thread.do(Studies.status, asked.study)}

    async def _enrol(self, asked: NamedStudy) -> Answer:
        found = await self.thread.do(Studies.enrol, asked.study)
        self._changed(asked.study)
        return {"type": "study", **found}

    async def _ultrasound(self, asked: OfParticipant) -> Answer:
        display = await self.thread.do(Studies.display_of, asked.study, asked.participant)
        if display is None:
            raise InputError(f"participant {asked.participant} has answered every trial")
        found = await self._exposed(display)
        return {"type": "exposure", "display": display, "statement": found.statement}

    async def _prepare(self, asked: PrepareSitting) -> Answer:
        display = await self.thread.do(Studies.display_of, asked.study, asked.participant)
        require_device(asked.device, display)
        found = await self.thread.do(
            Studies.prepare,
            asked.study,
            asked.participant,
            asked.device,
            asked.consent,
            asked.conditions,
            asked.acknowledged,
        )
        await self._release_ended()
        return {"type": "study", **found}

    async def _station(self, asked: OfSitting) -> Answer:
        await self.thread.do(lambda studies: studies.sittings.get(asked.sitting))
        token = self._lab.keys.new_link("participant", f"/participant#{asked.sitting}")
        return {"type": "link", "path": f"/?token={token}"}

    async def _code(self, asked: OfSitting) -> Answer:
        if self._lab.lan is None:
            raise InputError("tablets are paired where the lab was started with --lan ADDRESS")
        await self.thread.do(lambda studies: studies.sittings.get(asked.sitting))
        return {
            "type": "code",
            "code": self._lab.keys.new_code(f"/participant#{asked.sitting}"),
            "link": self._lab.lan.link,
            "fingerprint": self._lab.lan.fingerprint,
            "life_s": CODE_LIFE,
        }

    async def _end(self, asked: OfSitting) -> Answer:
        sitting = await self.thread.do(lambda studies: studies.sittings.get(asked.sitting))
        device, lost = await self._measured_last(sitting)
        found = await self.thread.do(Studies.end, asked.sitting, device)
        found["problems"] += [lost] if lost else []
        await self._release_ended()
        self._lab.tell({"type": "sitting ended", "sitting": asked.sitting}, participants=True)
        return {"type": "study", **found}

    async def _delete(self, asked: DeleteParticipant) -> Answer:
        if asked.confirm != asked.participant:
            raise InputError(f"to delete {asked.participant}, type exactly that; nothing was done")
        for one in await self.thread.do(lambda studies: studies.sittings.of_study(asked.study)):
            if one.participant == asked.participant:
                await self._devices.release(one.id)
        found = await self.thread.do(Studies.delete, asked.study, asked.participant)
        self._changed(asked.study)
        return {"type": "study", **found}

    async def _export(self, asked: ExportStudy) -> Answer:
        return {
            "type": "exported",
            **await self.thread.do(Studies.export, asked.study, asked.format),
        }

    async def _rehearse(self, asked: RehearseStudy) -> Answer:
        path = await self.thread.do(Studies.path, asked.study)
        found = await self._lab.workers.slow.do(None, rehearsed, path, asked.participants)
        self._changed(asked.study)
        return {"type": "rehearsed", **found}

    async def _analyze(self, asked: NamedStudy) -> Answer:
        path = await self.thread.do(Studies.path, asked.study)
        return {
            "type": "analysis",
            **await self._lab.workers.slow.do("analysis", analysis_of, path),
        }

    async def _report(self, asked: NamedStudy) -> Answer:
        path = await self.thread.do(Studies.path, asked.study)
        return {"type": "report", **await self._lab.workers.slow.do("report", report_of, path)}

    async def _merged(self, asked: MergeStudy) -> Answer:
        return {"type": "study", **await self.thread.do(Studies.merge, asked.study, asked.other)}

    async def _measured(self, sitting: Sitting) -> StudyDevice:
        display = await self.thread.do(Studies.display_of_sitting, sitting.id)
        traces = await self.thread.do(Studies.traces, sitting.study)
        return await self._devices.measure(sitting.id, sitting.device, display, traces)

    async def _measured_last(self, sitting: Sitting) -> tuple[StudyDevice, str]:
        """The device after a sitting, which ends also where its device is gone: that is said."""
        if sitting.session is None or sitting.ended:
            return NoDevice(), ""
        try:
            return await self._measured(sitting), ""
        except (DeviceError, InputError) as error:
            lost = f"the device could not be verified: {error}"
            found = DeviceVerification(measurable=False, remark=lost)
            return Measured(DeviceIdentity(sitting.device.partition(":")[0]), found), lost

    async def _release_ended(self) -> None:
        for held in self._devices.holders():
            if await self.thread.do(Studies.has_ended, held):
                await self._devices.release(held)

    async def _where(self, asked: OfSitting) -> Answer:
        return {"type": "where", **await self.thread.do(Studies.where, asked.sitting)}

    async def _consent(self, asked: OfSitting) -> Answer:
        sitting = await self.thread.do(lambda studies: studies.sittings.get(asked.sitting))
        if sitting.session is not None or sitting.ended:
            return await self._where(asked)
        device, seen = await self._measured(sitting), None
        try:
            if sitting.device != "none":
                seen = await self._exposed(
                    await self.thread.do(Studies.display_of_sitting, sitting.id)
                )
            found = await self.thread.do(Studies.consent, asked.sitting, seen, device)
        except BaseException:
            await self._devices.release(sitting.id)
            raise
        self._changed(sitting.study)
        return {"type": "where", **found}

    async def _present(self, asked: OfSitting) -> Answer:
        found = await self.thread.do(Studies.present, asked.sitting)
        study = found.pop("study", None)
        if study is not None:
            # Who presents by hand is told what; the participant's page is not.
            self._changed(study)
        return {"type": "where", **found}

    async def _feel(self, asked: FeelSurface) -> Answer:
        sitting = await self.thread.do(lambda studies: studies.sittings.get(asked.sitting))
        if sitting.device == "none":
            raise InputError("this sitting has no device")
        surface = await self.thread.do(Studies.surface, sitting.id, asked.token, asked.place)
        display = await self.thread.do(Studies.display_of_sitting, sitting.id)
        traces = await self.thread.do(Studies.traces, sitting.study)
        self._pages[sitting.id] = PAGE.get()
        await self._devices.present(
            sitting.id, sitting.device, display, traces, surface, asked.token, asked.place
        )
        return {"type": "playing", "place": asked.place}

    async def _felt(self, asked: SurfacesFelt) -> Answer:
        await self._devices.felt(asked.sitting, asked.token)
        return {"type": "silent"}

    async def _stop(self, asked: OfSitting) -> Answer:
        self._devices.halt(asked.sitting)
        return {"type": "silent"}

    async def _respond(self, asked: Respond) -> Answer:
        felt: tuple[Exploration, ...] = ()
        if await self.thread.do(Studies.needs_device, asked.sitting, asked.token):
            felt = await self._devices.felt(asked.sitting, asked.token)
        response = Response(
            choice=asked.choice,
            estimate=asked.estimate,
            response_time=asked.response_time,
            started_monotonic=asked.started_monotonic,
            ended_monotonic=asked.ended_monotonic,
            explorations=felt,
        )
        found = await self.thread.do(Studies.respond, asked.sitting, asked.token, response)
        self._devices.answered(asked.sitting, asked.token)
        self._changed(found.pop("study"))
        return {"type": "acknowledged", **found}


def _exposure(display: str) -> Exposure:
    from squeezefilm.display import load_display

    return exposure(load_display(display), _LONGEST_SESSION)
