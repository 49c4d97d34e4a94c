"""Stimuli of a study: virtual gratings, shapes and maps, and the real gratings they are compared
with.

A grating of equal grooves and ridges has two lengths that papers call by one name: its spatial
period, and the width of a groove, which is half of it. So every grating here says which of the
two its length is (`period_means`), and everything that computes asks for `period`.
"""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from typing import Annotated, Any, Literal

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.results import config_hash
from squeezefilm.physics.render.texture.composition import Composable
from squeezefilm.physics.render.texture.levels import RelativeFriction
from squeezefilm.physics.render.texture.pattern import FARTHEST, AlongDirection, Length, Pattern
from squeezefilm.physics.render.texture.shapes import SineWave, SquareWave
from squeezefilm.physics.texture_files.texture_file import load_texture

PeriodMeans = Literal["period", "groove width"]
Waveform = Literal["square", "sine", "constant"]
Varied = Literal["spatial_period", "friction_depth", "ridge_share", "orientation"]
"""Amounts of a stimulus that an adaptive method may vary."""

_METRE = si.Unit("m")


class _Periodic:
    """Base of virtual and real gratings: grooves and ridges."""

    period_means: PeriodMeans | None
    ridge_share: si.Dimensionless

    @property
    def period(self) -> si.Metre:
        """Groove plus ridge (m)."""
        raise NotImplementedError

    def _whole(self, length: si.Metre) -> si.Metre:
        return length if self.period_means == "period" else length / (1.0 - self.ridge_share)

    @property
    def groove_width(self) -> si.Metre:
        """Width of a groove (m): period × (1 − ridge share)."""
        return self.period * (1.0 - self.ridge_share)


