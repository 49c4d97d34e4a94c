"""Bytes to a device and back, by a serial port.

A device on USB shows up as a serial port; a twin's pseudo-terminal is one too. Nothing here waits:
what a port does not take at once is kept and sent with the next call.
"""

from __future__ import annotations

import contextlib
import os
import select

from squeezefilm.core.errors import DeviceError, InputError, optional

BAUD_RATE = 921_600
"""Bits per second where a port has a real line; USB and pseudo-terminals do not look at it."""
_MOST_UNSENT = 1 << 16
_MOST_READ = 1 << 16


class SerialStream:
    """A serial port, taken for this program alone. Not thread-safe.

    Args:
        port: its name, such as "/dev/ttyACM0", "COM3", or a pseudo-terminal's.
        baudrate: bits per second.

    Raises:
        DeviceError: a port that is not there, is taken, or may not be opened.
    """

    def __init__(self, port: str, baudrate: int = BAUD_RATE) -> None:
        with optional("device", "a serial port"):
            import serial
        self.port = port
        self._unsent = bytearray()
        # pyserial's own error is an OSError.
        try:
            self._serial = serial.Serial(port, baudrate, timeout=0, write_timeout=0, exclusive=True)
        except (OSError, ValueError) as error:
            raise DeviceError(
                f"serial port {port} at {baudrate} baud cannot be opened: {error}; look whether "
                "the device is plugged in, whether another program has it, and whether you may "
                "use it (on Linux, the group dialout)"
            ) from error

    def read(self) -> bytes:
        """Whatever has arrived. Raises `DeviceError` if the device was unplugged."""
        self._flush()
        try:
            waiting = self._serial.in_waiting
            return bytes(self._serial.read(min(waiting, _MOST_READ))) if waiting else b""
        except (OSError, TypeError) as error:
            raise self._gone("read from", error) from error

    def write(self, data: bytes) -> None:
        """Send bytes; what the port does not take now goes with the next call.

        Raises:
            DeviceError: the device was unplugged, or has taken nothing for 64 KiB.
        """
        self._unsent += data
        self._flush()
        if len(self._unsent) > _MOST_UNSENT:
            waiting = len(self._unsent)
            self._unsent.clear()
            raise DeviceError(
                f"serial port {self.port} takes no more: {waiting} bytes wait and at most "
                f"{_MOST_UNSENT} may; the device hangs or the line is too slow for what is sent"
            )

    def close(self) -> None:
        """Let go of the port; more than once is allowed."""
        # An unplugged port may fail to close as well; there is nothing left to let go of.
        with contextlib.suppress(OSError):
            self._serial.close()

    def _flush(self) -> None:
        if not self._unsent:
            return
        try:
            # Asked before, since pyserial's write goes round for ever on a full POSIX port.
            if os.name == "posix" and not select.select([], [self._serial.fileno()], [], 0.0)[1]:
                return
            taken = self._serial.write(bytes(self._unsent))
        except (OSError, TypeError) as error:
            raise self._gone("write to", error) from error
        del self._unsent[: taken or 0]

    def _gone(self, what: str, error: Exception) -> DeviceError:
        return DeviceError(
            f"could not {what} serial port {self.port}: {error}; the device was unplugged or "
            "switched off. Its watchdog takes the output to zero by itself; plug it in and start "
            "again"
        )


def open_stream(where: str) -> SerialStream:
    """The stream named by text: "serial:PORT" or "serial:PORT@BAUD".

    Raises:
        InputError: a text of another form.
        DeviceError: a port that cannot be opened.
    """
    kind, _, rest = where.partition(":")
    port, at, baud = rest.rpartition("@")
    if not at:
        port, baud = rest, str(BAUD_RATE)
    if kind != "serial" or not port or not (baud.isascii() and baud.isdigit() and int(baud) > 0):
        raise InputError(
            f"'{where}' names no stream; write serial:PORT or serial:PORT@BAUD, e.g. "
            "serial:/dev/ttyACM0 or serial:COM3@921600",
            quantity="drive",
        )
    return SerialStream(port, int(baud))
