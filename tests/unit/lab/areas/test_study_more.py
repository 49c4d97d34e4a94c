"""What the Study area answers beside its devices: files, links, codes, exposure, jobs, endings."""

from __future__ import annotations

import contextvars
import shutil
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from pydantic import ValidationError
from tests.unit.lab.areas.too_long import require_refused_if_longer

from squeezefilm.core import presets
from squeezefilm.core.errors import DeviceError
from squeezefilm.lab.areas import study as study_area
from squeezefilm.lab.areas.study import (
    StudyArea,
)
from squeezefilm.lab.guard import CODE_LIFE
from squeezefilm.lab.server import LanPlace
from squeezefilm.lab.studying.devices import StudyDevices
from squeezefilm.lab.worker import PAGE
from squeezefilm.study.conduct.sessions import Exposure
from squeezefilm.study.conduct.study_device import DeviceIdentity, DeviceVerification, TrialMotion
from squeezefilm.study.record.store import StudyStore

from ...study.scripted import gratings, run_through, staircase

if TYPE_CHECKING:
    from .conftest import Talk

EXPOSURE = Exposure("stator", 40.5e3, 0.5, 120.0, 3600.0, None, "", "made up for this test")
AGREED = "I agree to take part in this."


class Device:
    """A device that says what it was asked, and may be gone."""

    def __init__(self) -> None:
        self.asked: list[str] = []
        self.gone = False

    def identity(self) -> DeviceIdentity:
        return DeviceIdentity("bench")

    def verify_device(self) -> DeviceVerification:
        if self.gone:
            raise DeviceError("nothing answers")
        return DeviceVerification(resonance_frequency=40.5e3, expected_resonance_frequency=40.5e3)

    def present(self, stimulus: object, seed: int) -> None:
        self.asked.append("present")

    def stop(self) -> TrialMotion:
        self.asked.append("stop")
        return TrialMotion()

    def halt(self) -> None:
        self.asked.append("halt")

    def close(self) -> None:
        self.asked.append("close")


@pytest.fixture
def device() -> Device:
    return Device()


@pytest.fixture
def lab(talk: Talk, device: Device, monkeypatch: pytest.MonkeyPatch) -> Any:
    """A lab with a study on one display, and a participant of it."""

    def exposed(display: str) -> Exposure:
        assert display == "biet2008-stator"
        return EXPOSURE

    monkeypatch.setattr(study_area, "_exposure", exposed)
    StudyArea(talk.lab, StudyDevices(lambda *_: device))
    file = talk.folder / "studies" / "one.sqlite"
    file.parent.mkdir()
    StudyStore.create(file, gratings(displays=("biet2008-stator",)), 4).close()
    yield talk
    talk.lab.close()


def enrolled(lab: Talk) -> dict[str, str]:
    """One more participant, as requests name them."""
    who = lab.say("enrol", study="one")["participants"][-1]["pseudonym"]
    return {"study": "one", "participant": who}


def prepared(lab: Talk, device: str = "none", **of: str) -> str:
    """A sitting for a new participant, or the one that is named."""
    made = lab.say(
        "prepare sitting", **(of or enrolled(lab)), device=device, consent=AGREED, acknowledged=True
    )
    assert made["type"] == "study"
    return str(made["sitting"])


def test_designs_and_studies_are_listed_and_whether_tablets_may_come(lab: Talk) -> None:
    found = lab.say("studies")
    assert found["type"] == "studies"
    assert [one["name"] for one in found["designs"]] == list(presets.study_names())
    assert (found["studies"], found["tablets"]) == (["one"], False)
    lab.lab.lan = LanPlace("https://10.0.0.1:8632/pair", "AB:CD")
    assert lab.say("studies")["tablets"] is True


def test_a_design_is_planned_before_a_study_is_made_of_it(lab: Talk) -> None:
    plan = lab.say("plan study", design="friction-jnd")
    assert plan["type"] == "plan"
    assert f"about {round(plan['duration_s'] / 60)} minutes" in plan["consent"]
    made = lab.say("create study", design="friction-jnd", study="two", seed=11)
    assert (made["type"], made["name"], made["seed"]) == ("study", "two", 11)
    assert made["consent"] == plan["consent"]
    assert "two.sqlite exists" in lab.refused("create study", design="bump", study="two", seed=1)
    assert lab.say("studies")["studies"] == ["one", "two"]


