"""The firmware built for a Cortex-M, in an emulator that counts what it executes.

unicorn is exact in what instructions do; it has no clock, so what is counted is instructions and
not cycles (on an M0+ one takes 1 to 2).
"""

from __future__ import annotations

import ctypes
import struct
import subprocess
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from .builds import FIRMWARE, LOOPS, STRICT, build, missing, tool
from .recording import Recording

HERE = Path(__file__).parent
FLASH, RAM, ROOM, RETURN = 0x10000, 0x20000000, 0x40000000, 0x0FFF0000
_STACK = 0x10000
_PAINT = b"\xa5"


class _Counter(ctypes.Structure):
    """As `instruction_counter.c` has it."""

    _fields_ = (
        ("caller", ctypes.c_uint64),
        ("caller_end", ctypes.c_uint64),
        ("entry", ctypes.c_uint64 * 2),
        ("longest", ctypes.c_uint64 * 2),
        ("calls", ctypes.c_uint64 * 2),
        ("total", ctypes.c_uint64),
        ("count", ctypes.c_uint64),
        ("inside", ctypes.c_uint64),
    )


@dataclass
class Work:
    """The most that one call took: instructions of `sf_receive` and `sf_tick`, or of a step of the
    loops, and bytes of stack."""

    receive: int = 0
    tick: int = 0
    step: int = 0
    stack: int = 0


class Arm:
    """One core with the firmware in its flash. `work` is the most that was seen up to now.

    `entry` is the harness's function that makes the calls: `host_run` of scripts, or `host_loops`.
    """

    def __init__(
        self, core: str, folder: Path, counter: ctypes.CDLL, entry: str = "host_run"
    ) -> None:
        self.core, self.entry = core, entry
        sources = FIRMWARE if entry == "host_run" else LOOPS
        image = _linked(core, sources, entry, folder / f"{core}-{entry}.elf")
        self.symbols = symbols(image)
        flash = folder / f"{core}-{entry}.bin"
        _run("arm-none-eabi-objcopy", "-O", "binary", "-j", ".flash", image, flash)
        self._flash = flash.read_bytes()
        self._counter = counter
        self.work = Work()

    def record(self, recording: Recording) -> bytes:
        """What it did. Whatever is no instruction or no memory of this core raises."""
        most = len(recording.record) + 4096
        done, counter = self._run(bytes(recording.script), most, ("sf_receive", "sf_tick"))
        self.work.receive = max(self.work.receive, counter.longest[0])
        self.work.tick = max(self.work.tick, counter.longest[1])
        assert list(counter.calls) == [recording.received, recording.ticks]
        return done

    def loop_steps(self, given: bytes, count: int) -> bytes:
        """State and command after each of `count` steps of the loops; see `loops_main.c`."""
        done, counter = self._run(given, count * 120 + 4096, ("sf_loop_step", "sf_loop_begin"))
        self.work.step = max(self.work.step, counter.longest[0])
        assert counter.calls[0] == count
        return done

    def _run(self, script: bytes, most: int, counted: tuple[str, str]) -> tuple[bytes, _Counter]:
        core, out, top = self.powered(len(script), most)
        counter = self._count(core, counted)
        done = self.called(core, script, out, most, top)
        stack = len(bytes(core.mem_read(top - _STACK, _STACK)).lstrip(_PAINT))
        self.work.stack = max(self.work.stack, stack)
        return done, counter

    def powered(self, room: int, most: int) -> tuple[Any, int, int]:
        """A core with the firmware, `room` bytes for scripts and `most` for records; where those
        are, and the top of the stack."""
        unicorn = _unicorn()
        arm = unicorn.arm_const
        core = unicorn.Uc(unicorn.UC_ARCH_ARM, unicorn.UC_MODE_THUMB | unicorn.UC_MODE_MCLASS)
        core.ctl_set_cpu_model(
            {
                "cortex-m0plus": arm.UC_CPU_ARM_CORTEX_M0,  # the same instructions
                "cortex-m3": arm.UC_CPU_ARM_CORTEX_M3,
                "cortex-m4": arm.UC_CPU_ARM_CORTEX_M4,
            }[self.core]
        )
        core.mem_map(FLASH, _pages(len(self._flash)), unicorn.UC_PROT_READ | unicorn.UC_PROT_EXEC)
        core.mem_write(FLASH, self._flash)
        end = max(address + size for address, size in self.symbols.values())
        top = RAM + _pages(end - RAM) + _STACK
        data = unicorn.UC_PROT_READ | unicorn.UC_PROT_WRITE
        core.mem_map(RAM, top - RAM, data)
        core.mem_write(top - _STACK, _PAINT * _STACK)
        out = ROOM + _pages(room)
        core.mem_map(ROOM, out - ROOM, unicorn.UC_PROT_READ)
        core.mem_map(out, _pages(most), data)
        return core, out, top

    def called(self, core: Any, script: bytes, out: int, most: int, top: int) -> bytes:
        """What the harness writes of a script, on a core that remembers what came before."""
        arm = _unicorn().arm_const
        core.mem_write(ROOM, script)
        for register, value in (
            (arm.UC_ARM_REG_R0, ROOM),
            (arm.UC_ARM_REG_R1, len(script)),
            (arm.UC_ARM_REG_R2, out),
            (arm.UC_ARM_REG_R3, most),
            (arm.UC_ARM_REG_SP, top),
            (arm.UC_ARM_REG_LR, RETURN | 1),
        ):
            core.reg_write(register, value)
        core.emu_start(self.symbols[self.entry][0] | 1, RETURN)
        return bytes(core.mem_read(out, min(most, core.reg_read(arm.UC_ARM_REG_R0))))

    def _count(self, core: Any, counted: tuple[str, str]) -> _Counter:
        unicorn = _unicorn()
        caller, size = self.symbols[self.entry]
        counter = _Counter(caller, caller + size)
        for i, name in enumerate(counted):
            counter.entry[i] = self.symbols[name][0]
        # As Uc.hook_add does it, which takes functions of Python only: they would be too slow.
        failed = unicorn.unicorn_py3.unicorn.uclib.uc_hook_add(
            core._uch,
            ctypes.byref(ctypes.c_size_t()),
            unicorn.UC_HOOK_CODE,
            ctypes.cast(self._counter.count_instruction, ctypes.c_void_p),
            ctypes.addressof(counter),
            ctypes.c_uint64(1),
            ctypes.c_uint64(0),
        )
        assert failed == 0
        return counter


