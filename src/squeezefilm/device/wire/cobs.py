"""Consistent overhead byte stuffing: bytes without a zero, so that a zero can end a frame.

Cheshire & Baker 1999, IEEE/ACM Trans. Networking 7, 159. The test vectors are the published ones.
"""

from __future__ import annotations

from squeezefilm.errors import InputError


def cobs_encode(data: bytes) -> bytes:
    """`data` without zero bytes, at most ⌈len/254⌉ bytes longer (one byte for no data)."""
    out = bytearray([0])
    code_at = 0
    for position, byte in enumerate(data):
        if byte:
            out.append(byte)
        run = len(out) - code_at
        full = run == 255
        if not byte or (full and position + 1 < len(data)):
            out[code_at] = run
            code_at = len(out)
            out.append(0)
    out[code_at] = len(out) - code_at
    return bytes(out)


def cobs_decode(data: bytes) -> bytes:
    """What was encoded.

    Raises:
        InputError: a zero inside, or a code that points past the end.
    """
    out = bytearray()
    at = 0
    while at < len(data):
        code = data[at]
        end = at + code
        if code == 0 or end > len(data) or 0 in data[at + 1 : end]:
            raise InputError(f"{len(data)} bytes are no COBS block: bad code at byte {at}")
        out += data[at + 1 : end]
        if code < 255 and end < len(data):
            out.append(0)
        at = end
    return bytes(out)
