"""
Another object
==============

A box instead of the table: shorter, thicker, and heavier from lift to lift.
"""

import matplotlib.pyplot as plt

import liftopt as lo

box = lo.load_scenario("table5", {"object.depth": 0.4, "object.width": 0.3, "object.height": 0.2, "duration": 2.5})
masses = (1.0, 2.0, 4.0, 6.0)
solutions = [lo.solve(box.replace({"object.mass": mass})) for mass in masses]
for mass, solution in zip(masses, solutions, strict=True):
    print(f"{mass:g} kg: {solution.status}, objective {solution.objective:.0f}")

# %%
# The largest force of each hand rises with the mass.

figure, axes = plt.subplots(figsize=(6, 3.5), layout="constrained")
for name in ("human", "robot"):
    peaks = [(solution[name].load ** 2).sum(axis=1).max() ** 0.5 for solution in solutions]
    axes.plot(masses, peaks, "o-", label=name)
axes.set(xlabel="mass of the box [kg]", ylabel="largest grasp force [N]", ylim=(0, None))
axes.legend()
plt.show()
