"""The URDFs as other programs read them. Oracles: MuJoCo's inverse dynamics, yourdfpy's kinematics."""

from __future__ import annotations

import re
from io import BytesIO
from xml.etree import ElementTree

import numpy as np
import pinocchio as pin
import pytest
import yourdfpy

from liftopt.multibody.person.human import Subject, human_agent
from liftopt.multibody.placement import facing
from liftopt.multibody.robots.sawyer import sawyer_agent
from liftopt.multibody.table import lifted_table


@pytest.fixture(scope="module")
def agents():
    robot = sawyer_agent(place=facing(1.9), base_height=0.915, tool_length=0.15, tool_mass=0.4)
    return {"human": human_agent(Subject(1.63, 62.0, "female")), "robot": robot}


@pytest.mark.parametrize("name", ["human", "robot"])
def test_mujoco_agrees_on_inverse_dynamics(agents, name):
    mujoco = pytest.importorskip("mujoco")
    agent = agents[name]
    # MuJoCo refuses massless moving bodies: it is told to give them a picogram. Limits are not its concern here.
    extension = '<mujoco><compiler boundmass="1e-12" boundinertia="1e-12" discardvisual="true"/></mujoco>'
    text = agent.urdf.replace("</robot>", f"{extension}</robot>")
    theirs = mujoco.MjModel.from_xml_string(text)
    theirs.opt.gravity[:] = [0.0, 0.0, -9.81]
    theirs.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    state, data, rng = mujoco.MjData(theirs), agent.model.createData(), np.random.default_rng(2)
    assert theirs.nv == agent.model.nv
    for q, v, a in rng.uniform(-1.0, 1.0, (20, 3, agent.model.nv)):
        state.qpos[:], state.qvel[:], state.qacc[:] = q, v, a
        mujoco.mj_inverse(theirs, state)
        np.testing.assert_allclose(state.qfrc_inverse, pin.rnea(agent.model, data, q, v, a), rtol=0.0, atol=1e-6)


@pytest.mark.parametrize("name", ["human", "robot"])
def test_yourdfpy_agrees_on_kinematics(agents, name, frame_pose):
    agent = agents[name]
    loaded = yourdfpy.URDF.load(BytesIO(agent.urdf.encode()), load_meshes=False)
    q = np.random.default_rng(3).uniform(-1.0, 1.0, agent.model.nq)
    loaded.update_cfg(q)
    np.testing.assert_allclose(
        loaded.get_transform(agent.hands[0], "world"), frame_pose(agent.model, agent.hands[0], q), atol=1e-12
    )


def test_yourdfpy_finds_the_descriptions_valid_and_writes_them_the_same(agents):
    """They are written without its help: it reads them, has nothing to say, and writes what it has read."""
    table = lifted_table(mass=2.0, depth=0.45, width=0.31, height=0.02)
    for text in (agents["human"].urdf, agents["robot"].urdf, table.urdf):
        read = yourdfpy.URDF.load(BytesIO(text.encode()), load_meshes=False, build_scene_graph=False)
        assert read.validate(), read.errors
        ours, theirs = ElementTree.fromstring(text), ElementTree.fromstring(read.write_xml_string())
        for joint in theirs.findall("joint[@type='fixed']"):  # it gives them an axis all the same
            joint.remove(joint.find("axis"))
        for one, other in zip(ours.iter(), theirs.iter(), strict=True):
            assert one.tag == other.tag
            assert one.attrib.keys() == other.attrib.keys(), one.tag
            for key in one.attrib.keys() - {"rpy"}:  # one rotation has many triples of angles
                assert _values(one.get(key)) == _values(other.get(key)), (one.tag, key)
            if "rpy" in one.attrib:
                turns = [pin.rpy.rpyToMatrix(np.array(_values(item.get("rpy")))) for item in (one, other)]
                np.testing.assert_allclose(*turns, rtol=0.0, atol=1e-6)


def _values(text: str) -> list[float | str]:
    try:
        return [float(word) + 0.0 for word in text.split()]
    except ValueError:
        return [text]


@pytest.mark.parametrize("name", ["human", "robot"])
def test_contract_of_names_and_types(agents, name):
    root = ElementTree.fromstring(agents[name].urdf)
    joints = {joint.get("name"): joint for joint in root.iter("joint")}
    children = {joint.find("child").get("link") for joint in joints.values()}
    assert {link.get("name") for link in root.iter("link")} - children == {"world"}
    for joint_name, joint in joints.items():
        kind = "fixed" if joint_name.endswith("_fixed") else "prismatic" if "_GT" in joint_name else "revolute"
        assert joint.get("type") == kind
    grasp = next(link for link in root.iter("link") if link.get("name") == f"{name}_grasp")
    assert len(grasp) == 0


def test_every_body_with_mass_can_be_seen_and_touched(agents):
    table = lifted_table(mass=2.0, depth=0.45, width=0.31, height=0.02)
    for urdf in (agents["human"].urdf, agents["robot"].urdf, table.urdf):
        for link in ElementTree.fromstring(urdf).iter("link"):
            if link.find("inertial") is not None:
                assert link.find("visual") is not None, link.get("name")
                assert link.find("collision") is not None, link.get("name")


def test_collision_geometry_loads_in_pinocchio(agents):
    for agent in agents.values():
        geometry = pin.buildGeomFromUrdfString(agent.model, agent.urdf, pin.GeometryType.COLLISION)
        assert geometry.ngeoms > 10


def test_same_description_gives_the_same_bytes():
    first, second = (human_agent(Subject(1.8, 80.0, "male")).urdf for _ in range(2))
    assert first == second
    assert not re.search(r'[" ]-0\.0[" ]', first)
