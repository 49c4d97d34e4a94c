"""The messages of the Study and Results areas, and of the participant's page."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import partial, wraps
from typing import TYPE_CHECKING, Annotated, Any, TypeVar

from pydantic import Field

from squeezefilm.core.errors import DeviceError, InputError
from squeezefilm.lab.guard import CODE_LIFE
from squeezefilm.lab.studying.devices import MeasuredDevice, StudyDevices
from squeezefilm.lab.studying.jobs import analysis_of, rehearsed, report_of
from squeezefilm.lab.studying.studies import PrepareSitting, Studies
from squeezefilm.lab.wire import Answer, Handler, Name, Request
from squeezefilm.lab.worker import PAGE
from squeezefilm.study.conduct.run import Response
from squeezefilm.study.conduct.sessions import Exposure, exposure
from squeezefilm.study.conduct.study_device import (
    DeviceIdentity,
    DeviceVerification,
    NoDevice,
    StudyDevice,
    TrialMotion,
)
from squeezefilm.study.record.sittings import Sitting

if TYPE_CHECKING:
    from starlette.websockets import WebSocket

    from squeezefilm.lab.server import Lab

T = TypeVar("T")
_LONGEST_SESSION = 3600.0


class Respond(Request):
    """An answer to the trial with this token."""

    sitting: Name
    token: Name
    choice: str = Field("", max_length=200)
    estimate: float | None = None
    response_time: float | None = Field(None, ge=0.0, le=86400.0)
    started_monotonic: float = Field(0.0, ge=0.0, le=1e12)
    ended_monotonic: float = Field(0.0, ge=0.0, le=1e12)


class StudyArea:
    """Answers to the Study area's and the participants' messages. All studies live on one thread,
    which has their files.

    `devices` present the surfaces; real sessions on real devices and twins if None.
    """

    def __init__(self, lab: Lab, devices: StudyDevices | None = None) -> None:
        self._lab = lab
        self._studies: Studies | None = None
        self._thread = ThreadPoolExecutor(1, thread_name_prefix="studies")
        lab.closing.append(self._close)
        self._devices = devices or StudyDevices()
        self._devices.playing = lab.playing
        self._pages: dict[str, WebSocket] = {}
        self._exposures: dict[str, Exposure] = {}
        lab.closing.append(self._devices.close)
        lab.left.append(self._left)
        add = lab.experimenter.add
        add("studies", self._listing)
        add("plan study", self._passed_on(Studies.plan, "plan"))
        add("create study", self._passed_on(Studies.create, "study"))
        add("study", self._passed_on(Studies.status, "study"))
        add("export study", self._passed_on(Studies.export, "exported"))
        add("merge study", self._passed_on(Studies.merge, "study"))
        add("enrol", self._passed_on(Studies.enrol, "study"))
        add("exposure", self._ultrasound)
        add("prepare sitting", self._prepare, PrepareSitting)
        add("station link", self._station)
        add("pairing code", self._code)
        add("surface in place", self._in_place)
        add("end sitting", self._end)
        add("delete participant", self._delete)
        add("rehearse study", self._rehearse)
        add("analyze study", self._analyze)
        add("report study", self._report)
        add = lab.participant.add
        add("where", self._passed_on(Studies.where, "where"))
        add("consent", self._consent)
        add("next", self._passed_on(Studies.present, "where"))
        add("feel", self._feel)
        add("surface in place", self._in_place)
        add("felt", self._felt)
        add("stop surface", self._stop)
        add("respond", self._respond, Respond)

    async def _do(self, work: Callable[..., T], *arguments: Any) -> T:
        """`work(studies, *arguments)` on the thread of the studies."""

        def on_thread() -> T:
            if self._studies is None:
                self._studies = Studies(self._lab.folder)
            return work(self._studies, *arguments)

        return await asyncio.get_running_loop().run_in_executor(self._thread, on_thread)

    def _close(self) -> None:
        if self._studies is not None:
            self._thread.submit(self._studies.close).result(timeout=10)
            self._studies = None
        self._thread.shutdown(wait=True)

    def _left(self, page: WebSocket) -> None:
        # Nobody is there to feel it, or to stop it.
        for sitting in [sitting for sitting, holder in self._pages.items() if holder is page]:
            del self._pages[sitting]
            self._devices.halt(sitting)

    def _passed_on(self, work: Callable[..., Answer], answer: str) -> Handler:
        """Answers by `work(studies, …)`, whose arguments are the message's fields; every
        experimenter hears of a study that it says is `changed`."""

        @wraps(work)
        async def passed(**asked: Any) -> Answer:
            done = await self._do(partial(work, **asked))
            if changed := done.pop("changed", ""):
                self._changed(changed)
            return {"type": answer, **done}

        return passed

    async def _exposed(self, display: str) -> Exposure:
        if display not in self._exposures:
            self._exposures[display] = await self._lab.slow.do(None, _exposure, display)
        return self._exposures[display]

    def _changed(self, study: str) -> None:
        self._lab.tell({"type": "study changed", "study": study})

    async def _sitting(self, sitting: str) -> Sitting:
        return await self._do(lambda studies: studies.sittings.get(sitting))

    async def _listing(self) -> Answer:
        answer = await self._do(Studies.listing)
        return {"type": "studies", **answer, "tablets": self._lab.lan is not None}

    async def _ultrasound(self, study: Name, participant: Name) -> Answer:
        display = await self._do(Studies.display_of, study, participant)
        exposure = await self._exposed(display)
        return {"type": "exposure", "display": display, "statement": exposure.statement}

    async def _prepare(self, asked: PrepareSitting) -> Answer:
        display = await self._do(Studies.display_of, asked.study, asked.participant)
        if asked.device != "none":
            from squeezefilm.study.conduct.played_device import require_study_drive

            require_study_drive(asked.device, display)
        answer = await self._do(Studies.prepare, asked)
        await self._release_ended()
        return {"type": "study", **answer}

    async def _station(self, sitting: Name) -> Answer:
        await self._sitting(sitting)
        token = self._lab.keys.new_link("participant", f"/participant#{sitting}")
        return {"type": "link", "path": f"/?token={token}"}

    async def _code(self, sitting: Name) -> Answer:
        if self._lab.lan is None:
            raise InputError("tablets are paired where the lab was started with lan ADDRESS")
        await self._sitting(sitting)
        return {
            "type": "code",
            "code": self._lab.keys.new_code(f"/participant#{sitting}"),
            "link": self._lab.lan.link,
            "fingerprint": self._lab.lan.fingerprint,
            "life_s": CODE_LIFE,
        }

    async def _end(self, sitting: Name) -> Answer:
        device, lost = await self._measured_last(await self._sitting(sitting))
        answer = await self._do(Studies.end, sitting, device)
        answer["problems"] += [lost] if lost else []
        await self._release_ended()
        self._lab.tell({"type": "sitting ended", "sitting": sitting}, participants=True)
        return {"type": "study", **answer}

    async def _delete(self, study: Name, participant: Name, confirm: Name) -> Answer:
        if confirm != participant:
            raise InputError(f"to delete {participant}, type exactly that; nothing was done")
        for sitting in await self._do(lambda studies: studies.sittings.of_study(study)):
            if sitting.participant == participant:
                await self._devices.release(sitting.id)
        answer = await self._do(Studies.delete, study, participant)
        self._changed(study)
        return {"type": "study", **answer}

    async def _rehearse(
        self, study: Name, participants: Annotated[int, Field(ge=1, le=200)]
    ) -> Answer:
        answer = await self._of_file(study, None, rehearsed, participants)
        self._changed(study)
        return {"type": "rehearsed", **answer}

    async def _analyze(self, study: Name) -> Answer:
        return {"type": "analysis", **await self._of_file(study, "analysis", analysis_of)}

    async def _report(self, study: Name) -> Answer:
        return {"type": "report", **await self._of_file(study, "report", report_of)}

    async def _of_file(
        self, study: str, slot: str | None, work: Callable[..., Answer], *more: Any
    ) -> Answer:
        path = await self._do(Studies.path, study)
        return await self._lab.slow.do(slot, work, path, *more)

    async def _measured_last(self, sitting: Sitting) -> tuple[StudyDevice, str]:
        """The device after a sitting, which ends also where its device is gone: that is said."""
        if sitting.session is None or sitting.ended:
            return NoDevice(), ""
        try:
            orders = await self._do(Studies.orders, sitting.id)
            return await self._devices.measure(sitting.id, orders), ""
        except (DeviceError, InputError) as error:
            lost = f"the device could not be verified: {error}"
            verification = DeviceVerification(measurable=False, remark=lost)
            return MeasuredDevice(
                DeviceIdentity(sitting.device.partition(":")[0]), verification
            ), lost

    async def _release_ended(self) -> None:
        for held in self._devices.holders():
            is_open = await self._do(lambda studies, id: studies.sittings.is_open(id), held)
            if not is_open:
                await self._devices.release(held)

    async def _consent(self, sitting: Name) -> Answer:
        prepared = await self._sitting(sitting)
        if prepared.session is not None or prepared.ended:
            return {"type": "where", **await self._do(Studies.where, sitting)}
        orders = await self._do(Studies.orders, sitting)
        device = await self._devices.measure(sitting, orders)
        try:
            plays = orders.drive != "none"
            seen = await self._exposed(str(orders.target)) if plays else None
            answer = await self._do(Studies.consent, sitting, seen, device)
        except BaseException:
            await self._devices.release(sitting)
            raise
        self._changed(prepared.study)
        return {"type": "where", **answer}

    async def _feel(
        self, sitting: Name, token: Name, place: Annotated[int, Field(ge=0, le=9)]
    ) -> Answer:
        how, surface = await self._do(Studies.asked_to_feel, sitting, token, place)
        if surface is None:
            self._changed((await self._sitting(sitting)).study)
            return {"type": "waiting" if how == "by hand" else "shown", "place": place}
        orders = await self._do(Studies.orders, sitting)
        self._pages[sitting] = PAGE.get()
        await self._devices.present(sitting, orders, surface, token, place)
        return {"type": "playing", "place": place}

    async def _in_place(self, sitting: Name) -> Answer:
        study, place = await self._do(Studies.in_place, sitting)
        self._changed(study)
        # The participant's page begins its clock.
        said = {"type": "surface in place", "sitting": sitting, "place": place}
        self._lab.tell(said, participants=True)
        return {"type": "in place", "place": place}

    async def _felt(self, sitting: Name, token: Name) -> Answer:
        await self._devices.felt(sitting, token)
        return {"type": "silent"}

    async def _stop(self, sitting: Name) -> Answer:
        self._devices.halt(sitting)
        return {"type": "silent"}

    async def _respond(self, asked: Respond) -> Answer:
        felt: tuple[TrialMotion, ...] = ()
        if await self._do(Studies.needs_device, asked.sitting, asked.token):
            felt = await self._devices.felt(asked.sitting, asked.token)
        told = asked.model_dump(exclude={"id", "type", "sitting", "token"})
        response = Response(**told, explorations=felt)
        answer = await self._do(Studies.respond, asked.sitting, asked.token, response)
        self._devices.answered(asked.sitting, asked.token)
        self._changed(answer.pop("study"))
        return {"type": "acknowledged", **answer}


def _exposure(display: str) -> Exposure:
    from squeezefilm.physics.display import load_display

    return exposure(load_display(display), _LONGEST_SESSION)
