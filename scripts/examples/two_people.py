"""
Two people
==========

A scenario names whoever lifts. Anna and Ben carry a box of 6 kg between them; Ben stands opposite, because nothing
else is said of him. Who carries more?
"""

import matplotlib.pyplot as plt

import liftopt as lo

pair = lo.Scenario(
    agents={
        "anna": lo.Person(stature=1.65, mass=62.0, sex="female"),
        "ben": lo.Person(stature=1.85, mass=85.0, sex="male"),
    },
    object=lo.Box(name="box", mass=6.0, depth=0.5, width=0.35, height=0.25),
    task=lo.Lift(
        standing_distance=1.35,
        start={"height": 0.8, "human_distance": 0.4},
        end={"height": 1.2, "human_distance": 0.4},
    ),
    objective=lo.Objective(preset="paper"),
)
solution = lo.solve(pair)
print(solution.status)
for person in solution.persons:
    print(person.name, f"{person.load[:, 2].mean():.1f} N upwards on average")
solution.picture("box.png")

# %%
# The weights say whose effort counts: ten times the weight on Anna's torques.

spared = lo.solve(pair.replace({"anna.weight": 10.0}))
for lift in (solution, spared):
    print({name: round(lift.objective_terms[name], 1) for name in pair.agents})  # efforts [N²m²s]

figure, axes = plt.subplots(figsize=(7, 3.5), layout="constrained")
for lift, line in ((solution, "-"), (spared, "--")):
    data = lift.to_xarray()
    up = data.grasp_force.sel(xyz="z")
    weight = lift.scenario.agents["anna"].weight
    axes.plot(data.time, 100 * up.sel(grasp="anna") / up.sum("grasp"), line, label=f"Anna's weight {weight:g}")
axes.set(xlabel="time [s]", ylabel="Anna's share of the load [%]")
axes.legend()
plt.show()
