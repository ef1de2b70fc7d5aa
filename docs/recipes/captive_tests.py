"""
Captive tests with free runs
============================

Forces measured on a model held in steady motion, or computed by CFD, are fitted together with records, each with its
own noise. Here a table of drift and yaw tests determines what a zigzag leaves open.
"""

from pathlib import Path

import numpy as np
import pandas as pd

import seatrial as st

# %%
# A table of forces at one speed, made from the example's known coefficients with 2 % noise.

examples = Path("../../examples")
trial = st.load_trial(examples / "waterjet.toml")
craft = trial.model.with_values(trial.truth)

rng = np.random.default_rng(3)
speed = 0.8
drift_angles, yaw_rates = np.radians([-15, -10, -5, 0, 5, 10, 15]), [-0.02, 0.0, 0.02]
beta, yaw = (grid.ravel() for grid in np.meshgrid(drift_angles, yaw_rates))
states = np.column_stack([speed * np.cos(beta), -speed * np.sin(beta), yaw, *np.zeros((3, beta.size))])
forces = craft.forces(states, np.tile([0.0, 1.866], (beta.size, 1)))
table = pd.DataFrame({"beta": np.degrees(beta), "r": yaw})
for name in ("X", "Y", "N"):
    clean = forces[f"{name}_sum"]
    table[name] = clean + 0.02 * np.ptp(clean) * rng.standard_normal(beta.size)
table.to_csv("captive.csv", index=False)
table.head()

# %%
# ``[[forces]]`` says what was measured at which motion, and how well.

points = """
[[forces]]
file = "CAPTIVE"
includes = "hydrodynamic"
sd_percent = 2
[forces.motion]
U = { value = 0.8, unit = "m/s" }
beta = { column = "beta", unit = "deg", positive = "bow to starboard" }
r = { column = "r", unit = "rad/s" }
delta = { value = 0, unit = "deg" }
v_j = { value = 1.866, unit = "m/s" }
[forces.measured]
X = { column = "X", unit = "N" }
Y = { column = "Y", unit = "N" }
N = { column = "N", unit = "N m" }
""".replace("CAPTIVE", str(Path("captive.csv").resolve()))
text = (examples / "waterjet.toml").read_text()
Path("fusion.toml").write_text(text.replace('"waterjet"', '"../../examples/waterjet"', 1) + points)

alone = st.identify(examples / "waterjet.toml")
together = st.identify("fusion.toml")
errors = pd.DataFrame(
    {
        "truth": pd.Series(trial.truth),
        "records alone": alone.to_dataframe()["standard_error"],
        "with captive tests": together.to_dataframe()["standard_error"],
    }
).dropna()
print(errors)

# %%
# Standard errors with the table, over those of the records alone. Below 1 the captive tests add what the zigzags lack.

ratio = errors["with captive tests"] / errors["records alone"]
axes = ratio.plot.barh(figsize=(5, 4), color="#1b4f72", xlabel="ratio of standard errors")
axes.figure.tight_layout()

# %%
for name in ("captive.csv", "fusion.toml"):
    Path(name).unlink()
