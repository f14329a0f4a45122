"""What is shipped serves what is solved: the oracle is the object of a scenario itself."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from liftopt.collocation.codegen.kernels import kernel_key
from liftopt.collocation.problem import kernel_requests
from liftopt.collocation.separating_planes import pose_request
from liftopt.multibody.agent import Agent
from liftopt.multibody.robots.example_robot_data import share_folder
from liftopt.scenario.build import agents_of, object_of
from liftopt.scenario.model import load_scenario
from liftopt.search.ship_kernels import shipped_requests


@pytest.fixture(scope="module")
def shipped() -> set[str]:
    return {kernel_key(*request) for requests in shipped_requests() for request in requests}


def test_every_grasp_of_a_shipped_object_has_a_frame_of_its_own() -> None:
    # Frames of one name would be one frame in the kernel, and so at one place.
    for requests in shipped_requests():
        for _, topology in requests:
            assert len(set(topology.frames)) == len(topology.frames)


def test_the_object_of_a_person_with_two_hands_and_a_robot_is_shipped(shipped: set[str]) -> None:
    scenario = load_scenario(changes=["human.body=whole"])
    assert {kernel_key(*request) for request in kernel_requests(agents_of(scenario), object_of(scenario))} <= shipped


@pytest.mark.skipif(share_folder() is None, reason="example-robot-data is not installed (it is in 'test')")
@pytest.mark.parametrize("name", ["ur10", "panda", "tiago", "tiago_lifting", "so100", "icub_left"])
def test_an_arm_compiles_nothing_wherever_it_stands(
    name: str, known_agent: Callable[..., Agent], shipped: set[str]
) -> None:
    """Fingers that mimic each other, joints that are locked, and a tilted base; with a person, held by both."""
    place = np.asarray(pin.SE3(pin.rpy.rpyToMatrix(0.3, -1.2, 0.5), np.array([1.2, 0.1, 0.9])))
    agent = known_agent(name, T_world_base=place, tool_length=0.1, tool_mass=0.5)
    for moments in (False, True):
        held = replace(agent, grasps=tuple(replace(grasp, moments=moments) for grasp in agent.grasps))
        scenario = load_scenario(changes=[f"human.grasp={'wrench' if moments else 'point'}"])
        team, lifted = (agents_of(scenario)[0], held), object_of(scenario)
        assert {kernel_key(*request) for request in kernel_requests(team, lifted)} <= shipped
    assert kernel_key(*pose_request(team, lifted, 1, (2,))) in shipped
