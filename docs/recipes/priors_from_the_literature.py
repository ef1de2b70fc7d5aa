"""
Priors from the literature
==========================

Few trials determine twenty coefficients. What they leave open is taken from formulas in the ship's main dimensions,
each
with its source and its scatter.
"""

from pathlib import Path

import matplotlib.pyplot as plt
import pandas as pd

import seatrial as st

# %%
# ``priors_from`` names sources; later ones win. Without a scatter of their own they get ``prior_sd_percent``.

trial_file = Path("priors.toml")
trial_file.write_text("""
[ship]
name = "tanker of 320 m"
L = 320.0
B = 58.0
d = 20.8
C_b = 0.81
H_R = 15.8
A_R = 112.5
D_P = 9.86

[model]
name = "mmg"
priors_from = ["yoshimura", "zhou", "interaction", "propulsion", "displacement"]
prior_sd_percent = 30
free = ["Y_v", "Y_r", "N_v", "N_r", "t_P", "w_P0", "gamma_R_plus"]

# a value of your own for one of them
[model.priors]
t_P = { mean = 0.22, sd = 0.02, source = "self-propulsion test" }

[[records]]
files = "../../examples/ship/zigzag_20_20.csv"
time = { column = "UTC", unit = "utc" }

[records.channels]
psi = { column = "Heading [deg]", unit = "deg" }
delta = { column = "Rudder [deg]", unit = "deg" }
n = { column = "Shaft [rpm]", unit = "rpm" }
""")

trial = st.load_trial(trial_file)
rows = [
    (p.name, p.prior.mean, p.prior.standard_deviation, p.prior.source)
    for p in trial.model.parameters
    if p.free and p.prior
]
priors = pd.DataFrame(rows, columns=["coefficient", "mean", "standard deviation", "source"])
priors.round(4)

# %%
# The same as intervals of one standard deviation. The thrust deduction is the one that was stated.

figure, axes = plt.subplots(figsize=(5, 3), layout="constrained")
axes.errorbar(priors["mean"], priors["coefficient"], xerr=priors["standard deviation"], fmt="o", capsize=4)
axes.set(xlabel="prior")

# %%
# The report shows for each coefficient how much of its interval comes from the prior and how much from the records.

trial_file.unlink()
