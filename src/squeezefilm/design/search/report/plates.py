"""A plate that a search made as the file of a display, every value with its source."""

from __future__ import annotations

from squeezefilm.core.config.write import text_of
from squeezefilm.core.kit.numbers import printable
from squeezefilm.design.search.candidate import Design, sourced_display_of
from squeezefilm.design.search.report.words import chosen_words
from squeezefilm.design.search.requirements import Requirements


def plate_file(requirements: Requirements, design: Design) -> str:
    """The text of a TOML file from which `load_display` reads the plate: the same values, and of
    each where it is from.

    Raises `GeometryError` for a design that cannot be built, and `InputError` as `text_of`.
    """
    said = printable(chosen_words(requirements, design))
    head = (
        f"# A plate that squeezefilm design found for the requirements "
        f"'{printable(requirements.name)}':\n# {said}.\n"
        "# It was computed and never built. squeezefilm analyze works it out.\n\n"
    )
    display = sourced_display_of(requirements, design)
    return head + text_of(display, display.provenance)