class ArmMachine:
    """The firmware on an emulated core, as the wire sees a `Machine`: with a finger that stays."""

    def __init__(self, arm: Arm, own: tuple[int, ...], tick_period: int) -> None:
        self._arm, self._most = arm, 1 << 16
        self._core, self._out, self._top = arm.powered(4096, self._most)
        self._unread = bytearray()
        self._called(b"B" + struct.pack("<11I", *own, 51, 1, tick_period))
        self._called(b"F" + struct.pack("<iiIIiii", 1000, 0, 1, 5, 0, 0, 0))

    def receive(self, data: bytes, now: int) -> bytes:
        """The answers to bytes that arrived at `now` (µs)."""
        for first in range(0, len(data), 2048):
            part = data[first : first + 2048]
            self._unread += self._called(b"R" + struct.pack("<II", now, len(part)) + part)[4:]
        return self.outgoing()

    def tick(self, now: int) -> int:
        """Advance to `now` (µs); returns the output (µV)."""
        done = self._called(b"T" + struct.pack("<I", now & 0xFFFFFFFF))
        self._unread += done[4:-4]
        return int.from_bytes(done[-4:], "little")

    def outgoing(self) -> bytes:
        """The bytes for the host since the last call."""
        out = bytes(self._unread)
        self._unread.clear()
        return out

    def _called(self, script: bytes) -> bytes:
        return self._arm.called(self._core, script, self._out, self._most, self._top)


def _pages(size: int) -> int:
    return -(-size // 4096) * 4096


def _run(program: str, *arguments: str | Path) -> str:
    command = [tool(program), *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


def _linked(core: str, sources: tuple[Path, ...], entry: str, built: Path) -> Path:
    flags = (
        *STRICT,
        "-O2",
        "-mthumb",
        f"-mcpu={core}",
        "-ffunction-sections",
        "-fdata-sections",
        "--specs=nano.specs",
        "-nostartfiles",
        f"-Wl,--gc-sections,-T,{HERE / 'arm.ld'},-e,{entry}"
        + "".join(f",-u,{name}" for name in ("sf_boot", "sf_tick", "sf_trip") if sources != LOOPS),
    )
    return build(tool("arm-none-eabi-gcc"), flags, sources, built)


def firmware_alone(core: str, folder: Path) -> tuple[dict[str, tuple[int, int]], int]:
    """The names in the firmware without a harness, what it needs of the compiler's libraries
    among them, and the bytes of flash that all takes."""
    image = _linked(core, FIRMWARE[:1], "sf_receive", folder / f"{core}-alone.elf")
    return symbols(image), int(_run("arm-none-eabi-size", image).splitlines()[1].split()[0])


def symbols(image: Path) -> dict[str, tuple[int, int]]:
    """The address and the size (0 where none is stated) of every name."""
    named = {}
    for line in _run("arm-none-eabi-nm", "-S", image).splitlines():
        address, *size, _, name = line.split()
        named[name] = (int(address, 16), int(size[0], 16) if size else 0)
    return named


def _unicorn() -> Any:
    try:
        import unicorn
        import unicorn.arm_const
    except ImportError:
        missing("unicorn is not installed, which runs Arm code; install squeezefilm[firmware-test]")
    return unicorn


def instruction_counter(folder: Path) -> ctypes.CDLL:
    """The emulator's hook for every instruction, built for this computer."""
    flags = (*STRICT, "-O2", "-shared", "-fPIC")
    source = (HERE / "instruction_counter.c",)
    return ctypes.CDLL(str(build(tool("cc", "gcc", "clang"), flags, source, folder / "counter.so")))
