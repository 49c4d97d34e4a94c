"""A serial port whose other end takes nothing."""

from __future__ import annotations

import contextlib
import os
import re
import sys

import pytest

from squeezefilm.core.errors import DeviceError
from squeezefilm.instruments.device.wire.streams import SerialStream

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="needs pseudo-terminals")


def test_64_kib_may_wait_and_no_more() -> None:
    master, slave = os.openpty()
    chunk = bytes(1000)
    with contextlib.closing(SerialStream(os.ttyname(slave))) as stream:

        def fill() -> None:
            for _ in range(1000):
                stream.write(chunk)

        with pytest.raises(DeviceError, match="takes no more") as caught:
            fill()
        found = re.search(r"(\d+) bytes wait and at most (\d+) may", str(caught.value))
        assert found is not None
        assert found[2] == "65536"
        assert 65_536 < int(found[1]) <= 65_536 + len(chunk)
        # What was refused is forgotten: the next bytes are as good as the first.
        stream.write(chunk)
    os.close(slave)
    os.close(master)


def test_a_port_is_taken_alone_and_never_waited_for(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[tuple[object, ...]] = []

    def opened(port: str, baudrate: int, **how: object) -> None:
        asked.append((port, baudrate, how))

    monkeypatch.setattr("serial.Serial", opened)
    SerialStream("/dev/none", 9600)
    how = {"timeout": 0, "write_timeout": 0, "exclusive": True}
    assert asked == [("/dev/none", 9600, how)]
