"""
Weights
=======

The optimum is what the weights make it. ``table5`` asks for a natural motion. ``table5_paper`` weighs the torques of
person and robot alike, as the paper does: then the robot's torques shape the person's motion. A weight on the grasp
forces calms hands that pull against each other.
"""

import matplotlib.pyplot as plt
import numpy as np

import liftopt as lo

paper = lo.load_scenario("table5_paper")
variants = {
    "natural": lo.load_scenario("table5"),
    "the paper's": paper,
    "the paper's, forces weigh 1": paper.replace({"objective.force_weight": 1.0}),
}

figure, axes = plt.subplots(figsize=(7, 3.5), layout="constrained")
for name, scenario in variants.items():
    solution = lo.solve(scenario)
    data = solution.to_xarray()
    size = (data.grasp_force.sel(grasp="human") ** 2).sum("xyz") ** 0.5
    wrist = np.degrees(data.human_q.sel(human_joint="human_Q9"))
    print(f"{name:28} hand {float(size.max()):5.1f} N at most, wrist {wrist.min():4.0f} to {wrist.max():3.0f} deg")
    axes.plot(data.time, size, label=name)
axes.set(xlabel="time [s]", ylabel="force of the person's hand [N]", ylim=(0, None))
axes.legend()
plt.show()
