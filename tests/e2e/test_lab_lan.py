"""Tablets by --lan: a real TLS listener on the loopback's second address, where nobody is an
experimenter."""

from __future__ import annotations

import asyncio
import hashlib
import http.client
import json
import re
import ssl
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from websockets.asyncio.client import connect as connect_in_one_thread
from websockets.sync.client import ClientConnection, connect
from websockets.typing import Origin

from squeezefilm.core.errors import InputError
from squeezefilm.lab.lan import certificate, lan_listener

from .conftest import RunningLab, Start
from .test_lab_pages import CONTRAST, keep, opened
from .test_lab_study import answered, chosen, consented, prepared, run_to, small_study

if TYPE_CHECKING:
    from playwright.sync_api import Browser

ADDRESS = "127.0.0.2"


class Tablet:
    """HTTP by TLS to the tablets' address, trusting exactly its certificate."""

    def __init__(self, lab: RunningLab) -> None:
        found = re.search(r"https://([\d.]+):(\d+)/pair", lab.said)
        assert found, lab.said
        self.port = int(found[2])
        self.host = f"{ADDRESS}:{self.port}"
        self.context = ssl.create_default_context(
            cadata=ssl.get_server_certificate((ADDRESS, self.port))
        )
        self.cookie = ""

    def ask(
        self, method: str, path: str, body: str | None = None, **headers: str
    ) -> tuple[int, str]:
        given = {"Origin": f"https://{self.host}", "Cookie": self.cookie, **headers}
        line = http.client.HTTPSConnection(ADDRESS, self.port, context=self.context, timeout=10)
        try:
            line.request(method, path, body, {k.replace("_", "-"): v for k, v in given.items()})
            answer = line.getresponse()
            text = answer.read().decode()
            self.cookie = (answer.headers["set-cookie"] or self.cookie).split(";")[0]
            return answer.status, text
        finally:
            line.close()

    def upgrade(self, path: str, cookie: str) -> int:
        return self.ask(
            "GET", path, Cookie=cookie, Connection="Upgrade", Upgrade="websocket",
            Sec_WebSocket_Version="13", Sec_WebSocket_Key="AAAAAAAAAAAAAAAAAAAAAA==",
        )[0]  # fmt: skip


def experimenters_secret(lab: RunningLab) -> str:
    """An experimenter's cookie of the lab's own address, by its one-time link."""
    line = http.client.HTTPConnection("127.0.0.1", lab.port, timeout=10)
    line.request("GET", lab.link.removeprefix(lab.address.removesuffix("/")))
    answer = line.getresponse()
    assert answer.status == 303
    line.close()
    return str(answer.headers["set-cookie"].split(";")[0].split("=", 1)[1])


def experimenters_page(lab: RunningLab) -> ClientConnection:
    """A websocket of an experimenter's page at the lab's own address."""
    own = f"127.0.0.1:{lab.port}"
    cookie = f"squeezefilm-{lab.port}={experimenters_secret(lab)}"
    return connect(
        f"ws://{own}/ws", origin=Origin(f"http://{own}"), additional_headers={"Cookie": cookie}
    )


@pytest.mark.slow
def test_nobody_is_an_experimenter_there(start_lab: Start, tmp_path: Path) -> None:
    lab = start_lab(tmp_path, None, "--lan", ADDRESS)
    tablet = Tablet(lab)
    secret = experimenters_secret(lab)
    cookie = f"squeezefilm-lan-{tablet.port}={secret}"
    assert tablet.ask("GET", "/")[0] == 303
    assert tablet.ask("GET", "/pair")[0] == 200
    for method, path in [
        ("GET", "/participant"), ("GET", "/static/areas/study.js"), ("GET", "/static/lab.js"),
        ("POST", "/another-station"), ("GET", "/static/renderer.js"),
    ]:  # fmt: skip
        for given in ("", cookie, f"squeezefilm-{lab.port}={secret}"):
            assert tablet.ask(method, path, Cookie=given)[0] == 401, path
    for path in ("/ws", "/ws/participant"):
        assert tablet.upgrade(path, cookie) == 403
    # A link for an experimenter is no link there, and is not used up by the try.
    assert tablet.ask("GET", "/?token=x", Cookie=cookie)[0] == 303
    assert tablet.ask("GET", "/pair", Host="evil.example")[0] == 421
    assert tablet.ask("POST", "/pair", "000000", Origin="https://evil.example")[0] == 403
    assert tablet.ask("POST", "/pair", "000000")[0] == 401
    assert tablet.ask("POST", "/pair", "0" * 1000)[0] == 413
    # The lab's own address speaks no TLS, the tablets' nothing else.
    plain = http.client.HTTPConnection(ADDRESS, tablet.port, timeout=10)
    plain.request("GET", "/pair")
    with pytest.raises((ConnectionError, http.client.HTTPException)):
        plain.getresponse()
    plain.close()


