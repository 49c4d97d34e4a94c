"""# The modes of a plate of one's own

An aluminium plate described in a file, solved in three dimensions: the modes near the one that it
is to work in, and the shape of that one. `squeezefilm modes` lists them quickly before anything
is chosen.
"""

import squeezefilm as sf


def main() -> dict[str, float]:
    plate = sf.solve_plate("own_plate.toml", band=("38 kHz", "42 kHz"))
    modes = plate.to_pandas()[["label", "frequency_Hz", "quality_factor"]]
    print(modes.to_string(index=False))
    sf.plot(plate).savefig("modes_of_an_own_plate.png")
    return dict(zip(modes["label"], modes["frequency_Hz"], strict=True))


if __name__ == "__main__":
    main()
