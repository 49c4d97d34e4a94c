"""# A finger drags its skin

A square grating under a finger whose skin has a mass: the force on the bone.
"""

import matplotlib.pyplot as plt
import numpy as np

import squeezefilm as sf


def main() -> dict[str, float]:
    high = sf.predict("biet2008-plate", model="paper2008").vibration_amplitude
    grating = sf.Amplitude(sf.SquareWave("1 mm"), 0.0, high)
    rendered = sf.render_texture(
        "biet2008-plate", grating, "80 mm/s over 4 cm", model="paper2008", normal_force="0.5 N"
    )
    motion = rendered.force
    sticks_until = motion.time[motion.sticking][-1]
    time, sliding = motion.time[motion.time > 0.1], motion.bone_force[motion.time > 0.1]
    rises = time[1:][np.diff(np.sign(sliding - sliding.mean())) > 0]
    result = {
        "sticks_until_s": float(sticks_until),
        "least_force_N": float(sliding.min()),
        "greatest_force_N": float(sliding.max()),
        "swings_Hz": float((rises.size - 1) / (rises[-1] - rises[0])),
        "energy_residual_J": motion.energy_residual,
    }
    for name, value in result.items():
        print(f"{name}: {value:.4g}")
    figure, axes = plt.subplots(figsize=(7, 3), layout="constrained")
    axes.plot(motion.time * 1e3, motion.bone_force)
    axes.set(xlim=(0, 60), xlabel="time (ms)", ylabel="tangential force on the bone (N)")
    figure.savefig("finger_drags_its_skin.png")
    plt.close(figure)
    return result


if __name__ == "__main__":
    main()
