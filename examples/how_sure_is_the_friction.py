"""# How sure is the friction?

An interval instead of a number: what it covers, and what to measure to make it narrow.
"""

import squeezefilm as sf


def main() -> dict[str, object]:
    found = sf.analyze_friction("biet2008-stator", vibration_amplitude="2 um", samples=32)
    unsure = found.uncertainty
    print(unsure.sentence)
    print(f"below 0.70 with probability {unsure.probability_below(0.7):.2f}")
    for group in unsure.groups:
        print(f"{group.total:5.0%} of the variance: {group.knowledge}")
    sf.plot(found, "uncertainty").savefig("how_sure_is_the_friction.png")
    return {"interval": unsure.interval, "nominal": unsure.nominal, "median": unsure.median}


if __name__ == "__main__":
    main()
