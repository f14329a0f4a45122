"""Show that nothing goes through anything: lifts of boxes of 0.2 to 0.6 m, near and far, with pallets and shelves.

``python scripts/check_clearance.py --count 60`` solves each with ``limits.clearance`` off and at 0 and prints a table:
how deep bodies overlap, what keeping them apart costs in the objective and in processor time, and where it
cannot be done, which bodies are in the way. Depths are measured here, by coal on the solution's own trajectories at
times that no solver saw. The exit status is 1 where a solved lift overlaps by more than 1 mm, or a lift that is solved
without clearance is neither solved with it nor explained by two bodies.
"""

from __future__ import annotations

import argparse
import sys
import time
from dataclasses import dataclass
from typing import Any

import coal
import numpy as np
import pinocchio as pin

from liftopt.multibody.solid_pairs import SolidPair, solid_pairs
from liftopt.multibody.solids import Solid
from liftopt.scenario.build import obstacles_of
from liftopt.scenario.model import Scenario, load_scenario
from liftopt.search.cache import SolverCache
from liftopt.search.candidate import Candidate
from liftopt.search.session import Session
from liftopt.search.solve import find_lift

DEEPEST = 1e-3  # [m]
TIMES = 317  # at which it is looked; no multiple of a mesh's intervals
READINGS = ("table5", "table5_near", "table5_free")


@dataclass(frozen=True)
class Row:
    """What came of one scenario."""

    number: int
    what: str
    free_depth: float
    free_objective: float
    solved: bool
    depth: float
    pair: str
    objective: float
    seconds: tuple[float, float]
    reason: str

    @property
    def passed(self) -> bool:
        """Whether it is clear, or explained, or was impossible anyway."""
        if self.solved:
            return self.depth >= -DEEPEST
        return bool(self.reason) or np.isnan(self.free_objective)


def scenarios(count: int, seed: int) -> list[tuple[str, Scenario]]:
    """Return scenarios with a word on each."""
    rng, made = np.random.default_rng(seed), []
    for n in range(count):
        name = READINGS[n % 3]
        edges = rng.uniform(0.2, 0.6, 3).round(2)
        near = bool(n % 2)
        start, end = round(rng.uniform(0.75, 1.0), 2), round(rng.uniform(1.1, 1.45), 2)
        changes: dict[str, Any] = {
            "object.depth": float(edges[0]), "object.width": float(edges[1]), "object.height": float(edges[2]),
            "object.mass": round(rng.uniform(1.0, 6.0), 1), "duration": float(rng.choice([1.5, 2.0, 3.0])),
            "task.start.height": start, "task.end.height": end,
            "human.stature": round(rng.uniform(1.6, 1.9), 2),
        }  # fmt: skip
        if name != "table5_free":
            ahead = round(rng.uniform(0.2, 0.32), 2) if near else 0.4
            changes |= {"task.start.human_distance": ahead, "task.end.human_distance": ahead}
            changes["task.standing_distance"] = round(ahead + float(edges[0]) + (1.05 if name == "table5" else 0.85), 2)
        kind = ("none", "pallet", "shelf", "wall", "none", "post")[n % 6]
        changes["obstacles"] = _obstacles(kind, changes, rng)
        made.append((f"{name}, {'x'.join(map(str, edges))}, {'near' if near else 'far'}, {kind}",
                     load_scenario(name).replace(changes)))  # fmt: skip
    return made


def _obstacles(kind: str, changes: dict[str, Any], rng: np.random.Generator) -> list[dict[str, Any]]:
    """Return what stands around: under the start, above the end, beside the object, or beside the person."""
    ahead = changes.get("task.start.human_distance", 0.45) + changes["object.depth"] / 2
    wide, high = changes["object.width"], changes["task.end.height"] + changes["object.height"]
    side = float(rng.choice([-1.0, 1.0]))
    boxes = {
        "none": None,
        "pallet": ([0.2, 0.2, changes["task.start.height"]], [ahead, 0.0, 0.0]),
        "shelf": ([0.5, 1.2, 0.03], [ahead, 0.0, high + 0.05]),
        "wall": ([1.5, 0.05, 2.0], [ahead, side * (wide / 2 + 0.25), 0.0]),
        "post": ([0.08, 0.08, 2.0], [0.25, side * 0.35, 0.0]),
    }
    found = boxes[kind]
    if found is None:
        return []
    size, place = ([round(float(v), 3) for v in values] for values in found)
    place[2] += size[2] / 2  # from its underside to its centre
    return [{"name": kind, "box": size, "position": place}]


def solve(scenario: Scenario) -> tuple[Candidate, tuple[Any, ...], float]:
    """Return the best candidate, why it is no lift, and the processor time of the search [s]."""
    session = Session(scenario, SolverCache())
    began = time.process_time()
    found = find_lift(session)
    return found.best, found.reasons, time.process_time() - began


