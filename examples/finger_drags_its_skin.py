"""# A finger drags its skin

A square grating under a finger whose skin has a mass: its force, and how the skin vibrates.
"""

import matplotlib.pyplot as plt

import squeezefilm as sf


def main() -> dict[str, float]:
    high = sf.predict("biet2008-plate", model="paper2008").vibration_amplitude
    grating = sf.Amplitude(sf.SquareWave("1 mm"), 0.0, high)
    rendered = sf.render_texture(
        "biet2008-plate", grating, "80 mm/s over 4 cm", model="paper2008", normal_force="0.5 N"
    )
    motion, lines = rendered.force, rendered.skin_vibration()
    sliding = motion.bone_force[motion.time >= lines.start]
    result = {
        "sticks_until_s": float(motion.time[motion.sticking][-1]),
        "least_force_N": float(sliding.min()),
        "greatest_force_N": float(sliding.max()),
        "fundamental_Hz": float(lines.harmonic_frequency[0]),
        "displacement_amplitude_m": float(lines.displacement_amplitude[0]),
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
