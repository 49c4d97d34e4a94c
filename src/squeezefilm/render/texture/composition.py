"""Textures as values that compose: sums, products with patterns, masks, sequences in space.

A texture has a quantity, and its value is in that quantity's unit, never a bare 0 to 1:

====================  =====  ==========================================  ============  =======
quantity              unit   what it is                                  a rise feels  at rest
====================  =====  ==========================================  ============  =======
amplitude             m      vibration amplitude, zero-to-peak           slipperier    0
relative_friction     1      friction over that of the surface at rest   stickier      1
friction_reduction    1      friction coefficient taken away, µ − µ′     slipperier    0
====================  =====  ==========================================  ============  =======

"At rest" is the value of a plate that does not vibrate. With textures a, b of one quantity and a
pattern m:

- ``a + b`` adds values; ``a * 0.5`` and ``a * m`` multiply them;
- ``a & m`` = `a.mask(m)` = `a.when(m)` fades to rest where m is 0: rest + m (a − rest);
- `a.then(b, at=0.02)` is a before x = 20 mm and b after it.

For an amplitude or a reduction, whose rest is 0, ``a & m`` and ``a * m`` are the same. A relative
friction times 0 is no friction at all, which no display makes: mask it. + is commutative and
associative, and ``(a + b) * m = a * m + b * m``.
"""

from __future__ import annotations

from collections.abc import Sequence as SequenceOf
from dataclasses import dataclass, field
from typing import Annotated, Any, ClassVar, Literal

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.errors import InputError
from squeezefilm.from_text import reads_text
from squeezefilm.render.opcodes import ADD, CROSS, FADE, MULTIPLY, WEIGH, Assembler
from squeezefilm.render.texture.coordinate import (
    X_AXIS,
    Coordinate,
    Place,
    finger_arguments,
    require_coordinate,
    require_fade,
)
from squeezefilm.render.texture.pattern import MOST_PARTS, Pattern, require_pattern

Quantity = Literal["amplitude", "relative_friction", "friction_reduction"]
"""What a texture's values are."""

Polarity = Literal["slipperier", "stickier"]
"""What a greater value feels like."""

AT_REST: dict[Quantity, float] = {
    "amplitude": 0.0,
    "relative_friction": 1.0,
    "friction_reduction": 0.0,
}
"""The value of a plate that does not vibrate."""


class Composable:
    """A texture with a quantity that composes with others; the base of every texture here.

    Called with the finger's place `x`, `y` (m), its velocity `v` along its path (m/s; negative on
    the way back) and the time `t` (s), which broadcast; returns values of its `quantity` in the
    broadcast shape. Raises `InputError` for an argument that is not finite or shapes that do not
    broadcast.
    """

    __slots__ = ()
    _quantity: ClassVar[Quantity]

    @property
    def quantity(self) -> Quantity:
        """What the values are: amplitude (m), relative_friction or friction_reduction (1)."""
        return self._quantity

    @property
    def polarity(self) -> Polarity:
        """What a greater value feels like."""
        return "stickier" if self.quantity == "relative_friction" else "slipperier"

    def __call__(
        self, x: si.MetreLike, y: si.MetreLike, v: si.MetrePerSecondLike, t: si.SecondLike, /
    ) -> si.FloatArray:
        """The texture at these places, velocities and times (m for an amplitude, else 1)."""
        return np.array(self._values(*finger_arguments(x, y, v, t)))

    def _values(
        self, x: si.FloatArray, y: si.FloatArray, v: si.FloatArray, t: si.FloatArray
    ) -> si.FloatArray:
        raise NotImplementedError

    def _lower(self, assembler: Assembler) -> None:
        raise NotImplementedError

    def __add__(self, other: Composable) -> Sum:
        if not isinstance(other, Composable):
            raise _no_sum(other)
        return Sum((*_terms(self), *_terms(other)))

    def __radd__(self, other: Any) -> Sum:
        raise _no_sum(other)

    def __mul__(self, other: Pattern | si.FloatLike) -> Product | Scaled:
        if isinstance(other, Pattern):
            return Product(self, other)
        if isinstance(other, Composable):
            raise InputError(
                f"a texture of {self.quantity} times one of {other.quantity} has no quantity; "
                "multiply a texture by a number or a pattern"
            )
        if isinstance(other, int | float) and not isinstance(other, bool):
            return Scaled(self, float(other))
        return NotImplemented

    def __rmul__(self, other: Pattern | si.FloatLike) -> Product | Scaled:
        return self.__mul__(other)

    def __and__(self, mask: Pattern) -> Masked:
        return Masked(self, mask)

    def mask(self, mask: Pattern) -> Masked:
        """This texture where `mask` is 1, the plate at rest where it is 0."""
        return Masked(self, mask)

    def when(self, condition: Pattern) -> Masked:
        """The same as `mask`, for conditions: ``texture.when(speed > 0.02)``."""
        return Masked(self, condition)

    @reads_text
    @si.checked_numbers
    def then(
        self,
        other: Composable,
        at: si.Metre,
        *,
        fade: si.Metre = 0.0,
        along: Coordinate | None = None,
    ) -> Sequence:
        """This texture before the coordinate `at` (m; x unless `along` is given), then `other`."""
        coordinate = along or X_AXIS
        # An edge before the last one cuts what is there off: that needs a sequence around it.
        if (
            isinstance(self, Sequence)
            and (self.fade, self.along) == (fade, coordinate)
            and (not self.edges or at > self.edges[-1] + fade)
        ):
            return Sequence((*self.textures, other), (*self.edges, at), fade, coordinate)
        return Sequence((self, other), (at,), fade, coordinate)


