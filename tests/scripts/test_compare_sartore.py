"""The published humanoid holds what liftopt says it holds. Oracle: Pinocchio's statics on their own file."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

pytest.importorskip("yourdfpy")

import liftopt as lo

ROOT = Path(__file__).parents[2]
FOLDER = ROOT.parent / "shared" / "data" / "sartore2022"


@pytest.mark.skipif(not FOLDER.is_dir(), reason="the published models are not here")
def test_the_arm_holds_its_share_at_rest_on_their_own_model() -> None:
    spec = importlib.util.spec_from_file_location("compare_sartore", ROOT / "scripts/compare_sartore.py")
    assert spec is not None and spec.loader is not None
    module: Any = importlib.util.module_from_spec(spec)
    sys.modules["compare_sartore"] = module
    spec.loader.exec_module(module)
    solution = lo.solve(module.scenario_at(FOLDER, 1.0, intervals=10))
    assert solution.status == "solved"
    robot, data = solution["robot"], solution.to_xarray()
    model = pin.buildModelFromUrdf(str(FOLDER / "model.urdf"))
    theirs, q = model.createData(), pin.neutral(model)
    columns = []
    for name, angle in zip(robot.joint_names, robot.q[-1], strict=True):
        joint = model.joints[model.getJointId(name.removeprefix("robot_"))]
        if joint.nq == 2:
            q[joint.idx_q : joint.idx_q + 2] = np.cos(angle), np.sin(angle)
        else:
            q[joint.idx_q] = angle
        columns.append(joint.idx_v)
    # What the hand does to the box the box does to the hand; the robot looks along -X of the world.
    force = -data.grasp_force.sel(grasp="robot").values[-1] * [-1.0, -1.0, 1.0]
    slopes = pin.computeFrameJacobian(
        model, theirs, q, model.getFrameId("r_hand_frame"), pin.LOCAL_WORLD_ALIGNED
    )[:3, columns]  # fmt: skip
    held = pin.computeGeneralizedGravity(model, theirs, q)[columns] - slopes.T @ force
    np.testing.assert_allclose(robot.tau[-1], held, rtol=0.0, atol=1e-6)
