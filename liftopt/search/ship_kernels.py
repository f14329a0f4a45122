"""The shipped models' kernels compiled into a folder when a wheel is built.

The command is ``python -m liftopt.search.ship_kernels FOLDER [--every-processor]``.

A kernel is parametric in subject, tool and object, and of a whole body in its place and its hands' hold, so these few
serve every scenario. Installed with the package they
save a user the wait at the first solve, and the need for a compiler.
"""

from __future__ import annotations

import argparse
import os
import platform
import sys
from collections.abc import Iterator, Sequence
from typing import get_args

from liftopt.collocation.codegen.kernels import Builder, load_kernels
from liftopt.collocation.codegen.simd_kernels import PROCESSORS, load_simd_kernels
from liftopt.collocation.dynamics import Topology
from liftopt.collocation.problem import Team, kernel_requests
from liftopt.multibody.table import lifted_table
from liftopt.scenario.agent_fields import GRASPS
from liftopt.scenario.build import agents_of, object_of
from liftopt.scenario.model import load_scenario
from liftopt.search.team_solids import TeamSolids

Request = tuple[Builder, Topology]
MOST_GRASPS = 4  # two people, both hands; an object with more compiles its small kernel when it is first solved


def ship(folder: str, every_processor: bool = False) -> bool:
    """Compile the kernels into a folder and return whether all are there.

    Args:
        folder: for the kernels that are not installed with the package.
        every_processor: compile for all of the kind of this one, so that the wheel serves other machines too.
    """
    os.environ["LIFTOPT_CACHE"] = folder
    processors = PROCESSORS if every_processor and platform.machine() == "x86_64" else (None,)
    whole = True
    for requests in shipped_requests():
        whole = all(kernel.compiled for kernel in load_kernels(requests, _print)) and whole
        for extensions in processors:
            whole = load_simd_kernels(requests, _print, extensions) is not None and whole
    return whole


def shipped_requests() -> Iterator[list[Request]]:
    """Give what to generate kernels from, a team at a time: of one arm each, and of a whole body with an object."""
    for grasp in get_args(GRASPS):
        yield _of_team(f"human.grasp={grasp}", f"robot.grasp={grasp}")
    yield _of_team("human.body=whole")
    scenario = load_scenario(changes=["human.body=whole"])
    agents = agents_of(scenario)
    for count in range(1, MOST_GRASPS + 1):
        # Each grasp has a frame of its own: one frame in two places would give both the same place in the kernel.
        points = {f"hand_{n}": (0.0, 0.0, 0.0) for n in range(count)}
        held = lifted_table(mass=1.0, depth=0.3, width=0.4, height=0.2, grasps=points)
        yield kernel_requests(agents, held)[-1:]


def _of_team(*changes: str) -> list[Request]:
    scenario = load_scenario(changes=changes)
    team = Team.of(agents_of(scenario), object_of(scenario), _print)
    poses = TeamSolids.of(team, (), _print).parts
    return [*kernel_requests(team.agents, team.object), *((pose.builder, pose.topology) for pose in poses)]


def main(arguments: Sequence[str]) -> int:
    """Run the command; its exit status is 1 where a kernel is missing."""
    parser = argparse.ArgumentParser(description="Compile the kernels of the shipped models.")
    parser.add_argument("folder", help="that takes them")
    parser.add_argument("--every-processor", action="store_true", help="not only for the vectors of this one")
    args = parser.parse_args(arguments)
    return 0 if ship(args.folder, args.every_processor) else 1


def _print(line: str) -> None:
    print(line, flush=True)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
