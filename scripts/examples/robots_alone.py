"""
Two robots alone
================

Nobody need be a person. Two Sawyers stand opposite each other and lift a crate of 4 kg. No feet are there to count
from: ``start`` and ``end`` say where the crate itself is. Then the one on the left is tired, and its torques weigh
five times as much.
"""

import matplotlib.pyplot as plt

import liftopt as lo

pair = lo.Scenario(
    agents={
        "left": lo.Robot(model="sawyer", base={"x": 0.0, "yaw_deg": 0.0}),
        "right": lo.Robot(model="sawyer", base={"x": 1.9, "yaw_deg": 180.0}),
    },
    object=lo.Box(name="crate", mass=4.0, depth=0.5, width=0.4, height=0.25),
    task=lo.Lift(standing_distance=1.9, start={"x": 0.95, "z": 0.8}, end={"x": 0.95, "z": 1.2}),
    objective=lo.Objective(preset="paper"),
)
even = lo.solve(pair)
print(even.status)
even.picture("crate.png")

# %%
# Two of one model keep their names apart: the agent's name begins those of its joints.

print([agent.joint_names[-1] for agent in even.agents])

# %%
# Held at two points, a level crate at rest is always shared half and half. What a weight changes is the way: how the
# arms bend, and how hard they press.

spared = lo.solve(pair.replace({"left.weight": 5.0}))
figure, axes = plt.subplots(1, 2, figsize=(8, 3.5), sharey=True, layout="constrained")
for panel, lift, title in zip(axes, (even, spared), ("equal weights", "left weighs five times"), strict=True):
    for robot in lift.robots:
        panel.plot(lift.time, (robot.tau**2).sum(axis=1), label=robot.name)
    panel.set(xlabel="time [s]", title=title)
axes[0].set_ylabel("sum of squared torques [N²m²]")
axes[0].legend()
for lift in (even, spared):
    print({name: round(lift.objective_terms[name], 1) for name in pair.agents})  # efforts [N²m²s]
plt.show()