def test_every_experimenter_hears_of_a_change(lab: Talk) -> None:
    page, tablet = lab.opened(), lab.opened(is_participant=True)
    found = lab.say("enrol", study="one")
    assert lab.say("study", study="one") == found
    assert page.heard == [{"type": "study changed", "study": "one"}]
    assert tablet.heard == []


def test_exposure_is_computed_once_for_a_display(lab: Talk) -> None:
    of = enrolled(lab)
    for _ in range(2):
        found = lab.say("exposure", **of)
        assert found == {
            "type": "exposure", "display": "biet2008-stator", "statement": EXPOSURE.statement,
        }  # fmt: skip
    assert lab.asked == [("slow", None, "exposed", False)]


def test_who_has_answered_everything_is_exposed_to_nothing(lab: Talk) -> None:
    design = gratings(1, displays=("biet2008-stator",))
    run_through(lab.folder / "studies" / "done.sqlite", design, people=1).close()
    (one,) = lab.say("study", study="done")["participants"]
    who = one["pseudonym"]
    said = lab.refused("exposure", study="done", participant=who)
    assert said == f"participant {who} has answered every trial; enrol another"


def test_a_link_leads_a_station_to_its_sitting(lab: Talk) -> None:
    sitting = prepared(lab)
    found = lab.say("station link", sitting=sitting)
    assert found["type"] == "link"
    path, token = found["path"].split("=")
    assert path == "/?token"
    entered = lab.lab.keys.use_link(token)
    assert entered is not None
    assert (entered[0].role, entered[1]) == ("participant", f"/participant#{sitting}")
    assert "error" in lab.say("station link", sitting="no such")["type"]


def test_a_code_pairs_a_tablet_where_the_lab_has_an_address_for_them(lab: Talk) -> None:
    sitting = prepared(lab)
    assert "lan ADDRESS" in lab.refused("pairing code", sitting=sitting)
    lab.lab.lan = LanPlace("https://10.0.0.1:8632/pair", "AB:CD")
    found = lab.say("pairing code", sitting=sitting)
    code = found.pop("code")
    assert found == {
        "type": "code", "link": "https://10.0.0.1:8632/pair", "fingerprint": "AB:CD",
        "life_s": CODE_LIFE,
    }  # fmt: skip
    entered = lab.lab.keys.use_code(code)
    assert entered is not None
    assert (entered[0].role, entered[1]) == ("participant", f"/participant#{sitting}")
    assert "error" in lab.say("pairing code", sitting="no such")["type"]


def put_there(lab: Talk, sitting: str, trial: dict[str, Any]) -> None:
    """Put a trial's surfaces before the participant, or feel those that lie there."""
    for place in range(trial["surfaces"]):
        asked = lab.say("feel", sitting=sitting, token=trial["token"], place=place)
        if asked["type"] == "waiting":
            assert lab.say("surface in place", sitting=sitting)["place"] == place
        else:
            assert asked == {"type": "shown", "place": place}


