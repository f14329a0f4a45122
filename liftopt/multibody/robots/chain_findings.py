"""What was chosen about a robot's chain where its URDF leaves a choice: base, joints that are held, units, meshes."""

from __future__ import annotations

from collections.abc import Iterator

from liftopt.errors import NO_VALUE
from liftopt.multibody.joint_units import LEVER
from liftopt.multibody.robots.chain import OTHERS, RobotChain
from liftopt.multibody.robots.data_finding import DataFinding
from liftopt.multibody.robots.description import RobotDescription
from liftopt.multibody.robots.tool import UNTURNED, likely_direction

MOST_NAMED = 6


def chain_findings(chain: RobotChain) -> Iterator[DataFinding]:
    """Give what was assumed about a chain, and what to know about it."""
    description = chain.description
    if chain.base not in description.roots:
        left = description.mass - chain.moving_mass - chain.base_body.mass
        message = f"it is bolted down; what carries it is left out, {left:.3g} kg"
        yield DataFinding("base.inner", "assumed", f"base {chain.base}", NO_VALUE, message, "say base for another one")
    free = {joint.name: joint for joint in description.joints}
    moving = {joint.name for joint in chain.joints}
    following = {name for name in chain.held if (mimic := free[name].mimic) is not None and mimic.joint in moving}
    for name in sorted(following):
        message = f"it follows {free[name].mimic.joint}, which moves; here it stays"  # type: ignore[union-attr]
        yield DataFinding("mimic.beside", "warned", f"joint {name}", chain.held[name], message,
                          f"say locked.{name} for another position")  # fmt: skip
    held = [name for name in chain.held if name not in following]
    if held:
        named = ", ".join(f"{name} at {chain.held[name]:.3g}" for name in held[:MOST_NAMED])
        more = f" and {len(held) - MOST_NAMED} more" if len(held) > MOST_NAMED else ""
        yield DataFinding("joints.held", "assumed", "joints that are held", len(held), named + more,
                          "say locked.JOINT for other positions")  # fmt: skip
    if (direction := likely_direction(chain.T_last_grasp)) != UNTURNED:
        message = f"a hand there points along its {direction}, away from the joint before it"
        yield DataFinding("tool.direction", "assumed", f"grasp_frame {chain.grasp_frame}", NO_VALUE, message,
                          "say tool.direction for another axis")  # fmt: skip
    for joint in chain.joints:
        if joint.kind == "prismatic":
            message = f"it slides: 1 N counts as {LEVER:g} Nm in preset paper; in natural shares of limits count"
            yield DataFinding("joint.prismatic", "assumed", f"joint {joint.name}", NO_VALUE, message,
                              f"say joint_weights.{joint.name} for another weight, or lock it")  # fmt: skip
    for joint in description.joints:
        if joint.kind in OTHERS and joint.name in chain.held:
            message = f"a {joint.kind} joint beside the chain; it stays at zero"
            yield DataFinding("joint.free", "assumed", f"joint {joint.name}", NO_VALUE, message,
                              "make it fixed for another place")  # fmt: skip


def mesh_findings(description: RobotDescription) -> Iterator[DataFinding]:
    """Give the meshes that were not found; they are drawn as plain shapes."""
    lost = [mesh.address for link in description.links for mesh in link.meshes if mesh.path is None]
    if lost:
        yield DataFinding("meshes.missing", "warned", "meshes", len(lost), f"not found, the first is {lost[0]}",
                          "put their package above the URDF or in ROS_PACKAGE_PATH; plain shapes do too")  # fmt: skip
