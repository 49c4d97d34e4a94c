"""Foam around the rim of a plate, for those who ask how a plate lies on it."""

from squeezefilm.physics.plate.layout import Face, FoamSupport


def rim_supports(
    length: float,
    width: float,
    strip: float,
    thickness: float,
    young_modulus: float,
    quality_factor: float = 3.0,
    face: Face = "bottom",
) -> tuple[FoamSupport, ...]:
    """Four strips of foam of breadth `strip` around the rim of a plate of `length` × `width`."""
    return tuple(
        FoamSupport(x, y, a, b, thickness, young_modulus, quality_factor, None, face)
        for x, y, a, b in (
            (0, 0, length, strip),
            (0, width - strip, length, strip),
            (0, strip, strip, width - 2 * strip),
            (length - strip, strip, strip, width - 2 * strip),
        )
    )
