# The public names of liftopt and where each is at home; ``__init__.py`` imports them when they are used.
from .errors import (
    InputError as InputError,
)
from .errors import (
    LiftoptError as LiftoptError,
)
from .errors import (
    ModelError as ModelError,
)
from .errors import (
    SolverError as SolverError,
)
from .face.lift import Solution as Solution
from .face.lift import load as load
from .face.lift import solve as solve
from .face.replanner import Replanner as Replanner
from .multibody.trajectory import AgentTrajectory as AgentTrajectory
from .multibody.trajectory import ObjectTrajectory as ObjectTrajectory
from .scenario.agents import Person as Person
from .scenario.box import Box as Box
from .scenario.file import shipped_scenarios as shipped_scenarios
from .scenario.model import Scenario as Scenario
from .scenario.model import load_scenario as load_scenario
from .scenario.obstacles import Obstacle as Obstacle
from .scenario.robot import Pose as Pose
from .scenario.robot import Robot as Robot
from .scenario.robot import Tool as Tool
from .scenario.settings import Limits as Limits
from .scenario.settings import Objective as Objective
from .scenario.settings import Refine as Refine
from .scenario.settings import Solver as Solver
from .scenario.task import GraspPlace as GraspPlace
from .scenario.task import Lift as Lift
from .scenario.task import ObjectPlace as ObjectPlace
from .solution.checks import Verification as Verification
from .solution.clearance import Clearance as Clearance
from .solution.finding import Assessment as Assessment
from .solution.finding import Finding as Finding
from .studies.pareto import pareto_front as pareto_front
from .studies.sensitivity import sensitivity as sensitivity
from .viz.viewer import view as view

__version__: str
