"""
Person against robot
====================

What does the person gain where the robot works more? The lift is solved for several ratios of the two weights; what no
other compromise beats in both efforts is the front. Effort is the integral of squared shares of the joints' limits.
"""

import matplotlib.pyplot as plt

import liftopt as lo

front = lo.pareto_front(lo.load_scenario("table5"), count=5)
for point in front.points:
    person, robot = point.weights
    print(f"weights {person / robot:5.3g} : 1, the person carries {100 * point.share:.0f} % of the load")

figure, axes = plt.subplots(figsize=(6, 4), layout="constrained")
axes.loglog(*zip(*(point.efforts for point in front.points), strict=True), "o-")
axes.set(xlabel="effort of the person [s]", ylabel="effort of the robot [s]")
plt.show()