def test_a_trial_by_hand_begins_when_its_surface_is_in_place(lab: Talk) -> None:
    file = lab.folder / "studies" / "hand.sqlite"
    StudyStore.create(file, replace(staircase(4), practice=0), 4).close()
    who = lab.say("enrol", study="hand")["participants"][-1]["pseudonym"]
    sitting = prepared(lab, study="hand", participant=who)
    lab.say("consent", sitting=sitting)
    trial = lab.say("next", sitting=sitting)
    here = {"sitting": sitting, "token": trial["token"]}
    answer = {**here, "choice": trial["alternatives"][0]}
    with StudyStore.open(file) as store:

        def presented() -> list[str]:
            return [row["at"] for row in store.rows("SELECT presented_utc AS at FROM presentation")]

        def waits_for() -> int | None:
            (found,) = lab.say("study", study="hand")["sittings"]
            return found["waits_for"]

        assert "no surface is waited for" in lab.refused("surface in place", sitting=sitting)
        assert "not presented yet" in lab.refused("respond", **answer)
        assert lab.say("feel", **here, place=0) == {"type": "waiting", "place": 0}
        # However often the page is loaded again meanwhile.
        lab.say("next", sitting=sitting)
        assert waits_for() is None
        lab.say("feel", **here, place=0)
        assert waits_for() == 0
        assert presented() == []
        assert "not presented yet" in lab.refused("respond", **answer)
        assert lab.say("surface in place", sitting=sitting) == {"type": "in place", "place": 0}
        (began,) = presented()
        assert waits_for() is None
        assert lab.say("feel", **here, place=1) == {"type": "waiting", "place": 1}
        assert "has 2 surfaces" in lab.refused("feel", **here, place=2)
        assert lab.say("surface in place", sitting=sitting)["place"] == 1
        assert lab.say("respond", **answer)["type"] == "acknowledged"
        assert presented() == [began]
        # When the first surface was put there is when the trial began.
        (row,) = store.rows("SELECT started_utc FROM response")
        assert row["started_utc"] == began
        assert "not the one to be presented now" in lab.refused("feel", **here, place=0)


def test_a_sitting_by_hand_from_consent_to_its_end(lab: Talk) -> None:
    of = enrolled(lab)
    sitting = prepared(lab, **of)
    page, tablet = lab.opened(), lab.opened(is_participant=True)
    assert lab.say("where", sitting=sitting) == {
        "type": "where", "state": "consent", "consent": AGREED,
    }  # fmt: skip
    # Nothing is shown before the consent.
    assert lab.say("next", sitting=sitting)["state"] == "consent"
    assert page.heard == []
    assert lab.say("consent", sitting=sitting)["state"] == "ready"
    changed = {"type": "study changed", "study": "one"}
    assert page.heard == [changed]
    assert lab.asked == []  # Without a device there is no sound to compute.
    for number in range(1, 100):
        trial = lab.say("next", sitting=sitting)
        assert trial["type"] == "where"
        if trial["state"] != "trial":
            break
        # Which study it is, and what is felt, is the experimenter's to know.
        assert "study" not in trial
        (told_of,) = lab.say("study", study="one")["sittings"]
        assert len(told_of["by_hand"]) == trial["surfaces"] == 1
        assert told_of["waits_for"] is None
        assert not trial["plays"]
        # Real gratings lie there; virtual surfaces are put in place.
        assert trial["by_hand"] is (number > 3)
        put_there(lab, sitting, trial)
        choice = trial["alternatives"][0] if trial["alternatives"] else ""
        told = lab.say("respond", sitting=sitting, token=trial["token"], choice=choice)
        assert (told["type"], told["number"], told["repeated"]) == ("acknowledged", number, False)
        assert "study" not in told
    assert (trial["state"], number - 1) == ("finished", 3 + 3 * 2)
    # Each trial was told when it came next, was shown (asked for and in place) and was answered.
    assert page.heard == [changed] * (1 + 3 * 3 + 6 * 4)
    in_place = {"type": "surface in place", "sitting": sitting, "place": 0}
    assert tablet.heard == [in_place] * 6
    tablet.heard.clear()
    ended = lab.say("end sitting", sitting=sitting)
    assert (ended["type"], ended["problems"]) == ("study", [])
    assert tablet.heard == [{"type": "sitting ended", "sitting": sitting}]
    assert lab.say("where", sitting=sitting)["state"] == "ended"
    said = lab.refused("prepare sitting", **of, device="none", consent=AGREED, acknowledged=True)
    assert "has answered every trial" in said


