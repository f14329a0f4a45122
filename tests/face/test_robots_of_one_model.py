"""Two robots of one model and a person in one lift, from a scenario file to the page that plays it.

Oracle: Pinocchio on the written URDFs.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

pytest.importorskip("yourdfpy")

import liftopt as lo
from liftopt.commands.cli import main
from liftopt.multibody.robots.example_robot_data import share_folder

pytestmark = pytest.mark.long
FILE = Path(__file__).parents[1] / "scenario" / "teams" / "person_two_ur5.toml"
CHEAP = {"solver.intervals": 10, "solver.starts": 1, "solver.tries": 4}


@pytest.mark.skipif(share_folder() is None, reason="example-robot-data is not installed (it is in 'test')")
def test_their_names_never_clash(tmp_path: Path) -> None:
    solution = lo.solve(lo.load_scenario(FILE, CHEAP))
    assert solution.status == "solved"
    folder = solution.save(tmp_path / "lift")
    data = lo.load(folder).to_xarray()
    left, right = ([str(name) for name in data[f"{side}_joint"].values] for side in ("left", "right"))
    assert left == [name.replace("right_", "left_", 1) for name in right] and not set(left) & set(right)
    for side in ("left", "right"):
        model = pin.buildModelFromUrdf(str(folder / "models" / f"{side}.urdf"))
        kinematics = model.createData()
        for q, point in zip(data[f"{side}_q"].values, data.grasp_position.sel(grasp=side).values, strict=True):
            pin.framesForwardKinematics(model, kinematics, q)
            tip = kinematics.oMf[model.getFrameId(f"{side}_grasp")].translation
            np.testing.assert_allclose(tip, point, rtol=0.0, atol=1e-5)
    page = tmp_path / "lift.html"
    assert main(["view", str(folder), "--html", str(page)]) == 0
    assert all(f'"{name}"' in page.read_text(encoding="utf-8") for name in ("human", "left", "right"))
