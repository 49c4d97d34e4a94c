"""What the physics refuses because it cannot be, in a word of each message."""

from __future__ import annotations

import dataclasses
import struct
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.errors import GeometryError, InputError, OutOfRangeError
from squeezefilm.core.materials import ElasticMaterial
from squeezefilm.physics.display import load_display
from squeezefilm.physics.film.closed import mean_pressure_profile
from squeezefilm.physics.film.gap import PaperGap
from squeezefilm.physics.film.periodic.batch import solve_films
from squeezefilm.physics.film.periodic.profile import GapProfile
from squeezefilm.physics.perception.observer import load_observer
from squeezefilm.physics.perception.percepts import along_way
from squeezefilm.physics.plate.beam_modes import wave_numbers
from squeezefilm.physics.plate.beam_response import beam_response
from squeezefilm.physics.plate.elements.box_model import isotropic_solid
from squeezefilm.physics.plate.elements.lobatto import LineMesh, lobatto_nodes
from squeezefilm.physics.plate.elements.nodal_lines import line_distance
from squeezefilm.physics.plate.layout import DiscPlate, RectangularPlate
from squeezefilm.physics.plate.ring.modes import (
    annular_admittance,
    annular_modes,
    bending_frequency,
)
from squeezefilm.physics.plate.ring.section import (
    AnnularSection,
    RingLayer,
    full_drive,
)
from squeezefilm.physics.plate.solid.forecast import estimated_frequency
from squeezefilm.physics.render.texture.pattern import Greatest, Least, Times
from squeezefilm.physics.render.texture.shapes import Attack
from squeezefilm.physics.texture_files.image_file import ImageFile, picture_from
from squeezefilm.physics.uncertainty.intervals import require_samples

GAP = PaperGap(1e-6, np.array([1e-6, 2e-6]), 0.0, 0.4e-3, 14.4e-3, 9e-3)
STEEL = isotropic_solid(ElasticMaterial("steel", 200e9, 0.3, 7800.0))
RING = AnnularSection((RingLayer(20e-3, 30e-3, 0.0, 5e-3, STEEL),))
WAVE = Attack(1e-3, 1e-3)


def disc() -> DiscPlate:
    actuator = load_display("winfield2007-tpad").actuator
    assert isinstance(actuator, DiscPlate)
    return actuator


def plate() -> RectangularPlate:
    actuator = load_display("biet2008-plate").actuator
    assert isinstance(actuator, RectangularPlate)
    return actuator


def harmonics(shape: tuple[int, ...], value: float = 1.0) -> Any:
    return lambda x: np.full((*shape, len(x)), value)


@pytest.mark.parametrize(
    ("build", "word"),
    [
        (lambda: mean_pressure_profile(np.zeros((2, 2)), GAP), "one-dimensional"),
        (lambda: solve_films(np.ones(2), np.full(3, 0.1)), "broadcast"),
        *((lambda n=n: require_samples(n), "power of two from 8") for n in (4, 12, 100, 131_072)),
        (lambda: GapProfile(harmonics(()), "one row"), "one row .* shape"),
        (lambda: GapProfile(harmonics((1, 1)), "a block"), "a block .* shape"),
        (lambda: GapProfile(harmonics((1,), np.inf), "an endless gap"), "not finite"),
        (lambda: dataclasses.replace(load_observer(), channels=()), "channels is empty"),
        (
            lambda: along_way(np.linspace(0.0, 1.0, 10), np.ones(10), load_observer(), (1, 1)),
            "move more slowly",
        ),
        (lambda: wave_numbers(2.0, 1.0, 1.0, 1.0, 1.0), "cut-off"),
        (lambda: beam_response(disc()), "a disc is no beam"),
        (lambda: lobatto_nodes(0), "order = 0"),
        (lambda: lobatto_nodes(17), "order 1 to 16"),
        (lambda: LineMesh((0.0, 1.0), (2, 2)), "one edge more"),
        (lambda: LineMesh((0.0, 1.0, 1.0), (2, 2)), "must ascend"),
        (lambda: line_distance(np.array([1e-3])), "given are 1"),
        (lambda: line_distance(np.ones((2, 2))), "two nodal lines or more"),
        (lambda: estimated_frequency(plate(), (0, 0)), "no elastic mode"),
        (lambda: Least(()), "0 patterns"),
        (lambda: Greatest((WAVE,) * 1000), "1000 patterns"),
        (lambda: Times(()), "cannot be joined"),
        (lambda: annular_admittance(RING, full_drive(), np.ones(1), harmonics=()), "harmonics is"),
        (lambda: annular_modes(RING, 2, count=10_000, quality_factor=9.0), "ask for fewer"),
        (lambda: bending_frequency(RING, 1, degree=3), r"no mode B\(0,1\)"),
        (
            lambda: annular_modes(RING, 0, count=1, degree=3)[0].amplitude_per_volt(full_drive()),
            "rigid-body motion",
        ),
    ],
)
def test_what_cannot_be_is_refused(build: Callable[[], object], word: str) -> None:
    with pytest.raises((InputError, GeometryError, OutOfRangeError), match=word):
        build()


def png(pixels: np.ndarray, columns: int, rows: int, kind: int) -> bytes:
    """A PNG whose header says what is given, whatever its pixels (rows, bytes) are."""

    def chunk(name: bytes, data: bytes) -> bytes:
        checked = name + data
        return struct.pack(">I", len(data)) + checked + struct.pack(">I", zlib.crc32(checked))

    header = struct.pack(">IIBBBBB", columns, rows, 8, kind, 0, 0, 0)
    lines = b"".join(b"\0" + bytes(row) for row in pixels.astype(np.uint8))
    parts = chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(lines)) + chunk(b"IEND", b"")
    return b"\x89PNG\r\n\x1a\n" + parts


def test_pictures_that_cannot_be_read_are_refused() -> None:
    with pytest.raises(InputError, match="transparent"):
        picture_from(png(np.array([[9, 9, 9, 255, 9, 9, 9, 254]]), 2, 1, 6))
    with pytest.raises(InputError, match="damaged and cannot be read"):
        picture_from(png(np.array([[0, 255]]), 2, 1, 0)[:45])
    for columns, rows in ((0, 1), (1, 0), (1025, 1024)):
        with pytest.raises(InputError, match="1048576"):
            picture_from(png(np.zeros((1, 1)), columns, rows, 0))


def test_a_circle_of_links_is_no_picture(tmp_path: Path) -> None:
    (tmp_path / "a.png").symlink_to(tmp_path / "b.png")
    (tmp_path / "b.png").symlink_to(tmp_path / "a.png")
    with pytest.raises(InputError, match=r"a\.png"):
        ImageFile("a.png", 1e-3).image(tmp_path)
