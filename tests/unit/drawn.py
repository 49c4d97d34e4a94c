"""What a figure says: its words without line ends, its lines by their labels."""

from typing import Any


def words(text: str) -> str:
    """A text in one line, its narrow blanks as plain ones."""
    return text.replace("\u00a0", " ").replace("\n", " ")


def labelled(axes: Any) -> dict[str, Any]:
    """What a legend would name, by its label."""
    return dict(zip(*axes.get_legend_handles_labels()[::-1], strict=True))
