"""What a run over mutants found: shares noticed by room and by kind, and who survived."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Mapping, Sequence
from typing import Any

Line = Mapping[str, Any]


def interval(successes: int, trials: int) -> tuple[float, float]:
    """Wilson's 95 % interval of a share. Raises `ZeroDivisionError` for no trials."""
    z = 1.959964
    share, spread = successes / trials, z * z / trials
    middle = (share + spread / 2) / (1 + spread)
    half = z / (1 + spread) * math.sqrt(share * (1 - share) / trials + spread / (4 * trials))
    return middle - half, middle + half


def counts(lines: Sequence[Line], equivalent: Mapping[str, str]) -> dict[str, int]:
    """How many of some mutants were drawn, count, and were noticed: by `make test`, by all."""
    counted = [line for line in lines if line["id"] not in equivalent]
    noticed = [line for line in counted if line["noticed"]]
    return {
        "drawn": len(lines),
        "equivalent": len(lines) - len(counted),
        "counted": len(counted),
        "make test": sum(not line["marks"].startswith(("slow", "nightly")) for line in noticed),
        "noticed": len(noticed),
    }


def print_report(lines: Sequence[Line], equivalent: Mapping[str, str]) -> None:
    """Print the tables, the survivors, and the mutants that do not count with their reasons."""
    mutants = [line for line in lines if line["type"] == "mutant"]
    if not mutants:
        print("no mutants were tried yet")
        return
    # Numbers that are not whole are hardly ever equal: what then happens is told apart.
    faults = [line for line in mutants if line["kind"] != "tie"]
    print(f"\nrun: { {key: value for key, value in lines[0].items() if key != 'type'} }")
    for column in ("room", "kind"):
        groups = defaultdict(list)
        for line in mutants:
            groups[line[column]].append(line)
        heads = list(counts([], {}))
        print(f"\n{column:16}" + "".join(f"{head:>12}" for head in heads) + f"{'share':>8}")
        for name, members in [*sorted(groups.items()), ("all but ties", faults)]:
            row = counts(members, equivalent)
            share = f"{row['noticed'] / row['counted']:.0%}" if row["counted"] else "–"
            print(f"{name:16}" + "".join(f"{row[head]:12d}" for head in heads) + f"{share:>8}")
    total = counts(faults, equivalent)
    if total["counted"]:
        low, high = interval(total["noticed"], total["counted"])
        noticed = f"{total['noticed']} of {total['counted']}"
        print(f"\nnoticed, but for ties: {noticed} (95 %: {low:.0%} to {high:.0%})")
    print(f"processor time: {sum(line['seconds'] for line in mutants) / len(mutants):.1f} s each")
    left_out = [
        f"{line['asked']} ({line['said']}: {line['test']}, {line['seconds']:.0f} s)"
        for line in lines
        if line["type"] == "baseline" and line["said"] in ("failed", "slow")
    ]
    if left_out:
        print("\nasked nothing, because they do not pass on the source as it is:")
        print("  " + "\n  ".join(left_out))
    print("\nsurvived:")
    for line in mutants:
        if not line["noticed"] and line["id"] not in equivalent:
            change = f"{_short(line['before'])} → {_short(line['after'])}"
            print(f"  {line['id']} {line['at']} {line['function']} [{line['kind']}] {change}")
    print("\nnot counted:")
    for line in mutants:
        if line["id"] in equivalent:
            print(f"  {line['id']} {line['at']}: {equivalent[line['id']]}")


def _short(text: str) -> str:
    line = " ".join(text.split())
    return line if len(line) <= 60 else f"{line[:57]}…"
