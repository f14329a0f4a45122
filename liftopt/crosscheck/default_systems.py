"""The mechanisms of the default task (Table 5), as DH chain and as the model of its URDF; and the whole person."""

from __future__ import annotations

import numpy as np

from liftopt.crosscheck.systems import CheckedSystem
from liftopt.multibody.agent import Agent
from liftopt.multibody.dh import ROTATION_WORLD_PAPER
from liftopt.multibody.person.human import human_agent, human_chain, human_root
from liftopt.multibody.person.subject import Subject
from liftopt.multibody.person.whole_body import whole_human_agent
from liftopt.multibody.placement import facing
from liftopt.multibody.robots.sawyer import sawyer_agent, sawyer_chain, sawyer_root
from liftopt.multibody.table import lifted_table, table_chain

SUBJECT = Subject(stature=1.75, mass=75.0, sex="male")
STANDING_DISTANCE = 1.9  # m, Table 5
BASE_HEIGHT, TOOL_LENGTH, TOOL_MASS = 0.915, 0.15, 0.4  # m, m, kg
TABLE_MASS, TABLE_DEPTH, TABLE_WIDTH, TABLE_HEIGHT = 2.0, 0.45, 0.31, 0.02  # kg and m, Table 5


def default_human() -> CheckedSystem:
    """Return the default subject, who holds at the origin of the last DH frame."""
    agent = human_agent(SUBJECT)
    return CheckedSystem(human_chain(SUBJECT), agent.model, human_root(), agent.hands, np.zeros((1, 3)))


def default_whole_person() -> Agent:
    """Return the default subject with legs and two arms, who has no DH chain but a tree."""
    return whole_human_agent(SUBJECT)


def default_robot() -> CheckedSystem:
    """Return Sawyer with its gripper, which holds at the origin of the last DH frame."""
    chain = sawyer_chain(base_height=BASE_HEIGHT, tool_length=TOOL_LENGTH, tool_mass=TOOL_MASS)
    agent = sawyer_agent(
        place=facing(STANDING_DISTANCE),
        base_height=BASE_HEIGHT,
        tool_length=TOOL_LENGTH,
        tool_mass=TOOL_MASS,
    )
    root = sawyer_root(facing(STANDING_DISTANCE))
    return CheckedSystem(chain, agent.model, root, agent.hands, np.zeros((1, 3)))


def default_table() -> CheckedSystem:
    """Return the table, held at the middle of its two bottom edges; its root is the paper's frame at the origin.

    At zero the last DH frame's x, y, z are the world's -Y, -Z, X: the underside is at y = +height / 2.
    """
    chain = table_chain(mass=TABLE_MASS, depth=TABLE_DEPTH, width=TABLE_WIDTH, height=TABLE_HEIGHT)
    lifted = lifted_table(mass=TABLE_MASS, depth=TABLE_DEPTH, width=TABLE_WIDTH, height=TABLE_HEIGHT)
    root = np.eye(4)
    root[:3, :3] = ROTATION_WORLD_PAPER
    edges = np.array([[0.0, TABLE_HEIGHT, -TABLE_DEPTH], [0.0, TABLE_HEIGHT, TABLE_DEPTH]]) / 2.0
    return CheckedSystem(chain, lifted.model, root, lifted.grasp_frames, edges)
