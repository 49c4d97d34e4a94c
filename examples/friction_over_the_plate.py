"""# Friction over the whole plate

The finger does not stay at the best place. Amplitude and friction at every place where its
contact lies on the plate, the best and the worst of them, and on which share of the area the
friction falls below 0.7 of what it was.
"""

import squeezefilm as sf


def main() -> dict[str, float]:
    analysis = sf.analyze("own_plate.toml", samples=0)
    assert analysis.active_area is not None
    area = analysis.active_area.area
    found = {
        "best": area.best,
        "median": area.median,
        "worst": area.worst,
        "share": area.share_below(0.7),
    }
    print(", ".join(f"{name} {value:.2f}" for name, value in found.items()))
    sf.plot(analysis).savefig("friction_over_the_plate.png")
    return found


if __name__ == "__main__":
    main()