@pytest.mark.slow
def test_a_paired_tablet_says_a_participants_messages_only(
    start_lab: Start, tmp_path: Path
) -> None:
    small_study(tmp_path)
    lab = start_lab(tmp_path, None, "--lan", ADDRESS)
    tablet = Tablet(lab)
    with experimenters_page(lab) as experimenter:

        def ask(**message: object) -> dict[str, Any]:
            experimenter.send(json.dumps({"id": 1, **message}))
            while (answer := json.loads(experimenter.recv(10))).get("id") != 1:
                pass  # What was told to every page.
            return dict(answer)

        kinds = ask(type="?")["message"].split("known: ")[1].split(", ")
        assert {"create study", "pairing code", "delete participant", "play device"} <= set(kinds)
        person = ask(type="enrol", study="small")["participants"][0]["pseudonym"]
        sitting = ask(
            type="prepare sitting", study="small", participant=person, device="none",
            consent="I consent to everything here.",
        )["sitting"]  # fmt: skip
        code = ask(type="pairing code", sitting=sitting)["code"]
    assert json.loads(tablet.ask("POST", "/pair", code)[1]) == {"home": f"/participant#{sitting}"}
    assert tablet.ask("GET", "/participant")[0] == 200
    assert tablet.ask("POST", "/pair", code, Cookie="")[0] == 401
    for method, path in (("POST", "/another-station"), ("GET", "/?token=x")):
        assert tablet.ask(method, path)[0] in (403, 303), path
    assert tablet.upgrade("/ws", tablet.cookie) == 403

    # In one thread: OpenSSL's connection, read in one and written in another as the threaded
    # client does, hangs about once in 500 times.
    async def station() -> None:
        async with connect_in_one_thread(
            f"wss://{tablet.host}/ws/participant",
            origin=Origin(f"https://{tablet.host}"),
            additional_headers={"Cookie": tablet.cookie},
            ssl=tablet.context,
        ) as line:

            async def says(**message: object) -> dict[str, Any]:
                await line.send(json.dumps({"id": 1, **message}))
                return dict(json.loads(await asyncio.wait_for(line.recv(), 30)))

            for kind in kinds:
                answer = await says(type=kind, study="small")
                assert answer["type"] == "error"
                # A participant's own page says it, too, and of a sitting only.
                said = "sitting: Field required" if kind == "surface in place" else "is not known"
                assert said in answer["message"]
            assert (await says(type="where", sitting=sitting))["state"] == "consent"

    asyncio.run(station())


@pytest.mark.slow
def test_the_certificate_is_the_one_that_was_printed(start_lab: Start, tmp_path: Path) -> None:
    lab = start_lab(tmp_path, None, "--lan", ADDRESS)
    tablet = Tablet(lab)
    pem = ssl.get_server_certificate((ADDRESS, tablet.port))
    digest = hashlib.sha256(ssl.PEM_cert_to_DER_cert(pem)).hexdigest().upper()
    said = re.search(r"fingerprint: ([0-9A-F:]+)", lab.said)
    assert said
    assert said[1].replace(":", "") == digest
    assert tablet.context.check_hostname
    assert tablet.ask("GET", "/pair")[0] == 200
    secret = next(tmp_path.glob(".lab-*.pem"))
    assert secret.stat().st_mode & 0o777 == 0o600
    # After a crash the tablet sees the same certificate, after a clean end another.
    lab.kill()
    again = start_lab(tmp_path, lab.port, "--lan", ADDRESS)
    assert said[0] in again.said
    assert Tablet(again).ask("GET", "/pair")[0] == 200
    assert again.stop() == 0
    assert not list(tmp_path.glob(".lab-*"))
    last = start_lab(tmp_path, lab.port, "--lan", ADDRESS)
    assert said[0] not in last.said