def deepest(candidate: Candidate) -> tuple[float, str]:
    """Return the least distance of all pairs [m], by coal, and of which."""
    team, scenario = candidate.problem.team, candidate.scenario
    motion = candidate.at(np.linspace(0.0, scenario.duration, TIMES))
    places: dict[str, list[list[np.ndarray]]] = {}
    for agent, moved in zip(team.agents, motion.agents, strict=True):
        model = agent.reduced()
        data = model.createData()
        places[agent.name] = []
        for q in moved.q[:, moved.moving]:
            pin.forwardKinematics(model, data, q)
            places[agent.name].append([pose.homogeneous for pose in data.oMi])
    boxes = []
    for x in motion.object.pose:
        rotation = np.linalg.multi_dot([pin.exp3(angle * axis) for angle, axis in zip(x[3:], np.eye(3), strict=True)])
        boxes.append([np.eye(4), pin.SE3(rotation, x[:3]).homogeneous])
    places[team.object.name] = boxes
    worst, told = np.inf, ""
    for pair in solid_pairs(team.agents, team.object, obstacles_of(scenario)):
        for k in range(TIMES):
            apart = _distance(pair, places, k, worst)
            if apart < worst:
                worst, told = apart, pair.told
    return worst, told


def _distance(pair: SolidPair, places: dict[str, list[list[np.ndarray]]], k: int, bound: float) -> float:
    """Return the signed distance of a pair at a time, or something above ``bound`` where it is surely more."""
    placed = []
    for solid in (pair.one, pair.other):
        joints = places.get(solid.owner)
        T_world_joint = joints[k][solid.joint] if joints else np.eye(4)
        placed.append(T_world_joint @ solid.T_joint_solid)
    if pair.other.kind != "half-space":
        reach = sum(_reach(solid) for solid in (pair.one, pair.other))
        if np.linalg.norm(placed[0][:3, 3] - placed[1][:3, 3]) - reach > bound:
            return np.inf
    shapes = [_shape(solid) for solid in (pair.one, pair.other)]
    transforms = [coal.Transform3s(T[:3, :3], T[:3, 3]) for T in placed]
    request, result = coal.DistanceRequest(), coal.DistanceResult()
    return float(coal.distance(shapes[0], transforms[0], shapes[1], transforms[1], request, result))


def _reach(solid: Solid) -> float:
    return float(np.linalg.norm(solid.size)) / 2 if solid.kind == "box" else solid.size[0] + solid.size[1] / 2


def _shape(solid: Solid) -> Any:
    if solid.kind == "half-space":
        return coal.Halfspace(np.array([0.0, 0.0, 1.0]), 0.0)
    return coal.Box(*solid.size) if solid.kind == "box" else coal.Capsule(*solid.size)


def examine(number: int, what: str, scenario: Scenario) -> Row:
    """Solve a scenario without and with clearance."""
    limited = {"solver.time_limit": 600.0}
    free, _, free_seconds = solve(scenario.replace({**limited, "limits.clearance": "off"}))
    kept, reasons, seconds = solve(scenario.replace({**limited, "limits.clearance": 0.0}))
    depth, pair = deepest(kept) if kept.solved else (np.nan, "")
    reason = "; ".join(r.message for r in reasons if r.constraint == "clearance")
    return Row(
        number, what, deepest(free)[0] if free.solved else np.nan, free.result.objective if free.solved else np.nan,
        kept.solved, depth, pair, kept.result.objective, (free_seconds, seconds), reason,
    )  # fmt: skip


def main() -> int:
    """Run the command."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=60, help="scenarios")
    parser.add_argument("--seed", type=int, default=0, help="of what is random in them")
    parser.add_argument("--only", type=int, nargs="*", help="numbers of those to solve; all by default")
    args = parser.parse_args()
    print("| # | lift | off: depth [mm] | kept: depth [mm] | J more [%] | processor time, times | what is in the way |")
    print("|---|---|---|---|---|---|---|")
    rows = []
    for number, (what, scenario) in enumerate(scenarios(args.count, args.seed)):
        if args.only and number not in args.only:
            continue
        row = examine(number, what, scenario)
        rows.append(row)
        more, times = 100 * (row.objective / row.free_objective - 1), row.seconds[1] / row.seconds[0]
        kept = f"{1e3 * row.depth:.1f}" if row.solved else "none"
        mark = "" if row.passed else " **fails**"
        print(f"| {number} | {what} | {1e3 * row.free_depth:.0f} | {kept} | {more:.1f} | {times:.2f} | "
              f"{row.reason or row.pair}{mark} |", flush=True)  # fmt: skip
    both = [row for row in rows if row.solved and not np.isnan(row.free_objective)]
    ratio = [row.seconds[1] / row.seconds[0] for row in both]
    print(f"\n{len(rows)} lifts; solved without clearance {sum(not np.isnan(r.free_objective) for r in rows)}, with it "
          f"{sum(r.solved for r in rows)}; deepest {1e3 * min((r.depth for r in both), default=np.nan):.2f} mm; "
          f"processor time median {np.median(ratio):.2f}, most {max(ratio, default=np.nan):.2f} times; "
          f"{sum(not r.passed for r in rows)} fail")  # fmt: skip
    return 0 if all(row.passed for row in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
