"""
What the answer depends on
==========================

The lift is solved again with one thing after the other a little changed, up and down, while everybody plans anew.
"""

import matplotlib.pyplot as plt

import liftopt as lo

study = lo.sensitivity(lo.load_scenario("table5"))
effort = study.figures["effort human"]

# %%
# ``change`` is the largest change, up to 1 cm, 1 kg or 0.1 s, within which what it does is in proportion.

names, shares = [], []
for one in study.sensitivities:
    names.append(f"{one.parameter.name}\n+{one.change:.2g} {one.parameter.unit}")
    shares.append(100 * one.slopes["effort human"] * one.change / effort)
    print(f"{one.parameter.name:20} {shares[-1]:+.2f} % of the person's effort")

figure, axes = plt.subplots(figsize=(7, 0.5 * len(names) + 1), layout="constrained")
axes.barh(names, shares)
axes.invert_yaxis()
axes.set(xlabel="change of the person's effort [%]")
axes.tick_params(axis="y", labelsize=8)
plt.show()
