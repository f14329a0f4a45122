"""The shipped models' kernels compiled into a folder when a wheel is built.

The command is ``python -m liftopt.search.ship_kernels FOLDER [--every-processor]``.

A kernel is parametric in subject, tool and object, so these few serve every scenario. Installed with the package they
save a user the wait at the first solve, and the need for a compiler.
"""

from __future__ import annotations

import argparse
import os
import platform
import sys
from collections.abc import Sequence
from typing import get_args

from liftopt.collocation.codegen.simd_kernels import PROCESSORS, load_simd_kernels
from liftopt.collocation.problem import Team, kernel_requests
from liftopt.scenario.agents import GRASPS
from liftopt.scenario.build import agents_of, object_of
from liftopt.scenario.model import load_scenario
from liftopt.search.team_solids import TeamSolids


def ship(folder: str, every_processor: bool = False) -> bool:
    """Compile the kernels into a folder and return whether all are there.

    Args:
        folder: for the kernels that are not installed with the package.
        every_processor: compile for all of the kind of this one, so that the wheel serves other machines too.
    """
    os.environ["LIFTOPT_CACHE"] = folder
    processors = PROCESSORS if every_processor and platform.machine() == "x86_64" else (None,)
    whole = True
    for grasp in get_args(GRASPS):
        scenario = load_scenario(changes=[f"human.grasp={grasp}", f"robot.grasp={grasp}"])
        team = Team.of(agents_of(scenario), object_of(scenario), _print)
        poses = TeamSolids.of(team, (), _print).parts
        whole = whole and all(kernel.compiled for kernel in (*team.kernels, *(pose.kernel for pose in poses)))
        requests = kernel_requests(team.agents, team.object) + [(pose.builder, pose.topology) for pose in poses]
        for extensions in processors:
            simd = load_simd_kernels(requests, _print, extensions)
            whole = whole and simd is not None
    return whole


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
