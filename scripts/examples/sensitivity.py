"""
What the answer depends on
==========================

``liftopt sensitivity`` solves the lift again with one thing after the other a little changed, up and down, while
everybody plans anew. Here its JSON is read and drawn.
"""

import json
import subprocess
import sys

import matplotlib.pyplot as plt

command = [sys.executable, "-m", "liftopt", "sensitivity", "table5", "--json"]
found = json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
effort = found["figures"]["effort human"]
names, shares = [], []
for parameter in found["parameters"]:
    change = parameter["change"]  # the largest one within which what it does is in proportion
    names.append(f"{parameter['name']}\n+{change:.2g} {parameter['unit']}")
    shares.append(100 * parameter["slopes"]["effort human"] * change / effort)
    print(f"{parameter['name']:20} {shares[-1]:+.2f} % of the person's effort")

figure, axes = plt.subplots(figsize=(7, 0.5 * len(names) + 1), layout="constrained")
axes.barh(names, shares)
axes.invert_yaxis()
axes.set(xlabel="change of the person's effort [%]")
axes.tick_params(axis="y", labelsize=8)
plt.show()