def test_the_experimenter_sees_that_a_block_begins_again(lab: Talk) -> None:
    design = replace(gratings(), familiarisation=0, resume_within=3600.0)
    file = lab.folder / "studies" / "left.sqlite"
    StudyStore.create(file, design, 4).close()
    who = lab.say("enrol", study="left")["participants"][-1]["pseudonym"]
    of = {"study": "left", "participant": who}
    first = prepared(lab, **of)
    lab.say("consent", sitting=first)
    for _ in range(2):
        trial = lab.say("next", sitting=first)
        put_there(lab, first, trial)
        lab.say("respond", sitting=first, token=trial["token"], choice=trial["alternatives"][0])
    lab.say("end sitting", sitting=first)
    late = (datetime.now(UTC) - timedelta(hours=30)).isoformat(timespec="milliseconds")
    with StudyStore.open(file) as store, store.transaction() as write:
        write.execute("UPDATE response SET ended_utc = ?", [late])
    second = prepared(lab, **of)
    (shown,) = lab.say("study", study="left")["sittings"]
    assert (shown["id"], shown["begun_again"]) == (second, "")
    lab.say("consent", sitting=second)
    (shown,) = lab.say("study", study="left")["sittings"]
    assert shown["begun_again"] == (
        "the block was left for about 30 h, and may be for 60 min; it begins again: "
        "2 answers are set aside"
    )


@pytest.mark.parametrize(
    ("design", "answer"), [("one", {"choice": "4 mm"}), ("coarseness-magnitude", {"estimate": 42})]
)
def test_what_was_measured_of_an_answer_is_recorded(
    lab: Talk, design: str, answer: dict[str, Any]
) -> None:
    if design != "one":
        lab.say("create study", design=design, study=design, seed=1)
    who = lab.say("enrol", study=design)["participants"][0]["pseudonym"]
    sitting = prepared(lab, study=design, participant=who)
    lab.say("consent", sitting=sitting)
    while (trial := lab.say("next", sitting=sitting))["named"]:
        put_there(lab, sitting, trial)
        lab.say("respond", sitting=sitting, token=trial["token"])
    assert trial["numeric"] is ("estimate" in answer)
    put_there(lab, sitting, trial)
    how = {"response_time": 1.25, "started_monotonic": 10.5, "ended_monotonic": 11.5, **answer}
    lab.say("respond", sitting=sitting, token=trial["token"], **how)
    with StudyStore.open(lab.folder / "studies" / f"{design}.sqlite") as store:
        (row,) = store.rows("SELECT * FROM response WHERE response_time_s IS NOT NULL")
    assert row["response_time_s"] == 1.25
    assert (row["started_monotonic_s"], row["ended_monotonic_s"]) == (10.5, 11.5)
    for field, value in answer.items():
        assert row[field] == value


def test_a_device_that_is_gone_is_said_and_its_sitting_ends(lab: Talk, device: Device) -> None:
    sitting = prepared(lab, "twin")
    assert lab.say("consent", sitting=sitting)["state"] == "ready"
    device.gone = True
    ended = lab.say("end sitting", sitting=sitting)
    assert "the device could not be verified: nothing answers" in ended["problems"]
    assert device.asked[-1] == "close"
    assert lab.say("where", sitting=sitting)["state"] == "ended"
    with StudyStore.open(lab.folder / "studies" / "one.sqlite") as store:
        # As the consent measured it, and that nothing could be in the end.
        assert store.rows("SELECT count(*) AS n FROM verification")[0]["n"] == 2
    # Again it is only said that it has ended.
    device.asked.clear()
    assert lab.say("end sitting", sitting=sitting)["problems"] == []
    assert device.asked == []


def test_a_sitting_that_was_not_consented_to_ends_without_its_device(
    lab: Talk, device: Device
) -> None:
    assert lab.say("end sitting", sitting=prepared(lab, "twin"))["problems"] == []
    assert device.asked == []


