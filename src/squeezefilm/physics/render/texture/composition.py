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
from typing import Annotated, Any, ClassVar, Literal, Protocol

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.arguments import reads_text
from squeezefilm.core.errors import InputError
from squeezefilm.physics.render.opcodes import ADD, CROSS, FADE, MULTIPLY, WEIGH, Assembler
from squeezefilm.physics.render.texture.pattern import (
    MOST_PARTS,
    X_AXIS,
    Coordinate,
    Pattern,
    Place,
    TexturePart,
    part,
    require_fade,
)

Quantity = Literal["amplitude", "relative_friction", "friction_reduction"]
"""Quantities of a texture's values."""

AT_REST: dict[Quantity, float] = {
    "amplitude": 0.0,
    "relative_friction": 1.0,
    "friction_reduction": 0.0,
}
"""The value of a plate that does not vibrate."""


class Texture(Protocol):
    """The seam between what is to be felt and what renders it.

    It commands an amplitude in metres, never a bare 0 to 1, so that what a value means does not
    depend on the display.

    Called with the finger's position `x`, `y` (m), its velocity `v` along its path (m/s; |v| is
    its speed, and v is negative on the way back, which only a `Bump` asks for) and the time `t`
    since the stroke began (s), it returns the vibration amplitude wanted there (m, zero-to-peak).
    The four broadcast against each other; the result has the broadcast shape. A `Composable`
    whose quantity is not the amplitude needs a renderer to become one.
    """

    def __call__(
        self, x: si.MetreLike, y: si.MetreLike, v: si.MetrePerSecondLike, t: si.SecondLike, /
    ) -> si.MetreArray:
        """The vibration amplitude wanted (m, zero-to-peak)."""
        ...


class Composable(TexturePart):
    """A texture with a quantity that composes with others; the base of every texture here."""

    __slots__ = ()
    WANTED: ClassVar[str] = (
        "texture with a quantity; give one such as Amplitude(pattern, low, high)"
    )
    _quantity: ClassVar[Quantity]

    @property
    def quantity(self) -> Quantity:
        """Quantity of the values: amplitude (m), relative_friction or friction_reduction (1)."""
        return self._quantity

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
        """Texture that is this one where `mask` is 1, and the plate at rest where it is 0."""
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
        """Texture that is this one before `at` (m; x unless `along` is given), then `other`."""
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


def _require_alike(textures: SequenceOf[Composable], what: str) -> None:
    if not 1 <= len(textures) <= MOST_PARTS:
        raise InputError(
            f"a {what} of {len(textures)} textures cannot be made: give 1 to {MOST_PARTS}",
            quantity="textures",
        )
    quantities = list(dict.fromkeys(texture.quantity for texture in textures))
    if len(quantities) > 1:
        raise InputError(
            f"a {what} cannot mix {' and '.join(quantities)}: all its textures must be of one "
            "quantity; write them all in one",
            quantity="textures",
        )


@part
class _Several(Composable):
    """Textures of one quantity, which is its own."""

    textures: tuple[Composable, ...]

    @property
    def quantity(self) -> Quantity:
        """Quantity of its textures."""
        return self.textures[0].quantity


@part
class Sum(_Several):
    """The sum of `textures` of one quantity. Raises `InputError` for a mixture."""

    def __post_init__(self) -> None:
        _require_alike(self.textures, "sum")

    def _lower(self, assembler: Assembler) -> None:
        for index, texture in enumerate(self.textures):
            texture._lower(assembler)
            if index:
                assembler.emit(ADD)


@part
class _Changed(Composable):
    """A texture that something changes, but for its quantity."""

    texture: Composable

    @property
    def quantity(self) -> Quantity:
        """Quantity of its texture."""
        return self.texture.quantity


@part
class _Shaped(_Changed):
    """A texture that a pattern shapes."""

    pattern: Pattern


@part
class Product(_Shaped):
    """`texture` times a dimensionless `pattern`, value by value. See `Masked` to fade to rest."""

    def _lower(self, assembler: Assembler) -> None:
        self.texture._lower(assembler)
        self.pattern._lower(assembler)
        assembler.emit(MULTIPLY)


@part
class Scaled(_Changed):
    """`texture` times a number from 0 to 1000. Raises `InputError` outside that."""

    factor: Annotated[si.Dimensionless, si.AtLeast(0.0), si.AtMost(1000.0)]

    def _lower(self, assembler: Assembler) -> None:
        self.texture._lower(assembler)
        assembler.emit(WEIGH, self.factor)


@part
class Masked(_Shaped):
    """`texture` where `pattern` is 1, the plate at rest where it is 0.

    Value: rest + pattern·(texture − rest), with the rest of the texture's quantity.
    """

    def _lower(self, assembler: Assembler) -> None:
        self.texture._lower(assembler)
        self.pattern._lower(assembler)
        assembler.emit(FADE, AT_REST[self.quantity])


@part
class Sequence(_Several):
    """Textures one after another in space: `textures[k]` up to `edges[k]`, the last beyond.

    Args:
        textures: of one quantity, one more than there are edges.
        edges: rising coordinates (m) where the next begins, within ±10 m.
        fade: width over which one passes linearly into the next (m), centred on the edge; 0, or
            from 1 nm to the least distance between two edges.
        along: the coordinate.

    Raises:
        InputError: textures of several quantities, edges that do not rise or fit, a fade too wide.
    """

    edges: tuple[Place, ...]
    fade: si.Metre = 0.0
    along: Coordinate = X_AXIS

    def __post_init__(self) -> None:
        _require_alike(self.textures, "sequence")
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

    def _lower(self, assembler: Assembler) -> None:
        self.textures[0]._lower(assembler)
        for edge, after in zip(self.edges, self.textures[1:], strict=True):
            after._lower(assembler)
            self.along._lower(assembler)
            assembler.emit(CROSS, edge, self.fade)
