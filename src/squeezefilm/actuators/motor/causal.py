"""A motor as a causal ordering graph, made of the motor itself, and its inversion.

Every element has inputs and one output. One that stores energy is causal: its output follows the
integral of its inputs, and time goes one way through it. One that does not is rigid: its output is
a function of its inputs at once. Control inverts the way from the voltage to the force: a rigid
element by its inverse function, a causal one only by a loop around it, which needs its output
measured. The paper's conclusion deduces its force control so; the formalism is Hautier and
Faucher's (Le graphe informationnel causal, 1996).
"""

from __future__ import annotations

from dataclasses import dataclass

from squeezefilm.actuators.motor.assembled import AssembledMotor
from squeezefilm.core.errors import InputError


@dataclass(frozen=True)
class Element:
    """One element: its name, what goes in, what comes out, the relation in words, and whether it
    is causal."""

    name: str
    inputs: tuple[str, ...]
    output: str
    relation: str
    causal: bool


@dataclass(frozen=True)
class CausalGraph:
    """The elements of a motor, and the quantities that come from outside.

    An edge goes from the element whose output it is to each that has it as an input.
    """

    elements: tuple[Element, ...]

    @property
    def sources(self) -> tuple[str, ...]:
        """The quantities that no element puts out, in the order of their first use."""
        made = {one.output for one in self.elements}
        used = dict.fromkeys(name for one in self.elements for name in one.inputs)
        return tuple(name for name in used if name not in made)

    @property
    def edges(self) -> tuple[tuple[str, str, str], ...]:
        """From element (or source), to element, and the quantity between."""
        maker = {one.output: one.name for one in self.elements}
        return tuple(
            (maker.get(name, name), one.name, name) for one in self.elements for name in one.inputs
        )

    def way(self, source: str, output: str) -> tuple[Element, ...]:
        """The elements from a quantity to another, by the shortest way. Raises `InputError` for
        quantities that the graph has not, or where no way leads."""
        known = [*self.sources, *(one.output for one in self.elements)]
        for name in (source, output):
            if name not in known:
                raise InputError(f"the graph has no '{name}'; it has: {', '.join(known)}")
        ways: list[tuple[Element, ...]] = [(one,) for one in self.elements if source in one.inputs]
        seen = {way[0].name for way in ways}
        while ways:
            way = ways.pop(0)
            if way[-1].output == output:
                return way
            for one in self.elements:
                if way[-1].output in one.inputs and one.name not in seen:
                    seen.add(one.name)
                    ways.append((*way, one))
        raise InputError(f"nothing leads from '{source}' to '{output}' in this motor")


@dataclass(frozen=True)
class InvertedElement:
    """What stands in a control law for an element: what it takes, gives and needs measured."""

    of: Element
    wanted: str
    command: str
    measured: tuple[str, ...]

    @property
    def relation(self) -> str:
        """How it is inverted, in words."""
        if self.of.causal:
            return f"a loop around {self.of.output}, which must be measured"
        return f"the inverse of: {self.of.relation}"


def causal_graph(motor: AssembledMotor) -> CausalGraph:
    """The graph of a motor: its modes, each foot that its shape moves, the slider and its guide."""
    elements: list[Element] = []
    feet = range(1, len(motor.motor.feet) + 1)
    for j, mode in enumerate(motor.modes):
        end = "" if len(motor.modes) == 1 else f"_{j + 1}"
        moved = [
            i for i in feet if motor.feet.across[i - 1, j] != 0 or motor.feet.along[i - 1, j] != 0
        ]
        forces = [f"{name}_{i}" for i in moved for name in ("N", "F")]
        elements += [
            Element(
                f"electrodes{end}", (f"V{end}",), f"f{end}", "force on the mode, by volts", False
            ),
            Element(
                f"mode {mode.working.label}",
                (f"f{end}", *forces),
                f"q{end}",
                "the mode's mass, stiffness and loss",
                True,
            ),
        ]
    elements += [one for i in feet for one in _foot(motor, i)]
    elements += [
        Element(
            "slider across",
            (*(f"N_{i}" for i in feet), "P"),
            "z",
            "mass on the feet, preload",
            True,
        ),
        Element("sum of feet", tuple(f"F_{i}" for i in feet), "F", "thrust", False),
        Element("slider along", ("F", "load"), "v", "mass and the guide's friction", True),
    ]
    return CausalGraph(tuple(elements))


def _foot(motor: AssembledMotor, i: int) -> tuple[Element, Element, Element]:
    """What foot number `i` (from 1) is made of."""
    ends = [""] if len(motor.modes) == 1 else ["_1", "_2"]
    moving = [f"q{end}" for j, end in enumerate(ends) if motor.feet.across[i - 1, j] != 0]
    along = [f"q{end}" for j, end in enumerate(ends) if motor.feet.along[i - 1, j] != 0]
    leans = motor.feet.k_nt[i - 1] != 0
    return (
        Element(
            f"contact of foot {i}",
            (*moving, "z", *((f"e_{i}",) if leans else ())),
            f"N_{i}",
            "one-sided spring and loss",
            False,
        ),
        Element(
            f"stretch of foot {i}",
            tuple(dict.fromkeys([*along, "v", f"N_{i}"])),
            f"e_{i}",
            "follows the surface while friction holds, else its limit",
            True,
        ),
        Element(
            f"leg of foot {i}",
            (f"e_{i}", *((*moving, "z") if leans else ())),
            f"F_{i}",
            "tangential spring",
            False,
        ),
    )


def averaged_graph(motor: AssembledMotor) -> CausalGraph:
    """The graph in the mean over a period: what is left to be controlled.

    The mode's amplitude is its slow envelope; contacts and friction of all feet are one function of
    amplitude, speed and preload, without memory.
    """
    label = motor.modes[0].working.label
    return CausalGraph(
        (
            Element("electrodes", ("V",), "f", "force on the mode, by volts", False),
            Element(f"envelope of {label}", ("f", "R"), "A", "amplitude, within 2Q/ω", True),
            Element("feet, on the mode", ("A", "P"), "R", "first harmonic of the contacts", False),
            Element("feet, averaged", ("A", "v", "P"), "F", "thrust(A, v, P)", False),
            Element("slider along", ("F", "load"), "v", "mass and the guide's friction", True),
        )
    )


def inverted(graph: CausalGraph, source: str, output: str) -> tuple[InvertedElement, ...]:
    """The control law that inverts the way from a command to a quantity, from the wanted one on.

    A causal element wants its output measured; a rigid one all of its other inputs. Raises as
    `CausalGraph.way`.
    """
    way = graph.way(source, output)
    found = []
    for before, one in zip([None, *way[:-1]], way, strict=True):
        main = source if before is None else before.output
        others = tuple(name for name in one.inputs if name != main)
        measured = (one.output,) if one.causal else others
        found.append(InvertedElement(one, f"{one.output} wanted", f"{main} wanted", measured))
    return tuple(reversed(found))