@si.checked_numbers
@dataclass(frozen=True)
class Stimulus(_Periodic):
    """A virtual surface: a grating of one axis or two, a shape, or a map.

    A grating has a `spatial_period`, and friction low in its grooves and high on its ridges; with a
    `crossed_period` a second one crosses it at right angles, and ridges are left where both have
    one. A shape or a map is a `pattern`, low where that is 0 and high where it is 1. What neither
    says is a `texture`. A surface without a `spatial_period` has no period, which is then NaN.

    Args:
        name: what it is called in data and figures, like "4 mm".
        spatial_period: the length that the study calls by that name (m); None for a shape or map.
        period_means: whether `spatial_period` is the whole "period" or the "groove width".
        waveform: "square", "sine", or "constant" (`high` everywhere: nothing to feel, for control).
        ridge_share: share of the period that is ridge (1); a sine has 0.5.
        orientation: of the direction in which friction changes, from the x-axis (rad).
        low, high: relative friction µ′/µ of grooves and ridges (1).
        texture: a preset texture or a TOML file to present in place of this grating; the other
            fields then only say what it stands for.
        matches: the alternative that is right; if empty, the one of the same period.
        crossed_period: of the grating at right angles to the first (m), of the same kind of length.
        pattern: a shape or a map in the plane, as in a texture's file: a band, a disc, a bump, a
            picture ("image_file").

    Raises:
        InputError: a value outside its range, or a surface that is said twice or not at all.
    """

    name: str
    spatial_period: Length | None = None
    period_means: PeriodMeans | None = None
    waveform: Waveform = "square"
    ridge_share: Annotated[si.Dimensionless, si.Above(0), si.Below(1)] = 0.5
    orientation: Annotated[si.Radian, si.AtLeast(-10.0), si.AtMost(10.0)] = 0.0
    low: Annotated[si.Dimensionless, si.AtLeast(0.0), si.AtMost(1.0)] = 0.7
    high: Annotated[si.Dimensionless, si.Above(0.0), si.AtMost(1.0)] = 1.0
    texture: str = ""
    matches: str = ""
    crossed_period: Length | None = None
    pattern: Pattern | None = None

    def __post_init__(self) -> None:
        _require_title(self.name)
        self._require_one_surface()
        if self.low >= self.high:
            raise InputError(
                f"stimulus '{self.name}': low = {self.low:g} is not below high = {self.high:g}; "
                'grooves are the slippery part; for no grating at all take waveform = "constant"',
                quantity="low",
            )
        if self.waveform == "sine" and self.ridge_share != 0.5:
            raise InputError(
                f"stimulus '{self.name}': a sine has ridge_share = 0.5, not {self.ridge_share:g}; "
                "leave it out or take a square",
                quantity="ridge_share",
            )

    def _require_one_surface(self) -> None:
        said = f"stimulus '{self.name}'"
        if self.spatial_period is not None and self.period_means is None:
            raise InputError(
                f"{said} has a spatial_period and does not say which length that is; add "
                'period_means = "period" or "groove width"',
                quantity="period_means",
            )
        if self.spatial_period is None and self.crossed_period is not None:
            raise InputError(
                f"{said} has a crossed_period and nothing that it crosses; add spatial_period",
                quantity="crossed_period",
            )
        if self.pattern is not None and (self.spatial_period is not None or self.texture):
            other = "texture" if self.texture else "spatial_period"
            raise InputError(
                f"{said} has a pattern and a {other}, which are two surfaces; leave one out",
                quantity="pattern",
            )
        nothing = self.spatial_period is None and self.pattern is None and not self.texture
        if nothing and self.waveform != "constant":
            raise InputError(
                f"{said} says no surface; give it a spatial_period (a grating), a pattern (a shape "
                "or a map) or a texture (a preset's name or a file)",
                quantity="spatial_period",
            )

    @property
    def period(self) -> si.Metre:
        """Groove plus ridge (m), whatever `spatial_period` means; NaN where there is none."""
        return math.nan if self.spatial_period is None else self._whole(self.spatial_period)

    @property
    def second_period(self) -> si.Metre:
        """The same of the grating at right angles (m); NaN where there is none."""
        return math.nan if self.crossed_period is None else self._whole(self.crossed_period)

    @property
    def surface_sha256(self) -> str:
        """Hash of the surface that is played, files and pictures read: two with the same hash are
        the same surface. Raises what `surface` raises."""
        return config_hash(self.surface())

    @property
    def kind(self) -> str:
        """Kind in words: "square grating", "crossed sine gratings", "shape", "picture" …"""
        if self.texture:
            return f"texture {self.texture}"
        if self.pattern is not None:
            name = str(getattr(self.pattern, "type", "pattern")).replace("_", " ")
            return f"pattern: {name}"
        if self.waveform == "constant":
            return "constant"
        crossed = self.crossed_period is not None
        return f"crossed {self.waveform} gratings" if crossed else f"{self.waveform} grating"

    @property
    def friction_depth(self) -> si.Dimensionless:
        """high − low, in parts of the friction without vibration (1); 0 if constant."""
        return 0.0 if self.waveform == "constant" else self.high - self.low

    def surface(self) -> Composable:
        """The texture that is played.

        Raises `ConfigError` if `texture` names a file that cannot be read.
        """
        if self.texture:
            return load_texture(self.texture).texture
        if self.waveform == "constant":
            return RelativeFriction.constant(self.high)
        if self.pattern is not None:
            return RelativeFriction(self.pattern, self.low, self.high)
        pattern = self._grating(self.period, self.orientation)
        if self.crossed_period is not None:
            pattern = pattern & self._grating(self.second_period, self.orientation + math.pi / 2)
        return RelativeFriction(pattern, self.low, self.high)

    def _grating(self, period: si.Metre, orientation: si.Radian) -> Pattern:
        along = AlongDirection(orientation)
        if self.waveform == "sine":
            return SineWave(period, along=along)
        return SquareWave(period, duty=self.ridge_share, along=along)

    def amount(self, varied: Varied) -> float:
        """The present value (SI) of what an adaptive method may vary; NaN where there is none, as
        of the period of a shape."""
        if varied == "friction_depth":
            return math.nan if self.texture and self.spatial_period is None else self.friction_depth
        value = getattr(self, varied)
        return math.nan if value is None or self.spatial_period is None else float(value)

    def varied(self, name: str, varied: Varied, value: float) -> Stimulus:
        """Stimulus like this under another name, with one amount changed to `value` (SI).

        A friction depth lowers the grooves and leaves the ridges.
        Raises `InputError` for a value outside its range.
        """
        deeper = varied == "friction_depth"
        changed: dict[str, Any] = {"low": self.high - value} if deeper else {varied: value}
        return dataclasses.replace(self, name=name, matches="", **changed)


@si.checked_numbers
@dataclass(frozen=True)
class Grating(_Periodic):
    """A real grating that is touched for comparison, like the paper's etched copper boards.

    Args:
        name: what it is called, like "4 mm".
        spatial_period: the length that the study calls by that name (m).
        period_means: whether that is the whole "period" or the "groove width".
        ridge_share: share of the period that is ridge (1).
        ridge_height: of ridges above grooves (m).
        length, width: of the board along and across the stroke (m).
        material: of the ridges.

    Raises:
        InputError: a value outside its range.
    """

    name: str
    spatial_period: Length
    period_means: PeriodMeans
    ridge_share: Annotated[si.Dimensionless, si.Above(0), si.Below(1)] = 0.5
    ridge_height: Annotated[si.Metre, si.Above(0.0), si.AtMost(0.01)] = 70e-6
    length: Annotated[si.Metre, si.Above(0.0), si.AtMost(FARTHEST)] = 0.13
    width: Annotated[si.Metre, si.Above(0.0), si.AtMost(FARTHEST)] = 7e-3
    material: str = "copper"

    def __post_init__(self) -> None:
        _require_title(self.name)

    @property
    def period(self) -> si.Metre:
        """Groove plus ridge (m), whatever `spatial_period` means."""
        return self._whole(self.spatial_period)


def _require_title(name: str) -> None:
    if not name.strip() or len(name) > 60 or not name.isprintable():
        raise InputError(
            f"name = {name!r} cannot be used; write one line of 1 to 60 characters",
            quantity="name",
        )