def _no_sum(other: object) -> InputError:
    return InputError(
        f"{other!r} cannot be added to a texture: it has no quantity; add a texture such as "
        "Amplitude(pattern, low, high)"
    )


def _terms(texture: Composable) -> tuple[Composable, ...]:
    return texture.textures if isinstance(texture, Sum) else (texture,)


def require_texture(name: str, value: object) -> None:
    """Refuse what is no `Composable` texture."""
    if not isinstance(value, Composable):
        raise InputError(
            f"{name} = {value!r} is no texture with a quantity; give one such as "
            "Amplitude(pattern, low, high) or Square(spatial_period, low, high)",
            quantity=name,
        )


def _require_alike(textures: SequenceOf[Composable], what: str) -> None:
    if not 1 <= len(textures) <= MOST_PARTS:
        raise InputError(
            f"a {what} of {len(textures)} textures cannot be made: give 1 to {MOST_PARTS}",
            quantity="textures",
        )
    for one in textures:
        require_texture("textures", one)
    found = list(dict.fromkeys(one.quantity for one in textures))
    if len(found) > 1:
        raise InputError(
            f"a {what} cannot mix {' and '.join(found)}: all its textures must be of one "
            "quantity; write them all in one",
            quantity="textures",
        )


@dataclass(frozen=True, slots=True)
class Sum(Composable):
    """The sum of `textures` of one quantity. Raises `InputError` for a mixture."""

    textures: tuple[Composable, ...]
    type: Literal["sum"] = field(default="sum", repr=False)

    def __post_init__(self) -> None:
        _require_alike(self.textures, "sum")

    @property
    def quantity(self) -> Quantity:
        """That of its textures."""
        return self.textures[0].quantity

    def _values(
        self, x: si.FloatArray, y: si.FloatArray, v: si.FloatArray, t: si.FloatArray
    ) -> si.FloatArray:
        parts = [one._values(x, y, v, t) for one in self.textures]
        return np.asarray(np.add.reduce(parts))

    def _lower(self, assembler: Assembler) -> None:
        for index, one in enumerate(self.textures):
            one._lower(assembler)
            if index:
                assembler.emit(ADD)


class _Shaped:
    """A texture that a pattern shapes."""

    __slots__ = ()
    texture: Composable
    pattern: Pattern

    def __post_init__(self) -> None:
        require_texture("texture", self.texture)
        require_pattern("pattern", self.pattern)

    @property
    def quantity(self) -> Quantity:
        """That of its texture."""
        return self.texture.quantity


@dataclass(frozen=True, slots=True)
class Product(_Shaped, Composable):
    """`texture` times a dimensionless `pattern`, value by value. See `Masked` to fade to rest."""

    texture: Composable
    pattern: Pattern
    type: Literal["product"] = field(default="product", repr=False)

    def _values(
        self, x: si.FloatArray, y: si.FloatArray, v: si.FloatArray, t: si.FloatArray
    ) -> si.FloatArray:
        return self.texture._values(x, y, v, t) * self.pattern._values(x, y, v, t)

    def _lower(self, assembler: Assembler) -> None:
        self.texture._lower(assembler)
        self.pattern._lower(assembler)
        assembler.emit(MULTIPLY)


