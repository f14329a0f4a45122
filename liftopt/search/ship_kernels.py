"""The shipped models' kernels compiled into a folder when a wheel is built.

The command is ``python -m liftopt.search.ship_kernels FOLDER [--every-processor]``.

A kernel is parametric in subject, tool and object, of a whole body in its place and its hands' hold, of a serial arm in
all but the kinds of its joints, so these few serve nearly every scenario. Installed with the package they save a user
the wait at the first solve, and the need for a compiler.
"""

from __future__ import annotations

import argparse
import os
import platform
import sys
from collections.abc import Iterator, Sequence
from typing import Any, get_args

import numpy as np
import pinocchio as pin

from liftopt.collocation.arm_dynamics import ArmTopology, arm_functions
from liftopt.collocation.arm_poses import ArmPoseTopology, arm_pose_functions
from liftopt.collocation.codegen.kernels import Builder, load_kernels
from liftopt.collocation.codegen.simd_kernels import PROCESSORS, load_simd_kernels
from liftopt.collocation.dynamics import Topology, object_functions
from liftopt.collocation.problem import Team, kernel_requests
from liftopt.collocation.standing_place import held_anywhere
from liftopt.multibody.table import lifted_table
from liftopt.scenario.agent_fields import GRASPS
from liftopt.scenario.build import agents_of, object_of
from liftopt.scenario.model import load_scenario
from liftopt.search.team_solids import TeamSolids

Request = tuple[Builder, Topology]
MOST_GRASPS = 4  # two people, both hands; an object with more compiles its small kernel when it is first solved
# Joints of serial arms from the base on, R for one that turns and P for one that slides: those of all robots that are
# known by name, of arms with eight joints, and of six on a column.
ARMS = ("RRRRR", "RRRRRR", "RRRRRRR", "RRRRRRRR", "PRRRRRR", "PRRRRRRR")
AT_ONCE = 2  # whose kernels are compiled side by side


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
    """Give what to generate kernels from, a team at a time: of one arm each, of a whole body, and of serial arms.

    The whole body comes without and with a limit on its spine.
    """
    for grasp in get_args(GRASPS):
        yield _of_team(f"human.grasp={grasp}", f"robot.grasp={grasp}")
    yield _of_team("human.body=whole")
    yield _of_team("human.body=whole", "limits.spine_compression=3400")
    scenario = load_scenario(changes=["human.body=whole"])
    agents = agents_of(scenario)
    for count in range(1, MOST_GRASPS + 1):
        # Each grasp has a frame of its own: one frame in two places would give both the same place in the kernel.
        points = {f"hand_{n}": (0.0, 0.0, 0.0) for n in range(count)}
        held = lifted_table(mass=1.0, depth=0.3, width=0.4, height=0.2, grasps=points)
        yield kernel_requests(agents, held)[-1:]
        if count > 1:  # one point alone holds nothing
            yield [(object_functions, held_anywhere(Topology.of(held.model, held.grasp_frames)))]
    for first in range(0, len(ARMS), AT_ONCE):
        yield [request for kinds in ARMS[first : first + AT_ONCE] for request in arm_requests(kinds)]


def arm_requests(kinds: str) -> list[Request]:
    """Return what to generate all kernels of serial arms from that have these joints, R or P each."""
    arm, joint = pin.Model(), 0
    for number, kind in enumerate(kinds):
        moving = pin.JointModelRZ() if kind == "R" else pin.JointModelPZ()
        joint = arm.addJoint(joint, moving, pin.SE3.Identity(), str(number))
    arm.addFrame(pin.Frame("hand", joint, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME))
    found: list[tuple[Any, Topology]] = [
        (arm_functions, ArmTopology.holding(arm, "hand", np.eye(3))),
        (arm_pose_functions, ArmPoseTopology.of_links(arm)),
    ]
    return found


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
