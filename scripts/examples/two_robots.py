"""
A person and two robots
=======================

Two Sawyers hold the far corners of a board of 8 kg, a person the middle of the near edge. Each agent's place on the
board stands in ``grasps``, in the board's axes from its centre.
"""

import matplotlib.pyplot as plt

import liftopt as lo

team = lo.Scenario(
    agents={
        "human": lo.Person(stature=1.75, mass=75.0, sex="male"),
        "left": lo.Robot(model="sawyer", base={"x": 1.7, "y": 0.45}),
        "right": lo.Robot(model="sawyer", base={"x": 1.7, "y": -0.45}),
    },
    object=lo.Box(
        name="board",
        mass=8.0,
        depth=0.6,
        width=0.8,
        height=0.04,
        grasps={"left": (0.3, 0.3, -0.02), "right": (0.3, -0.3, -0.02)},
    ),
    task=lo.Lift(
        standing_distance=1.9,
        start={"height": 0.9, "human_distance": 0.4},
        end={"height": 1.3, "human_distance": 0.4},
    ),
    objective=lo.Objective(preset="paper"),
)
solution = lo.solve(team)
print(solution.status)
solution.picture("board.png")

# %%
# Three points that are not on a line hold the board in all six directions, so it may roll.

data = solution.to_xarray()
figure, (load, path) = plt.subplots(1, 2, figsize=(8, 3.5), layout="constrained")
for agent in solution.agents:
    load.plot(data.time, data.grasp_force.sel(grasp=agent.name, xyz="z"), label=agent.name)
    point = data.grasp_position.sel(grasp=agent.name)
    path.plot(point.sel(xyz="x"), point.sel(xyz="y"))
load.set(xlabel="time [s]", ylabel="force upwards [N]")
load.legend()
path.set(xlabel="x [m]", ylabel="y [m]", title="paths of the grasp points, from above", aspect="equal")
plt.show()
