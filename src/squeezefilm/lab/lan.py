"""Tablets as participant stations: a second listener, by TLS, that knows no experimenter.

It is there only where the experimenter asked for it with an address. Its application has the
participant's page and the page for a pairing code, nothing else; its guard accepts no session but
a participant's. A tablet cannot know the certificate beforehand: the terminal prints the
fingerprint that the tablet's browser shows.
"""

from __future__ import annotations

import datetime
import ipaddress
import ssl
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import JSONResponse, PlainTextResponse, Response
from starlette.routing import Route

from squeezefilm.core.errors import InputError, optional
from squeezefilm.core.hard_limits import OWN_BYTES
from squeezefilm.core.regular_file import read_regular
from squeezefilm.lab.door import MOST_OF_ADDRESS, MOST_OPEN, Door
from squeezefilm.lab.files import write_secret
from squeezefilm.lab.guard import Guard, Places
from squeezefilm.lab.server import (
    Lab,
    LanPlace,
    UnheardServer,
    listening_socket,
    page_file,
    server_of,
    station_routes,
)

if TYPE_CHECKING:
    import socket

PORT = 8632
_LIFE = datetime.timedelta(days=30)
_LONGEST_CODE = 32


def lan_listener(address: str, port: int = PORT) -> socket.socket:
    """A socket bound to one address of this computer in its local network.

    Raises:
        InputError: no IPv4 address, one for every network, one of the open internet, one that is
            not this computer's, or no free port.
    """
    try:
        parsed = ipaddress.IPv4Address(address)
    except ValueError:
        raise InputError(
            f"lan {address[:60]} is no IPv4 address; give this computer's in the local network, "
            "like 192.168.1.20"
        ) from None
    if parsed.is_unspecified or parsed.is_multicast or not parsed.is_private:
        raise InputError(
            f"lan {parsed} is not allowed: only one address of this computer in a private network "
            "(10.x, 172.16–31.x, 192.168.x, 169.254.x) is"
        )
    try:
        return listening_socket(port, str(parsed))
    except OSError as error:
        raise InputError(
            f"lan {parsed} is no address of this computer; look it up in its network settings"
        ) from error


def certificate(address: str, file: Path) -> str:
    """Make a self-signed certificate and its key in one file; the SHA-256 fingerprint.

    A file that a killed lab left is used again while it is good for this address, so that a
    tablet that trusted it comes back by itself. Only its owner can read it.

    Raises:
        InputError: the package `cryptography` is not there, or the file cannot be written.
    """
    with optional("lab", "a certificate for tablets (lan)"):
        from cryptography import x509
        from cryptography.hazmat.primitives import hashes, serialization
        from cryptography.hazmat.primitives.asymmetric import ec
        from cryptography.x509.oid import ExtendedKeyUsageOID, NameOID
    now = datetime.datetime.now(datetime.UTC)
    kept = _fingerprint_of(file, address, now + datetime.timedelta(days=1))
    if kept is not None:
        return kept
    key = ec.generate_private_key(ec.SECP256R1())
    name = x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, "squeezefilm lab")])
    made = (
        x509.CertificateBuilder()
        .subject_name(name)
        .issuer_name(name)
        .public_key(key.public_key())
        .serial_number(x509.random_serial_number())
        .not_valid_before(now - datetime.timedelta(days=1))
        .not_valid_after(now + _LIFE)
        .add_extension(
            x509.SubjectAlternativeName([x509.IPAddress(ipaddress.ip_address(address))]), False
        )
        .add_extension(x509.BasicConstraints(ca=False, path_length=None), True)
        .add_extension(x509.ExtendedKeyUsage([ExtendedKeyUsageOID.SERVER_AUTH]), False)
        .sign(key, hashes.SHA256())
    )
    secret = key.private_bytes(
        serialization.Encoding.PEM,
        serialization.PrivateFormat.PKCS8,
        serialization.NoEncryption(),
    )
    try:
        write_secret(file, secret + made.public_bytes(serialization.Encoding.PEM))
    except OSError as error:
        raise InputError(
            f"{file} cannot be written: {error.strerror}; move away what lies there, or free space"
        ) from error
    return made.fingerprint(hashes.SHA256()).hex(":").upper()


def lan_application(lab: Lab, places: Places) -> Guard:
    """The ASGI application for tablets: pairing, the participant's page, its messages."""

    async def pairing(_: Request) -> Response:
        return page_file("pair.html")

    async def pair(request: Request) -> Response:
        code = b""
        async for part in request.stream():
            code += part
            if len(code) > _LONGEST_CODE:
                return PlainTextResponse("A pairing code has six digits.", 413)
        entered = lab.keys.use_code("".join(code.decode("utf-8", "replace").split()))
        if entered is None:
            guard.refusals["code"] += 1
            return PlainTextResponse(
                "This code is not right, was used already, or is older than two minutes. Ask the "
                "experimenter for a new one.",
                401,
            )
        session, home = entered
        answer = JSONResponse({"home": home})
        guard.set_cookie(answer, session)
        return answer

    guard = Guard(
        Starlette(
            routes=[
                Route("/pair", pairing),
                Route("/pair", pair, methods=["POST"]),
                *station_routes(lab),
            ]
        ),
        lab.keys,
        places,
    )
    return guard


def lan_server(
    lab: Lab, listener: socket.socket, file: Path, most: int = MOST_OPEN
) -> UnheardServer:
    """The server for tablets, `most` connections at once; it says in `lab.lan` where it is.

    Raises as `certificate`.
    """
    address, port = listener.getsockname()
    fingerprint = certificate(address, file)
    host = f"{address}:{port}"
    places = Places(
        frozenset({host}), secure=True, participants_only=True, cookie=f"squeezefilm-lan-{port}"
    )
    lab.lan = LanPlace(f"https://{host}/pair", fingerprint)
    return server_of(
        lab,
        lan_application(lab, places),
        door=partial(Door, most=most, most_of_address=MOST_OF_ADDRESS),
        ssl_certfile=str(file),
        ssl_keyfile=str(file),
        lifespan="off",
    )


def _fingerprint_of(file: Path, address: str, until: datetime.datetime) -> str | None:
    from cryptography import x509
    from cryptography.hazmat.primitives import hashes

    if file.is_symlink() or not file.is_file():
        return None
    try:
        content = read_regular(file, OWN_BYTES, "a certificate")
        certificate = x509.load_pem_x509_certificate(content)
        names = certificate.extensions.get_extension_for_class(x509.SubjectAlternativeName).value
        # That key and certificate belong together is checked by loading them as TLS does.
        ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER).load_cert_chain(file)
    except (ValueError, OSError, x509.ExtensionNotFound):
        return None
    fits = ipaddress.ip_address(address) in names.get_values_for_type(x509.IPAddress)
    if not fits or certificate.not_valid_after_utc < until:
        return None
    return certificate.fingerprint(hashes.SHA256()).hex(":").upper()
