"""
Hands that transmit moments
===========================

In the paper a grasp is a force at a point. A real hand also holds against turning. With ``grasp = "wrench"`` it
may, up to ``max_grasp_moment``, and it stays near its natural hold.
"""

import matplotlib.pyplot as plt

import liftopt as lo

wrench = {"human.grasp": "wrench", "robot.grasp": "wrench"}
solutions = {
    "point": lo.solve(lo.load_scenario("table5_paper")),
    "wrench": lo.solve(lo.load_scenario("table5_paper", wrench)),
}

figure, (force, moment) = plt.subplots(2, 1, figsize=(7, 5), sharex=True, layout="constrained")
for name, solution in solutions.items():
    data = solution.to_xarray()
    force.plot(data.time, data.grasp_force.sel(grasp="human", xyz="z"), label=f"{name} grasp")
    moment.plot(data.time, (data.grasp_moment.sel(grasp="human") ** 2).sum("xyz") ** 0.5)
    print(f"{name}: {solution.status}, objective {solution.objective:.0f}")
force.set(ylabel="force upwards [N]", title="the person's hand")
moment.set(xlabel="time [s]", ylabel="moment [Nm]")
force.legend()
plt.show()
