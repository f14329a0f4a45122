"""
The default lift
================

A man of 1.75 m and a Sawyer robot raise a table of 2 kg from 0.9 to 1.4 m in two seconds. Who carries how much, and
what do the joints of the person do?
"""

import matplotlib.pyplot as plt
import numpy as np

import liftopt as lo

solution = lo.solve(lo.load_scenario("table5"))
print(solution.status, f"objective {solution.objective:.1f}")
for finding in solution.assessment:
    if finding.severity in ("error", "warning"):
        print(finding.message)

# %%
# ``picture`` draws everybody at one moment or several, here at the start, in the middle and at the end.

solution.picture("lift.png")

# %%
# ``to_xarray`` gives all curves with their names and units, the same as in ``solution.nc``.

data = solution.to_xarray()
print(data.human_tau.dims, data.human_tau.attrs["units"])

figure, (force, angle) = plt.subplots(2, 1, figsize=(7, 5), sharex=True, layout="constrained")
data.grasp_force.sel(xyz="z").plot.line(x="time", ax=force)
force.set(title="", xlabel="", ylabel="force upwards on the table [N]")
for joint in ("human_Q5", "human_Q7"):
    angle.plot(data.time, np.degrees(data.human_q.sel(human_joint=joint)), label=joint)
angle.set(xlabel="time [s]", ylabel="angle [deg]")
angle.legend()
plt.show()
