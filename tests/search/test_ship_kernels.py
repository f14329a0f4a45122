"""What is shipped serves what is solved: the oracle is the object of a scenario itself."""

from __future__ import annotations

from liftopt.collocation.codegen.kernels import kernel_key
from liftopt.collocation.problem import kernel_requests
from liftopt.scenario.build import agents_of, object_of
from liftopt.scenario.model import load_scenario
from liftopt.search.ship_kernels import shipped_requests


def test_every_grasp_of_a_shipped_object_has_a_frame_of_its_own() -> None:
    # Frames of one name would be one frame in the kernel, and so at one place.
    for requests in shipped_requests():
        for _, topology in requests:
            assert len(set(topology.frames)) == len(topology.frames)


def test_the_object_of_a_person_with_two_hands_and_a_robot_is_shipped() -> None:
    shipped = {kernel_key(*request) for requests in shipped_requests() for request in requests}
    scenario = load_scenario(changes=["human.body=whole"])
    assert {kernel_key(*request) for request in kernel_requests(agents_of(scenario), object_of(scenario))} <= shipped
