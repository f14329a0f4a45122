"""
Weights
=======

The optimum is what the weights make it. A weight on the grasp forces calms hands that pull against each
other; a weight on the person's torques moves work to the robot.
"""

import matplotlib.pyplot as plt

import liftopt as lo

base = lo.load_scenario("table5")
variants = {
    "the paper's": {},
    "forces weigh 1": {"objective.force_weight": 1.0},
    "person weighs 10": {"human.weight": 10.0, "robot.weight": 0.1},
}

figure, axes = plt.subplots(figsize=(7, 3.5), layout="constrained")
for name, changes in variants.items():
    solution = lo.solve(base.replace(changes))
    terms = solution.objective_terms
    print(f"{name:17} person {terms['human']:6.1f}  robot {terms['robot']:6.1f}  forces {terms['force']:6.0f}")
    data = solution.to_xarray()
    size = (data.grasp_force.sel(grasp="human") ** 2).sum("xyz") ** 0.5
    axes.plot(data.time, size, label=name)
axes.set(xlabel="time [s]", ylabel="force of the person's hand [N]", ylim=(0, None))
axes.legend()
plt.show()