@si.checked_numbers
@dataclass(frozen=True, slots=True)
class Scaled(Composable):
    """`texture` times a number from 0 to 1000. Raises `InputError` outside that."""

    texture: Composable
    factor: Annotated[si.Dimensionless, si.AtLeast(0.0), si.AtMost(1000.0)]
    type: Literal["scaled"] = field(default="scaled", repr=False)

    def __post_init__(self) -> None:
        require_texture("texture", self.texture)

    @property
    def quantity(self) -> Quantity:
        """That of its texture."""
        return self.texture.quantity

    def _values(
        self, x: si.FloatArray, y: si.FloatArray, v: si.FloatArray, t: si.FloatArray
    ) -> si.FloatArray:
        return self.factor * self.texture._values(x, y, v, t)

    def _lower(self, assembler: Assembler) -> None:
        self.texture._lower(assembler)
        assembler.emit(WEIGH, self.factor)


@dataclass(frozen=True, slots=True)
class Masked(_Shaped, Composable):
    """`texture` where `pattern` is 1, the plate at rest where it is 0.

    Value: rest + pattern·(texture − rest), with the rest of the texture's quantity.
    """

    texture: Composable
    pattern: Pattern
    type: Literal["masked"] = field(default="masked", repr=False)

    def _values(
        self, x: si.FloatArray, y: si.FloatArray, v: si.FloatArray, t: si.FloatArray
    ) -> si.FloatArray:
        share = self.pattern._values(x, y, v, t)
        rest = AT_REST[self.quantity]
        return (1.0 - share) * rest + share * self.texture._values(x, y, v, t)

    def _lower(self, assembler: Assembler) -> None:
        self.texture._lower(assembler)
        self.pattern._lower(assembler)
        assembler.emit(FADE, AT_REST[self.quantity])


@si.checked_numbers
@dataclass(frozen=True, slots=True)
class Sequence(Composable):
    """One texture after another in space: `textures[k]` up to `edges[k]`, the last beyond.

    Args:
        textures: of one quantity, one more than there are edges.
        edges: rising coordinates (m) where the next begins, within ±10 m.
        fade: width over which one passes linearly into the next (m), centred on the edge; 0, or
            from 1 nm to the least distance between two edges.
        along: the coordinate.

    Raises:
        InputError: textures of several quantities, edges that do not rise or fit, a fade too wide.
    """

    textures: tuple[Composable, ...]
    edges: tuple[Place, ...]
    fade: si.Metre = 0.0
    along: Coordinate = X_AXIS
    type: Literal["sequence"] = field(default="sequence", repr=False)

    def __post_init__(self) -> None:
        _require_alike(self.textures, "sequence")
        require_coordinate(self.along)
        if len(self.edges) != len(self.textures) - 1:
            raise InputError(
                f"a sequence of {len(self.textures)} textures needs {len(self.textures) - 1} edges "
                f"between them; here are {len(self.edges)}",
                quantity="edges",
            )
        steps = np.diff(self.edges)
        if np.any(steps <= 0.0):
            raise InputError(
                "the edges of a sequence must rise from each to the next", quantity="edges"
            )
        widest = float(np.min(steps)) if steps.size else 1.0
        require_fade(self.fade, widest)

    @property
    def quantity(self) -> Quantity:
        """That of its textures."""
        return self.textures[0].quantity

    def _values(
        self, x: si.FloatArray, y: si.FloatArray, v: si.FloatArray, t: si.FloatArray
    ) -> si.FloatArray:
        s = self.along.at(x, y)
        found = self.textures[0]._values(x, y, v, t)
        for edge, after in zip(self.edges, self.textures[1:], strict=True):
            if self.fade == 0.0:
                share = np.where(s < edge, 0.0, 1.0)
            else:
                share = np.clip((s - edge) / self.fade + 0.5, 0.0, 1.0)
            found = (1.0 - share) * found + share * after._values(x, y, v, t)
        return found

    def _lower(self, assembler: Assembler) -> None:
        self.textures[0]._lower(assembler)
        for edge, after in zip(self.edges, self.textures[1:], strict=True):
            after._lower(assembler)
            self.along._lower(assembler)
            assembler.emit(CROSS, edge, self.fade)
