"""
Who lifts
=========

A small woman, an average man and a tall man do the same task. Whose joints come nearest to their strength?
"""

import matplotlib.pyplot as plt
import numpy as np

import liftopt as lo

people = {
    "woman, 1.60 m": {"human.stature": 1.60, "human.mass": 58.0, "human.sex": "female"},
    "man, 1.75 m": {"human.stature": 1.75, "human.mass": 75.0, "human.sex": "male"},
    "man, 1.90 m": {"human.stature": 1.90, "human.mass": 90.0, "human.sex": "male"},
}
base = lo.load_scenario("table5", {"object.mass": 3.0})
solutions = {who: lo.solve(base.replace(changes)) for who, changes in people.items()}

# %%
# Torque over the limit in its direction, joint by joint, at its largest.

figure, axes = plt.subplots(figsize=(7, 3.5), layout="constrained")
for column, (who, solution) in enumerate(solutions.items()):
    person = solution["human"]
    tau = person.tau[:, person.moving]
    share = np.where(tau > 0, tau / person.limits.tau_upper, tau / person.limits.tau_lower).max(axis=0)
    axes.bar(np.arange(len(share)) + 0.27 * (column - 1), 100 * share, width=0.25, label=who)
    print(f"{who}: {solution.status}, at most {100 * share.max():.0f} % of strength")
axes.set_xticks(range(len(share)), [name.removeprefix("human_") for name in person.moving_joints])
axes.set(ylabel="strength used [%]")
axes.legend()
plt.show()
