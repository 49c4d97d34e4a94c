"""What tablets may ask of their own listener: a pairing code, the participant's page, no more."""

from __future__ import annotations

import datetime
import hashlib
import ipaddress
import re
import ssl
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from starlette.testclient import TestClient

from squeezefilm.core.errors import InputError
from squeezefilm.lab import lan
from squeezefilm.lab.door import MOST_OF_ADDRESS, MOST_OPEN
from squeezefilm.lab.guard import Keys, Places
from squeezefilm.lab.lan import certificate, lan_application, lan_listener, lan_server
from squeezefilm.lab.server import STATIC, Lab

HOST = "192.168.1.20:8632"
ORIGIN = f"https://{HOST}"
COOKIE = "squeezefilm-lan-8632"
OWN = {"origin": ORIGIN}

Tablet = Callable[[], TestClient]


@pytest.fixture
def lab(tmp_path: Path) -> Lab:
    return Lab(tmp_path, Keys(), Places(frozenset({"127.0.0.1:8631"})))


@pytest.fixture
def guard(lab: Lab) -> Any:
    places = Places(frozenset({HOST}), secure=True, participants_only=True, cookie=COOKIE)
    return lan_application(lab, places)


@pytest.fixture
def tablet(guard: Any) -> TestClient:
    return TestClient(guard, base_url=ORIGIN, follow_redirects=False)


def test_a_code_pairs_a_tablet_with_its_page(lab: Lab, guard: Any, tablet: TestClient) -> None:
    assert tablet.get("/participant").status_code == 401
    code = lab.keys.new_code("/participant#sitting-3")
    # As the experimenter's page shows it, in two groups.
    answer = tablet.post("/pair", headers=OWN, content=f" {code[:3]} {code[3:]}\n")
    assert (answer.status_code, answer.json()) == (200, {"home": "/participant#sitting-3"})
    cookie = answer.headers["set-cookie"].lower()
    assert cookie.startswith(f"{COOKIE}=")
    for word in ("httponly", "secure", "samesite=strict", "path=/"):
        assert word in cookie
    assert tablet.get("/participant").content == (STATIC / "participant.html").read_bytes()
    assert tablet.get("/static/lab.js").status_code == 200
    assert guard.refusals == {"session": 1}


def test_a_wrong_code_is_refused_in_words_and_counted(lab: Lab, guard: Any, tablet: Any) -> None:
    code = lab.keys.new_code()
    wrong = tablet.post("/pair", headers=OWN, content=f"{(int(code) + 1) % 10**6:06d}")
    assert wrong.status_code == 401
    assert "Ask the experimenter for a new one" in wrong.text
    assert "set-cookie" not in wrong.headers
    assert tablet.post("/pair", headers=OWN, content=b"\xff\xfe").status_code == 401
    assert guard.refusals == {"code": 2}
    assert tablet.post("/pair", headers=OWN, content=code).status_code == 200


def test_more_than_a_code_is_not_read(guard: Any, tablet: TestClient) -> None:
    # 32 bytes leave room for spaces; they are a wrong code, one more is none.
    assert tablet.post("/pair", headers=OWN, content=b"1" * 32).status_code == 401
    long = tablet.post("/pair", headers=OWN, content=b"1" * 33)
    assert (long.status_code, long.text) == (413, "A pairing code has six digits.")
    assert guard.refusals == {"code": 1}


def test_a_stranger_gets_what_pairing_needs_and_nothing_else(tablet: TestClient) -> None:
    assert tablet.get("/pair").content == (STATIC / "pair.html").read_bytes()
    for path in ("/static/pair.js", "/static/lab.css", "/static/icon.svg"):
        assert tablet.get(path).status_code == 200, path
    for path in ("/participant", "/static/lab.js", "/static/pair.js/", "/pair/"):
        answer = tablet.get(path)
        assert answer.status_code == 401, path
        assert "six digits" in answer.text
    entering = tablet.get("/?token=x")
    assert (entering.status_code, entering.headers["location"]) == (303, "/pair")


def test_an_experimenters_session_opens_nothing(lab: Lab, guard: Any, tablet: Any) -> None:
    session, _ = lab.keys.use_link(lab.keys.new_link()) or (None, None)
    assert session is not None
    tablet.cookies.set(COOKIE, session.secret)
    assert tablet.get("/participant").status_code == 401
    assert guard.refusals == {"role": 1, "session": 1}


class Listener:
    def getsockname(self) -> tuple[str, int]:
        return "192.168.1.20", 8632


