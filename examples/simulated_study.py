"""# A simulated study

Who would tell the paper's gratings apart: twelve simulated people, and the study they answer.
"""

import squeezefilm as sf


def main() -> dict[str, float]:
    answers = sf.simulate_participants("biet2008-gratings", "fingertip", 12, seed=7)
    matrix = answers.confusion()
    print("rows: gratings answered; columns: periods simulated; per cent")
    for name, row in zip(matrix.answers, matrix.percent, strict=True):
        print(f"{name:>8}", *(f"{share:6.1f}" for share in row))
    share = answers.proportion_correct()
    print(f"{share:.0%} right, by {answers.participants} people, all simulated")
    sf.plot(answers).savefig("simulated_study.png")
    return {"correct": share, "chance": 1 / len(matrix.stimuli)}


if __name__ == "__main__":
    main()
