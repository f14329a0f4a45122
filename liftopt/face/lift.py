"""What users do with a lift: solve it, save it, load it, show it. The rooms behind it are imported when needed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING

from liftopt.scenario.model import Scenario
from liftopt.solution import solution
from liftopt.types import Progress

if TYPE_CHECKING:
    import xarray as xr


class Solution(solution.Solution):
    """The best motion found for a scenario, with what can be done with it.

    It is solved only if ``solved`` says so; ``status`` says why not. ``solution["robot"].tau`` is the (K, n) torques of
    the agent of that name at the times ``solution.time`` (K,) [s].
    """

    @classmethod
    def of(cls, found: solution.Solution) -> Solution:
        """Return a solution that the search found or that was read from a file."""
        return cls(**{field.name: getattr(found, field.name) for field in fields(found)})

    def to_xarray(self) -> xr.Dataset:
        """Return all of it as the dataset that solution.nc holds: each variable with ``units`` (SI) and ``long_name``.

        Dimensions: ``time``, ``<agent>_joint``, ``xyz`` (world axes), ``quat`` (x y z w), ``twist`` (linear, then
        angular), ``grasp``, ``pose``.
        """
        from liftopt.storage.dataset import to_xarray

        return to_xarray(self)

    def save(self, folder: str | Path) -> Path:
        """Write it into a folder, whole or not at all: ``solution.nc``, and beside it the scenario and the URDFs.

        What is no solution never replaces one: if there is one in the folder, it goes to ``unsolved`` within.

        Returns:
            The folder that it was written to.

        Raises:
            InputError: it cannot be written.
        """
        from liftopt.storage.writer import save

        return save(self, Path(folder))

    def report(self, html: str | Path, *, meshes: bool | str | Path = False) -> None:
        """Write one self-contained page with playback, plots, tables and assessment; a file of that name is replaced.

        Args:
            html: where to.
            meshes: as ``picture`` has it.

        Raises:
            InputError: it cannot be written.
        """
        from liftopt.viz.report import write_report

        write_report(self, Path(html), meshes=meshes)

    def picture(
        self,
        file: str | Path,
        *,
        time: float | Sequence[float] | None = None,
        view: str = "three-quarter",
        meshes: bool | str | Path = False,
    ) -> None:
        """Write a picture of everybody, the object and the forces, as PNG or JPEG; a file of that name is replaced.

        Args:
            file: where to; its folder is made if need be.
            time: one moment or several, side by side [s]; None: start, middle and end.
            view: from where: ``"three-quarter"``, ``"side"``, ``"front"``, ``"top"``, ``"hands"``, ``"person"``,
                ``"robot"``, or an agent's name where there are several of a kind.
            meshes: draw robots from a file with their own meshes: True reads the URDF that the scenario names, which
                anybody may have written of a result that was loaded; a path names that file or its folder. Robots known
                by name are drawn with theirs anyhow.

        Raises:
            InputError: there is no such view or moment, or the file cannot be written.
        """
        from liftopt.viz.picture import write_picture

        write_picture(self, Path(file), time, view, meshes=meshes)


def solve(scenario: Scenario, *, progress: Progress | None = None) -> Solution:
    """Return the best verified lift of several starts; of one that has none, ``status`` says why.

    Args:
        scenario: what to lift.
        progress: called with one line at a time about what is going on.

    Raises:
        InputError: a value of the scenario cannot be used.
        SolverError: the solver cannot run at all.
    """
    from liftopt.search import solve as search

    return Solution.of(search.solve(scenario, progress=progress))


def load(path: str | Path) -> Solution:
    """Return the solution in a result folder, or in a file solution.nc.

    The file is taken for what anybody may have made of it: only what liftopt writes is read, within bounds.

    Raises:
        InputError: a file is missing, is no result of liftopt, or is damaged; it says which and why.
    """
    from liftopt.storage.reader import load_result

    return Solution.of(load_result(path))
