"""Robots that are known by name. Oracle: the files of example-robot-data, where they are installed."""

from __future__ import annotations

from pathlib import Path

import pytest

pytest.importorskip("yourdfpy")

from liftopt.errors import InputError
from liftopt.multibody.robots.catalogue import known_or_path, known_robots
from liftopt.multibody.robots.chosen_robot import chosen_robot
from liftopt.multibody.robots.example_robot_data import share_folder
from liftopt.multibody.robots.sawyer_description import JOINTS
from liftopt.multibody.robots.weight_findings import weight_findings
from liftopt.storage.urdf_check import check_urdf

KNOWN = known_robots()


@pytest.mark.skipif(share_folder() is None, reason="example-robot-data is not installed (it is in 'test')")
@pytest.mark.parametrize("name", KNOWN)
def test_every_known_robot_can_lift_as_it_is_known(name, known_agent):
    found = chosen_robot(name).examination()
    assert not found.refused
    assert 5 <= len(found.chain.links) <= 8
    assert 0.2 < found.chain.reach < 2.0
    agent = known_agent(name)
    check_urdf(agent.urdf)
    assert agent.model.nq == len(found.chain.links)
    assert (agent.limits.q_lower < agent.posture).all() and (agent.posture < agent.limits.q_upper).all()


def test_payloads_have_a_source_and_names_are_those_that_can_be_typed():
    assert len(KNOWN) >= 30
    assert len({known.maker for known in KNOWN.values()}) >= 8
    for name, known in KNOWN.items():
        assert name.replace("_", "").isalnum() and name.islower()
        assert (known.payload is None) == (known.payload_source is None)


def test_sawyer_is_known_without_any_file():
    limits = [joint.effort for joint in JOINTS]
    assert [joint.effort for joint in chosen_robot("sawyer").examination().chain.joints] == limits


@pytest.mark.skipif(share_folder() is None, reason="example-robot-data is not installed (it is in 'test')")
def test_placeholders_in_public_files_are_told():
    """The right arm of Alex has 1000 Nm where the left one has 80 and 150; iCub's joints turn at 100 rad/s."""
    found = {name: chosen_robot(name).examination() for name in KNOWN}
    codes = {name: {finding.code for finding in examination.findings} for name, examination in found.items()}
    assert "effort.large" in codes["alex_right"] and "effort.large" not in codes["alex_left"]
    assert "velocity.large" in codes["icub_right"]
    assert "weight.springs" in codes["baxter_left"]
    assert {name for name in codes if "effort.same" in codes[name]} == {"so100", "so101"}
    # The inertias of UR5's wrist, and the first link of Panda, of which only one moment matters.
    large = {name for name in codes if "inertia.large" in codes[name]}
    assert large == {"ur5", "ur5_limited", "ur5_gripper", "panda"}
    # Whose motors cannot bear their weight have springs, of which the catalogue tells instead.
    weak = {name for name, examination in found.items() if any(weight_findings(examination.chain))}
    assert weak == {name for name, known in KNOWN.items() if known.springs}
    assert not any("weight.effort" in seen for seen in codes.values())


def test_a_word_is_a_name_or_a_file(tmp_path: Path):
    (tmp_path / "arm.urdf").write_text("")
    assert known_or_path(str(tmp_path / "arm.urdf")) == tmp_path / "arm.urdf"
    assert known_or_path("ur10") is not Path("ur10")
    with pytest.raises(InputError, match=r"robot = 'ur11': must be a name .* did you mean ur10"):
        known_or_path("ur11")
    with pytest.raises(InputError, match="must be a name"):
        known_or_path("x" * 5000)


def test_what_is_not_installed_says_how_to_install_it(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("liftopt.multibody.robots.known_robot.share_folder", lambda: None)
    assert not KNOWN["ur5"].is_installed and KNOWN["sawyer"].is_installed
    with pytest.raises(InputError, match=r"liftopt\[robots\]"):
        KNOWN["ur5"].description()