def test_a_surface_plays_until_it_is_felt_or_stopped(lab: Talk, device: Device) -> None:
    sitting = prepared(lab, "twin")
    lab.say("consent", sitting=sitting)
    while not (trial := lab.say("next", sitting=sitting))["plays"]:
        put_there(lab, sitting, trial)
        lab.say("respond", sitting=sitting, token=trial["token"])
    here = {"sitting": sitting, "token": trial["token"]}
    page, other = lab.opened(is_participant=True), lab.opened(is_participant=True)
    context = contextvars.copy_context()
    context.run(PAGE.set, page)  # type: ignore[arg-type]
    played = context.run(lab.say, "feel", **here, place=0)
    assert played == {"type": "playing", "place": 0}
    assert device.asked[-1] == "present"
    assert lab.say("felt", **here) == {"type": "silent"}
    assert device.asked[-1] == "stop"
    assert lab.say("stop surface", sitting=sitting) == {"type": "silent"}
    assert device.asked[-1] == "halt"
    context.run(lab.say, "feel", **here, place=0)
    (left,) = lab.lab.left
    left(other)  # type: ignore[arg-type]
    assert device.asked[-1] == "present"
    left(page)  # type: ignore[arg-type]
    assert device.asked[-1] == "halt"
    device.asked.clear()
    left(page)  # type: ignore[arg-type]
    assert device.asked == []


def test_a_device_is_free_once_its_sitting_has_ended(lab: Talk, device: Device) -> None:
    of = enrolled(lab)
    first = prepared(lab, "twin", **of)
    lab.say("consent", sitting=first)
    second = prepared(lab, "twin")
    assert "in use by another sitting" in lab.refused("consent", sitting=second)
    lab.say("end sitting", sitting=first)
    assert lab.say("consent", sitting=second)["state"] == "ready"


def test_deleting_asks_for_the_name_twice_and_lets_the_device_go(lab: Talk, device: Device) -> None:
    of, other = enrolled(lab), enrolled(lab)
    lab.say("consent", sitting=prepared(lab, "twin", **other))
    page = lab.opened()
    said = lab.refused("delete participant", **of, confirm=of["participant"] + " ")
    assert said == f"to delete {of['participant']}, type exactly that; nothing was done"
    assert len(lab.say("study", study="one")["participants"]) == 2
    assert page.heard == []
    found = lab.say("delete participant", **of, confirm=of["participant"])
    assert [one["pseudonym"] for one in found["participants"]] == [other["participant"]]
    assert page.heard == [{"type": "study changed", "study": "one"}]
    assert "close" not in device.asked
    found = lab.say("delete participant", **other, confirm=other["participant"])
    assert (found["type"], found["participants"]) == ("study", [])
    assert device.asked[-1] == "close"


def test_a_study_is_exported_below_the_labs_folder(lab: Talk) -> None:
    enrolled(lab)
    found = lab.say("export study", study="one", format="csv")
    assert found["type"] == "exported"
    assert (lab.folder / found["folder"]).exists()
    assert found["folder"].startswith("studies/")
    said = lab.refused("export study", study="one", format="xlsx")
    assert said == "format = 'xlsx' is not known. Allowed: csv, psych-ds"


def test_two_stations_are_merged(lab: Talk) -> None:
    folder = lab.folder / "studies"
    shutil.copy(folder / "one.sqlite", folder / "two.sqlite")
    lab.say("enrol", study="one")
    lab.say("enrol", study="two")
    found = lab.say("merge study", study="one", other="two")
    assert (found["type"], found["name"]) == ("study", "one")
    assert len(found["participants"]) == 2
    assert "is this file itself" in lab.refused("merge study", study="one", other="one")


def test_exposure_is_that_of_an_hour(monkeypatch: pytest.MonkeyPatch) -> None:
    # Solving the plate's sound takes a minute; for how long is what is asked here.
    monkeypatch.setattr(study_area, "exposure", lambda display, time: (display.name, time))
    assert study_area._exposure("biet2008-plate") == ("biet2008-plate", 3600.0)


