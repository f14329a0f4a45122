"""
Two readings of Table 5
=======================

The paper's Table 5 leaves open where the robot's base is measured. ``table5`` takes 1.9 m, with a gripper;
``table5_near`` takes 1.7 m.
"""

import matplotlib.pyplot as plt

import liftopt as lo

solutions = {name: lo.solve(lo.load_scenario(name)) for name in ("table5", "table5_near")}

figure, (path, load) = plt.subplots(1, 2, figsize=(8, 3.5), layout="constrained")
for name, solution in solutions.items():
    data = solution.to_xarray()
    hand = data.grasp_position.sel(grasp="human")
    path.plot(hand.sel(xyz="x"), hand.sel(xyz="z"), label=name)
    up = data.grasp_force.sel(xyz="z")
    load.plot(data.time, 100 * up.sel(grasp="human") / up.sum("grasp"), label=name)
    print(f"{name}: {solution.status}, objective {solution.objective:.0f}")
path.set(xlabel="ahead of the feet [m]", ylabel="height [m]", title="path of the hand", aspect="equal")
load.set(xlabel="time [s]", ylabel="[%]", title="the person's share of the load")
load.legend()
plt.show()