def test_the_server_says_where_it_is_and_by_what_it_is_known(
    lab: Lab, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made: list[tuple[str, Path]] = []

    def noted(address: str, file: Path) -> str:
        made.append((address, file))
        return "AB:CD"

    monkeypatch.setattr(lan, "certificate", noted)
    file = tmp_path / "key.pem"
    served: list[tuple[Any, dict[str, Any]]] = []
    monkeypatch.setattr(lan, "server_of", lambda *given, **how: served.append((given, how)))
    lan_server(lab, Listener(), file)  # type: ignore[arg-type]
    lan_server(lab, Listener(), file, most=3)  # type: ignore[arg-type]
    assert made == [("192.168.1.20", file)] * 2
    assert lab.lan is not None
    assert (lab.lan.link, lab.lan.fingerprint) == (f"{ORIGIN}/pair", "AB:CD")
    (of_lab, guard), how = served[0]
    assert of_lab is lab
    assert guard.places == Places(
        frozenset({HOST}), secure=True, participants_only=True, cookie=COOKIE
    )
    assert how.pop("door").keywords == {"most": MOST_OPEN, "most_of_address": MOST_OF_ADDRESS}
    assert how == {"ssl_certfile": str(file), "ssl_keyfile": str(file), "lifespan": "off"}
    assert served[1][1]["door"].keywords["most"] == 3


def test_a_certificate_names_its_address_and_is_good_for_a_month(tmp_path: Path) -> None:
    x509 = pytest.importorskip("cryptography.x509")
    file = tmp_path / "key.pem"
    (tmp_path / "key.new").write_text("left by a lab that was killed")
    said = certificate("192.168.1.20", file)
    assert file.stat().st_mode & 0o777 == 0o600
    assert not (tmp_path / "key.new").exists()
    found = x509.load_pem_x509_certificate(file.read_bytes())
    der = ssl.PEM_cert_to_DER_cert(
        "-----BEGIN CERTIFICATE-----" + file.read_text().split("-----BEGIN CERTIFICATE-----")[1]
    )
    digest = hashlib.sha256(der).digest()
    assert said == ":".join(f"{one:02X}" for one in digest)
    assert found.not_valid_after_utc - found.not_valid_before_utc == datetime.timedelta(days=31)
    now = datetime.datetime.now(datetime.UTC)
    # A tablet whose clock is some hours behind takes it too.
    assert found.not_valid_before_utc < now - datetime.timedelta(hours=23)
    assert found.subject == found.issuer
    extensions = {one.oid: one for one in found.extensions}
    names = found.extensions.get_extension_for_class(x509.SubjectAlternativeName).value
    assert names.get_values_for_type(x509.IPAddress) == [ipaddress.ip_address("192.168.1.20")]
    constraints = found.extensions.get_extension_for_class(x509.BasicConstraints)
    assert constraints.critical
    assert constraints.value.ca is False
    usage = found.extensions.get_extension_for_class(x509.ExtendedKeyUsage).value
    assert list(usage) == [x509.oid.ExtendedKeyUsageOID.SERVER_AUTH]
    assert [one.critical for one in extensions.values()].count(True) == 1


def test_a_certificate_that_ends_within_a_day_is_made_anew(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("cryptography")
    file = tmp_path / "key.pem"
    with monkeypatch.context() as short:
        short.setattr(lan, "_LIFE", datetime.timedelta(hours=23))
        first = certificate("192.168.1.20", file)
        again = certificate("192.168.1.20", file)
        assert again != first
    with monkeypatch.context() as longer:
        longer.setattr(lan, "_LIFE", datetime.timedelta(hours=25))
        third = certificate("192.168.1.20", file)
        assert third != again
        assert certificate("192.168.1.20", file) == third


def test_without_its_package_a_certificate_is_refused_in_words(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "cryptography", None)
    with pytest.raises(InputError, match=r"squeezefilm\[lab\]"):
        certificate("192.168.1.20", tmp_path / "key.pem")
    assert list(tmp_path.iterdir()) == []


def test_the_listener_is_asked_for_the_port_and_address(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[Any] = []
    monkeypatch.setattr(lan, "listening_socket", lambda *given: asked.append(given))
    lan_listener("192.168.1.20")
    lan_listener("169.254.7.7", 9000)
    assert asked == [(8632, "192.168.1.20"), (9000, "169.254.7.7")]
    with pytest.raises(InputError, match=f"lan {'x' * 60} is no IPv4"):
        lan_listener("x" * 61)


@pytest.mark.parametrize(
    ("address", "said"),
    [
        ("0.0.0.0", "lan 0.0.0.0 is not allowed"),
        ("224.0.0.1", "lan 224.0.0.1 is not allowed"),
        ("8.8.8.8", "lan 8.8.8.8 is not allowed"),
        ("192.168.1.20", "lan 192.168.1.20 is no address of this computer"),
    ],
)
def test_addresses_of_others_are_not_listened_on(
    address: str, said: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def taken(*_: object) -> None:
        raise OSError("cannot assign")

    monkeypatch.setattr(lan, "listening_socket", taken)
    with pytest.raises(InputError, match=re.escape(said)):
        lan_listener(address)