def test_jobs_run_on_the_slow_line_with_the_studys_file(
    lab: Talk, monkeypatch: pytest.MonkeyPatch
) -> None:
    given: list[tuple[Any, ...]] = []

    # Each takes seconds, and is tested in test_jobs.
    def rehearsed(path: Path, participants: int) -> dict[str, Any]:
        given.append((path, participants))
        return {"people": participants}

    def analysed(path: Path) -> dict[str, Any]:
        given.append((path,))
        return {"answers": 5}

    def reported(path: Path) -> dict[str, Any]:
        given.append((path,))
        return {"pages": []}

    for name, job in (("rehearsed", rehearsed), ("analysis_of", analysed), ("report_of", reported)):
        monkeypatch.setattr(study_area, name, job)
    page = lab.opened()
    assert lab.say("analyze study", study="one") == {"type": "analysis", "answers": 5}
    assert lab.say("report study", study="one") == {"type": "report", "pages": []}
    assert page.heard == []
    assert lab.say("rehearse study", study="one", participants=3) == {
        "type": "rehearsed", "people": 3,
    }  # fmt: skip
    assert page.heard == [{"type": "study changed", "study": "one"}]
    file = lab.folder / "studies" / "one.sqlite"
    assert given == [(file,), (file,), (file, 3)]
    assert lab.asked == [
        ("slow", "analysis", "analysed", False),
        ("slow", "report", "reported", False),
        ("slow", None, "rehearsed", False),
    ]
    for kind in ("analyze study", "report study"):
        assert "there is no file two.sqlite" in lab.refused(kind, study="two")


def test_a_lab_without_studies_closes(talk: Talk) -> None:
    StudyArea(talk.lab)
    talk.lab.close()


BY_STUDY = {"study": ""}
BY_SITTING = {"sitting": ""}
BY_PERSON = {"study": "", "participant": ""}


@pytest.mark.parametrize(
    ("kind", "field", "most", "others"),
    [
        ("study", "study", 100, {}),
        ("plan study", "design", 100, {}),
        ("create study", "study", 64, {"design": "", "seed": 0}),
        ("exposure", "participant", 100, BY_STUDY),
        ("delete participant", "confirm", 100, BY_PERSON),
        ("prepare sitting", "device", 100, {**BY_PERSON, "consent": AGREED}),
        ("prepare sitting", "consent", 20_000, {**BY_PERSON, "device": ""}),
        ("where", "sitting", 100, {}),
        ("feel", "token", 100, {**BY_SITTING, "place": 0}),
        ("felt", "token", 100, BY_SITTING),
        ("respond", "token", 100, BY_SITTING),
        ("respond", "choice", 200, {**BY_SITTING, "token": ""}),
        ("export study", "format", 20, BY_STUDY),
        ("merge study", "other", 100, BY_STUDY),
    ],
)
def test_texts_that_are_too_long_are_refused(
    lab: Talk, kind: str, field: str, most: int, others: dict[str, Any]
) -> None:
    require_refused_if_longer(lab, kind, field, most, others)


@pytest.mark.parametrize(
    ("kind", "field", "least", "most", "others"),
    [
        ("create study", "seed", 0, 2**53, {"design": "", "study": ""}),
        ("feel", "place", 0, 9, {**BY_SITTING, "token": ""}),
        ("rehearse study", "participants", 1, 200, BY_STUDY),
        ("respond", "response_time", 0, 86400, {**BY_SITTING, "token": ""}),
        ("respond", "started_monotonic", 0, 10**12, {**BY_SITTING, "token": ""}),
        ("respond", "ended_monotonic", 0, 10**12, {**BY_SITTING, "token": ""}),
    ],
)
def test_numbers_outside_their_range_are_refused(
    lab: Talk, kind: str, field: str, least: int, most: int, others: dict[str, Any]
) -> None:
    model = lab.model(kind)
    for inside in (least, most):
        assert getattr(model(id=1, type="t", **others, **{field: inside}), field) == inside
    for outside in (least - 1, most + 1):
        with pytest.raises(ValidationError):
            model(id=1, type="t", **others, **{field: outside})


def test_a_consent_is_a_sentence_at_least(lab: Talk) -> None:
    model = lab.model("prepare sitting")
    how: dict[str, Any] = {"id": 1, "type": "t", **BY_PERSON, "device": "none"}
    assert model(**how, consent="x" * 20).acknowledged is False
    with pytest.raises(ValidationError):
        model(**how, consent="x" * 19)
    with pytest.raises(ValidationError):
        model(**how, consent=AGREED, conditions={str(k): "" for k in range(21)})
