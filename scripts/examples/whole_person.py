"""
A person with legs
==================

``body = "whole"`` gives a person legs and both arms. A man lifts a box of 15 kg from the floor by its handles, alone.
How does he bend, how does he stand, and what does it ask of his back?
"""

import matplotlib.pyplot as plt
import numpy as np

import liftopt as lo

scenario = lo.load_scenario("floor_box")
solution = lo.solve(scenario)
print(solution.status)
solution.picture("floor_box.png")

# %%
# Knees and hips bend and straighten; the trunk comes up with them.

man, time = solution["human"], solution.time
joints = {"knee": "human_knee", "hip": "human_hip", "ankle": "human_ankle", "spine": "human_Q2"}
figure, axes = plt.subplots(figsize=(7, 3.5), layout="constrained")
for label, joint in joints.items():
    axes.plot(time, np.degrees(man.q[:, man.joint_names.index(joint)]), label=label)
axes.set(xlabel="time [s]", ylabel="flexion [deg]")
axes.legend()
plt.show()

# %%
# He stands on both feet: the centre of pressure moves between heels and toes and stays within the soles. The assessment
# says how near it comes to their edge, how the lift begins and ends, and what the discs of the lower back bear.

for finding in solution.assessment.about("person"):
    if finding.code in ("person.balance", "person.lifting_style", "person.spine_compression"):
        print(finding.message)
