"""What a study presents: virtual gratings, and the real ones they are compared with.

A grating of equal grooves and ridges has two lengths that papers call by one name: its spatial
period, and the width of a groove, which is half of it. So every grating here says which of the
two its length is (`period_means`), and everything that computes asks for `period`.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Annotated, Any, Literal

from squeezefilm import quantities as si
from squeezefilm.errors import InputError
from squeezefilm.render.texture.composition import Composable
from squeezefilm.render.texture.coordinate import FARTHEST, AlongDirection, Length
from squeezefilm.render.texture.levels import RelativeFriction
from squeezefilm.render.texture.pattern import Pattern
from squeezefilm.render.texture.shapes import SineWave, SquareWave

PeriodMeans = Literal["period", "groove width"]
Waveform = Literal["square", "sine", "constant"]
Varied = Literal["spatial_period", "friction_depth", "ridge_share", "orientation"]
"""What an adaptive method may vary of a stimulus."""

_METRE = si.Unit("m")


class _Periodic:
    """What virtual and real gratings share: grooves and ridges."""

    spatial_period: si.Metre
    period_means: PeriodMeans
    ridge_share: si.Dimensionless

    @property
    def period(self) -> si.Metre:
        """Groove plus ridge (m), whatever `spatial_period` means."""
        if self.period_means == "period":
            return self.spatial_period
        return self.spatial_period / (1.0 - self.ridge_share)

    @property
    def groove_width(self) -> si.Metre:
        """Width of a groove (m): period × (1 − ridge share)."""
        return self.period * (1.0 - self.ridge_share)


@si.checked_numbers
@dataclass(frozen=True)
class Stimulus(_Periodic):
    """A virtual grating: friction low in its grooves, high on its ridges.

    Args:
        name: what it is called in data and figures, like "4 mm".
        spatial_period: the length that the study calls by that name (m).
        period_means: whether `spatial_period` is the whole "period" or the "groove width".
        waveform: "square", "sine", or "constant" (`high` everywhere: nothing to feel, for control).
        ridge_share: share of the period that is ridge (1); a sine has 0.5.
        orientation: of the direction in which friction changes, from the x-axis (rad).
        low, high: relative friction µ′/µ of grooves and ridges (1).
        texture: a preset texture or a TOML file to present in place of this grating; the other
            fields then only say what it stands for.
        matches: the alternative that is right; if empty, the one of the same period.

    Raises:
        InputError: a value outside its range.
    """

    name: str
    spatial_period: Length
    period_means: PeriodMeans
    waveform: Waveform = "square"
    ridge_share: Annotated[si.Dimensionless, si.Above(0), si.Below(1)] = 0.5
    orientation: Annotated[si.Radian, si.AtLeast(-10.0), si.AtMost(10.0)] = 0.0
    low: Annotated[si.Dimensionless, si.AtLeast(0.0), si.AtMost(1.0)] = 0.7
    high: Annotated[si.Dimensionless, si.Above(0.0), si.AtMost(1.0)] = 1.0
    texture: str = ""
    matches: str = ""

    def __post_init__(self) -> None:
        _require_title(self.name)
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

    @property
    def friction_depth(self) -> si.Dimensionless:
        """high − low, in parts of the friction without vibration (1); 0 if constant."""
        return 0.0 if self.waveform == "constant" else self.high - self.low

    def surface(self) -> Composable:
        """The texture that is played.

        Raises `ConfigError` if `texture` names a file that cannot be read.
        """
        if self.texture:
            from squeezefilm.texture_file import load_texture

            return load_texture(self.texture).texture
        if self.waveform == "constant":
            return RelativeFriction.constant(self.high)
        along = AlongDirection(self.orientation)
        pattern: Pattern = (
            SineWave(self.period, along=along)
            if self.waveform == "sine"
            else SquareWave(self.period, duty=self.ridge_share, along=along)
        )
        return RelativeFriction(pattern, self.low, self.high)

    def amount(self, varied: Varied) -> float:
        """The present value (SI) of what an adaptive method may vary."""
        if varied == "friction_depth":
            return self.friction_depth
        return float(getattr(self, varied))

    def varied(self, name: str, varied: Varied, value: float) -> Stimulus:
        """This stimulus under another name, with one amount changed to `value` (SI).

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


def _require_title(name: str) -> None:
    if not name.strip() or len(name) > 60 or not name.isprintable():
        raise InputError(
            f"name = {name!r} cannot be used; write one line of 1 to 60 characters",
            quantity="name",
        )