@pytest.mark.parametrize(
    ("address", "words"),
    [
        ("0.0.0.0", "not allowed"),
        ("8.8.8.8", "not allowed"),
        ("224.0.0.1", "not allowed"),
        ("example.org", "no IPv4 address"),
        ("::", "no IPv4 address"),
        ("10.255.254.253", "no address of this computer"),
    ],
)
def test_only_one_private_address_of_this_computer_is_taken(address: str, words: str) -> None:
    with pytest.raises(InputError, match=words):
        lan_listener(address)


def test_a_taken_port_is_passed_over() -> None:
    with lan_listener(ADDRESS) as one, lan_listener(ADDRESS) as other:
        assert one.getsockname()[1] != other.getsockname()[1]
        assert {one.getsockname()[0], other.getsockname()[0]} == {ADDRESS}


def test_a_certificate_that_does_not_fit_is_made_anew(tmp_path: Path) -> None:
    file = tmp_path / "key.pem"
    first = certificate(ADDRESS, file)
    assert certificate(ADDRESS, file) == first
    assert certificate("127.0.0.3", file) != first
    file.write_text("nothing")
    assert certificate(ADDRESS, file) not in ("", first)
    target = tmp_path / "elsewhere.pem"
    file.rename(target)
    file.symlink_to(target)
    kept = target.read_bytes()
    certificate(ADDRESS, file)
    assert target.read_bytes() == kept


@pytest.mark.slow
def test_a_missing_package_is_said(tmp_path: Path) -> None:
    program = (
        "import sys; sys.modules['cryptography'] = None; from squeezefilm.cli import main; main()"
    )
    done = subprocess.run(
        [sys.executable, "-c", program, "lab", "--no-browser", "--folder", str(tmp_path), "--lan",
         ADDRESS],
        capture_output=True, text=True, timeout=60,
    )  # fmt: skip
    assert done.returncode != 0
    assert "squeezefilm[lab]" in " ".join((done.stdout + done.stderr).split())
    assert "Traceback" not in done.stderr


@pytest.mark.nightly
@pytest.mark.chromium
def test_a_tablet_is_paired_answers_and_comes_back(
    chromium: Browser, start_lab: Start, tmp_path: Path
) -> None:
    path = small_study(tmp_path, familiarisation=0, practice=0, pause=0.0)
    lab = start_lab(tmp_path, None, "--lan", ADDRESS)
    page, _ = opened(chromium, lab, "study")
    chosen(page, "small")
    row = prepared(page)
    row.get_by_role("button", name="Code for a tablet").click()
    said = page.locator("#notice", has_text="on the tablet open").inner_text()
    found = re.search(r"open (\S+/pair) and type (\d{3} \d{3}) within 2 minutes", said)
    assert found
    keep(page, "lab-study-pairing-code")
    tablet = chromium.new_context(
        viewport={"width": 1024, "height": 768}, has_touch=True, ignore_https_errors=True
    ).new_page()
    tablet.goto(found[1])
    assert tablet.evaluate(CONTRAST) == []
    tablet.get_by_role("textbox").fill("12")
    tablet.keyboard.press("Enter")
    tablet.locator(".error", has_text="is not right").wait_for()
    keep(tablet, "lab-tablet-pairing")
    tablet.get_by_role("textbox").fill(found[2])
    tablet.get_by_role("button", name="Pair this tablet").tap()
    consented(tablet)
    run_to(tablet, 3, "touch")
    assert answered(path) == 3
    lab.kill()
    tablet.locator("#connection", has_text="The connection is lost").wait_for()
    start_lab(tmp_path, lab.port, "--lan", ADDRESS)
    tablet.locator("h2", has_text="Ready").wait_for(timeout=15_000)
    run_to(tablet, 99, "touch")
    assert tablet.locator("h2").inner_text() == "Thank you"
    assert answered(path) == 10
    keep(tablet, "lab-tablet-finished")
    page.locator(".count", has_text="10 of 10").wait_for()
