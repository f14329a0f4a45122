"""
Person against robot
====================

What does the person gain where the robot works more? ``liftopt pareto`` solves the lift for many ratios of the two
weights and keeps what no other compromise beats in both efforts.
"""

import json
import subprocess
import sys
import tempfile

import matplotlib.pyplot as plt

with tempfile.TemporaryDirectory() as folder:
    command = [sys.executable, "-m", "liftopt", "pareto", "table5", "--points", "7", "--out", folder, "--json"]
    front = json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
person, robot = ([point[f"{who}_effort_N2m2s"] for point in front["points"]] for who in ("human", "robot"))
for point in front["points"]:
    ratio = point["human_weight"] / point["robot_weight"]
    print(f"weights {ratio:7.3g} : 1, the person carries {100 * point['human_load_share']:.0f} % of the load")

figure, axes = plt.subplots(figsize=(6, 4), layout="constrained")
axes.loglog(person, robot, "o-")
axes.set(xlabel="effort of the person [N²m²s]", ylabel="effort of the robot [N²m²s]")
plt.show()
