"""How fine a plate is meshed."""

from __future__ import annotations

from dataclasses import dataclass

from squeezefilm import quantities as si


@dataclass(frozen=True)
class Resolution:
    """How fine a plate is meshed.

    `edge_layers` are distances of element edges from a ceramic's edge, in units of the thinner of
    plate and ceramic (`edge_layers_y` those across the slices), `bond_layers` those from a bond
    across the thickness, in units of the layer's own. `order_x` is the least order of elements in
    the plane, `order_z` that across each layer; `extra_x` and `extra_y` are added to 0.65 times the
    phase (rad) that the shortest wave covers in an element.
    """

    edge_layers: tuple[float, ...]
    edge_layers_y: tuple[float, ...]
    order_x: int
    extra_x: float
    extra_y: float
    order_z: int
    bond_layers: tuple[float, ...] = ()
    trunk: si.Dimensionless = 1.0


# From each to the next every kind of error (smooth, at strip edges, at the bond) falls by a factor
# of three or more: only then does the difference of two say what the finer one still lacks.
COARSE = Resolution((0.9,), (0.9,), 3, 1, 2, 3, trunk=1.3)


NORMAL = Resolution((0.2, 1.2), (0.3,), 3, 3, 4, 6)


FINE = Resolution((0.06, 0.4, 1.5), (0.15,), 3, 3, 5.5, 5, (0.1,))
