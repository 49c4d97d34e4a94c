# %% [markdown]
# # From volts to a confusion matrix
#
# This notebook drives one display with one voltage and follows it all the way: plate, friction,
# a grating under a moving finger, and the table of which grating people say they felt. What is not
# known of finger and contact is carried along: the last numbers are intervals, not points.
#
# It is run anew by every build of this documentation. **Every person in it is simulated.**

# %%
# %matplotlib inline
import dataclasses

import matplotlib.pyplot as plt
import numpy as np

import squeezefilm as sf
from squeezefilm.physics.perception.observer import load_observer
from squeezefilm.physics.uncertainty.draws import Mixture, as_drawn
from squeezefilm.physics.uncertainty.uncertainty import evaluate, sobol_points
from squeezefilm.study.design.study_design import load_design
from squeezefilm.study.simulated.chain_tables import chain_tables

# %% [markdown]
# ## Volts → vibration → friction
#
# The plate of Biet, Giraud and Lemaire-Semail (2008), "the paper", at its own 15 V. The plate is
# solved as a piezoelectric solid; the finger takes a little of its amplitude; film and asperities
# share the load of each fingerprint ridge.

# %%
display = sf.load_display("biet2008-plate")
(p := sf.predict(display))

# %%
sf.plot(p)

# %% [markdown]
# ## How sure is that?
#
# Roughness, moisture and modulus of the skin, and which law of friction holds, are not known. Each
# *draw* is one display and finger of those that ours may be.

# %%
mixture = Mixture(display, p, driven=True)
points = sobol_points(mixture, 128, seed=1)
drawn, refused = evaluate(mixture, points, lambda _: None)
friction = drawn.friction
levels = (0.05, 0.5, 0.95)
quantiles = np.nanquantile(friction, levels)
print(f"µ′/µ: median {quantiles[1]:.2f}, 90 % of draws {quantiles[0]:.2f} to {quantiles[2]:.2f}")
print(f"{refused.count} of {friction.size} draws refused")

# %% [markdown]
# ## A grating under a moving finger
#
# The same 4 mm grating on the draw at each of those quantiles. A display that hardly lowers
# friction draws a shallow grating.

# %%
chosen = [int(np.nanargmin(np.abs(friction - wanted))) for wanted in quantiles]
draws = list(mixture.draws(points[chosen]))
grating = sf.Amplitude(sf.SquareWave("4 mm"), 0.0, "1.6 um")
figure, axes = plt.subplots(figsize=(8, 3), layout="constrained")
for level, draw in zip(levels, draws, strict=True):
    with as_drawn():
        played = sf.render_texture(draw.display, grating, "80 mm/s over 3 cm")
    stroke = played.stroke
    friction_felt = stroke.relative_friction_rendered
    axes.plot(1e3 * stroke.position, friction_felt, label=f"{level:.0%} quantile")
axes.set(xlabel="finger position (mm)", ylabel="µ′/µ", xlim=(5, 25))
axes.legend(fontsize="small")
plt.show()

# %% [markdown]
# ## Who tells the gratings apart?
#
# Two hundred simulated people match each of the paper's five simulated gratings to one of five real
# ones, once for each of these displays. Force and size of the finger are the simulated person's
# own. Rows are gratings answered, columns are periods simulated.

# %%
design = load_design("biet2008-gratings")
design = dataclasses.replace(design, displays=design.displays[:1])
observer = load_observer("fingertip")
correct, matrices = [], []
for draw in draws:
    with as_drawn():
        tables = chain_tables(design, observer, displays=(draw.display,))
    answers = sf.simulate_participants(design, observer, 200, 7, tables)
    correct.append(answers.proportion_correct())
    matrices.append(answers.confusion())
names = matrices[0].stimuli
stack = np.array([one.percent for one in matrices])
for row, name in enumerate(matrices[0].answers):
    low, middle, high = stack[:, row].min(0), stack[1, row], stack[:, row].max(0)
    cells = (f"{m:3.0f} ({a:.0f}–{b:.0f})" for a, m, b in zip(low, middle, high, strict=True))
    print(f"{name:>8} " + "".join(f"{cell:>12}" for cell in cells))
print(f"columns: {', '.join(names)}; per cent of the answers")

# %% [markdown]
# ## What comes out

# %%
print(f"right answers: {correct[1]:.0%} on the median display,")
print(f"{min(correct):.0%} to {max(correct):.0%} over the displays that ours may be,")
print(f"{1 / len(names):.0%} by chance")

# %% [markdown]
# The spread is that of the display and the finger's friction. What is not known of the *people*
# (their senses are mostly assumed) comes on top of it, and no simulated table replaces a study:
# see [A study](../reference/study.md).
