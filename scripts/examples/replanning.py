"""
Replanning
==========

The table is heavier than thought. From the last optimum a new plan takes a few iterations. It is verified when it is
asked.
"""

import time

import matplotlib.pyplot as plt

import liftopt as lo

scenario = lo.load_scenario("table5")
replanner = lo.Replanner()
first = replanner.solve(scenario)
print(first.status, f"{first.iterations} iterations")

figure, axes = plt.subplots(figsize=(7, 3.5), layout="constrained")
axes.plot(first.time, first["robot"].load[:, 2], label=f"{scenario.object.mass:g} kg")
for mass in (2.2, 2.4, 2.6):
    began = time.perf_counter()
    plan = replanner.replan(scenario.replace({"object.mass": mass}))
    took = time.perf_counter() - began
    if plan is None:
        print(f"{mass:g} kg: no plan from there, solve anew")
        continue
    print(f"{mass:g} kg: {plan.result.iterations} iterations, {1e3 * took:.0f} ms, solved: {plan.solved}")
    robot = next(agent for agent in plan.at(first.time).agents if agent.name == "robot")
    axes.plot(first.time, robot.load[:, 2], label=f"{mass:g} kg")
axes.set(xlabel="time [s]", ylabel="the robot's force upwards [N]")
axes.legend()
plt.show()
