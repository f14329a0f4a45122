"""Write models/: the URDFs of the default subject, of Sawyer and of the table, and the subject's numbers.

Every URDF is read and checked by yourdfpy first, which the extra ``test`` has. With ``--check`` nothing is written: the
exit status is 1 if a file differs from what would be.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from io import BytesIO
from pathlib import Path

from liftopt.multibody.person.human import Subject, human_agent
from liftopt.multibody.person.provenance import Quantity, subject_quantities, whole_quantities
from liftopt.multibody.person.whole_body import whole_human_agent
from liftopt.multibody.placement import facing
from liftopt.multibody.robots.sawyer import sawyer_agent
from liftopt.multibody.table import lifted_table

SUBJECT = Subject(stature=1.75, mass=75.0, sex="male")
ARM_BODIES = "GT3 carries pelvis and legs, Q3 trunk, head and left arm."
WHOLE_BODIES = "The ankle moves both shanks, the knee both thighs, the hip the pelvis, Q3 trunk and head."


def default_files() -> dict[str, str]:
    """Return the text of each file of models/ that is generated, by name."""
    robot = sawyer_agent(place=facing(1.9), base_height=0.915, tool_length=0.15, tool_mass=0.4)
    return {
        "human_arm.urdf": human_agent(SUBJECT).urdf,
        "human_arm_numbers.md": numbers_page("human_arm.urdf", SUBJECT, subject_quantities(SUBJECT), ARM_BODIES),
        "whole_body.urdf": whole_human_agent(SUBJECT).urdf,
        "whole_body_numbers.md": numbers_page("whole_body.urdf", SUBJECT, whole_quantities(SUBJECT), WHOLE_BODIES),
        "sawyer.urdf": robot.urdf,
        "table.urdf": lifted_table(mass=2.0, depth=0.45, width=0.31, height=0.02).urdf,
    }


def numbers_page(urdf: str, subject: Subject, quantities: Sequence[Quantity], bodies: str) -> str:
    """Return a Markdown page with every number of the subject's model and its source.

    Args:
        urdf: name of the model's file.
        subject: who it is.
        quantities: the numbers.
        bodies: a sentence on what is on which body.
    """
    sources = list(dict.fromkeys(quantity.source for quantity in quantities))
    lines = [
        f"# Numbers of {urdf}: {subject.sex}, {subject.stature:g} m, {subject.mass:g} kg",
        "",
        "Written by `scripts/export_models.py`. Bodies in the upright zero pose: X forward, Y to the left, Z up,",
        "from the feet; inertia about the centre of mass.",
        bodies,
        "",
        "| group | quantity | value | unit | source |",
        "|---|---|---:|---|---:|",
    ]
    for item in quantities:
        # Adding zero turns a rounded -0.0 into 0.0.
        value = round(item.value, 5) + 0.0
        lines.append(f"| {item.group} | {item.name} | {value:g} | {item.unit} | {sources.index(item.source) + 1} |")
    lines += ["", "Sources:", ""]
    lines += [f"{number}. {source.citation} ({source.confidence})." for number, source in enumerate(sources, 1)]
    return "\n".join(lines) + "\n"


def fault(urdf: str) -> str | None:
    """Return what yourdfpy, which had no part in writing it, finds wrong with a URDF."""
    import yourdfpy

    read = yourdfpy.URDF.load(BytesIO(urdf.encode("ascii")), load_meshes=False, build_scene_graph=False)
    return None if read.validate() else str(read.errors)


def main(arguments: list[str] | None = None) -> int:
    """Export the models, or report which files differ from what would be written; return the exit status."""
    parser = argparse.ArgumentParser(description="Write the generated files of models/.")
    parser.add_argument("--out", type=Path, default=Path(__file__).parents[1] / "models", help="folder (models/)")
    parser.add_argument("--check", action="store_true", help="write nothing; fail if a file differs")
    options = parser.parse_args(arguments)
    stale = []
    for name, text in default_files().items():
        path = options.out / name
        if path.suffix == ".urdf" and (found := fault(text)) is not None:
            raise SystemExit(f"{name} is no valid URDF: {found}")
        if options.check:
            if not path.is_file() or path.read_bytes() != text.encode("ascii"):
                stale.append(str(path))
            continue
        options.out.mkdir(parents=True, exist_ok=True)
        path.write_bytes(text.encode("ascii"))
    if stale:
        print(f"out of date: {', '.join(stale)}; run scripts/export_models.py", file=sys.stderr)
    return 1 if stale else 0


if __name__ == "__main__":
    sys.exit(main())
