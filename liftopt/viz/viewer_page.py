"""The page that plays one lift, or two: one self-contained file with the meshcat viewer, the scene and the controls.

The page that ``liftopt view`` serves and the file that ``--html`` writes are the same bytes. The viewer, with three.js
in it, is meshcat's own file (``meshcat_files``); nothing else of meshcat is needed.
"""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np

from liftopt.assessment.who import hand_of, who_is
from liftopt.multibody.trajectory import AgentTrajectory
from liftopt.solution.solution import Solution
from liftopt.viz.meshcat_files import LICENCES, VIEWER, meshcat_text
from liftopt.viz.own_meshes import Meshes, figures_of
from liftopt.viz.playback import playback_of
from liftopt.viz.scene import Cast, lift_commands, lift_tracks
from liftopt.viz.scene_arrow import metres_per_newton
from liftopt.viz.scene_clearance import LINE, nearest_at
from liftopt.viz.scene_part import Colour
from liftopt.viz.scene_stage import stage_commands
from liftopt.viz.viewer_views import agents_in, head_of, views_of
from liftopt.viz.who import colour_of, lead_of

APART = 2.2  # [m] between two lifts side by side, along Y
SECOND_SHIRT: Colour = (0.10, 0.52, 0.38)
WORDS = {"person": "human", "robot": "robot"}
ABOVE_HEAD = 0.10  # [m]: of the name of a lift


def playback_page(
    solution: Solution,
    other: Solution | None = None,
    *,
    ghost: bool = False,
    sawyer: str | Path | None = None,
    meshes: Meshes = False,
) -> str:
    """Return the HTML of the playback.

    Args:
        solution: the lift to play.
        other: a second one, put beside the first on the person's left.
        ghost: draw the second one see-through in the first one's place instead.
        sawyer: the manufacturer's ``sawyer_description`` folder, for its meshes in place of our own primitives.
        meshes: where other robots' own meshes are looked for, as ``figures_of`` has it.

    Raises:
        InputError: there is no such folder, or as ``figures_of``.
    """
    return page_of(_casts(solution, other, ghost, None if sawyer is None else Path(sawyer), meshes))


def page_of(casts: Sequence[Cast]) -> str:
    """Return the HTML of the playback of one lift, or of two."""
    scale = metres_per_newton(force.force for cast in casts for force in cast.playback.forces.values())
    commands = stage_commands()
    tracks: list[dict[str, Any]] = []
    for cast in casts:
        commands += lift_commands(cast, casts[0] if cast.ghost else None)
        tracks += lift_tracks(cast, scale)
    data = {
        "commands": commands,
        "animation": {"type": "set_animation", "animations": tracks, "options": {"play": False, "repetitions": 1}},
        "lifts": [_facts(cast, name) for cast, name in zip(casts, _names(casts), strict=True)],
        "duration": max(float(cast.playback.time[-1]) for cast in casts),
        "metres_per_newton": scale,
        "views": [view.plain() for view in views_of(casts)],
        "hands": _hands(casts),
        "object": casts[0].solution.object.name,
        "nearest_colour": _hex(LINE),
        "labels": _labels(casts),
    }
    names = " and ".join(cast.solution.scenario.name for cast in casts)
    return _fill(data, f"{names} - liftopt")


def _casts(solution: Solution, other: Solution | None, ghost: bool, sawyer: Path | None, meshes: Meshes) -> list[Cast]:
    figures = figures_of(solution, meshes)
    casts = [Cast(solution, playback_of(solution), "/lift", sawyer=sawyer, figures=figures)]
    if other is not None:
        offset = (0.0, 0.0, 0.0) if ghost else (0.0, APART, 0.0)
        figures = figures_of(other, meshes)
        casts.append(Cast(other, playback_of(other), "/other", offset, ghost, sawyer, SECOND_SHIRT, figures))
    return casts


def _names(casts: Sequence[Cast]) -> list[str]:
    """Return what to call the lifts: their scenarios' names, told apart if they are the same."""
    names = [cast.solution.scenario.name for cast in casts]
    if len(set(names)) < len(names):
        return [f"{name} ({place})" for name, place in zip(names, ("first", "second"), strict=True)]
    return names


def _facts(cast: Cast, name: str) -> dict[str, Any]:
    """Return what the page writes beside the picture."""
    solution, playback = cast.solution, cast.playback
    sizes = {name: np.round(np.linalg.norm(f.force, axis=1), 2).tolist() for name, f in playback.forces.items()}
    return {
        "root": cast.root,
        "name": name,
        "status": solution.status,
        "solved": solution.solved,
        "ghost": cast.ghost,
        "colour": _hex(cast.colour),
        "time": np.round(playback.time, 5).tolist(),
        "force": sizes,
        "nearest": _nearest(cast),
        "height": np.round(playback.bodies[solution.object.name].position[:, 2], 4).tolist(),
    }


def _nearest(cast: Cast) -> dict[str, Any] | None:
    """Return how far the nearest two bodies are apart and which two, frame by frame; None if that is unknown."""
    found = nearest_at(cast.solution.clearance, cast.playback.time)
    if found is None:
        return None
    pairs = list(dict.fromkeys(found["pairs"]))
    return {
        "distance": np.round(found["distance"], 4).tolist(),
        "pair": [pairs.index(pair) for pair in found["pairs"]],
        "pairs": pairs,
    }


def _hands(casts: Sequence[Cast]) -> list[dict[str, str]]:
    """Return grasp, colour and words of every hand whose force is shown in either lift, agent by agent."""
    agents, rows = agents_in(casts), {}
    for first in agents:
        who, colour = who_is(first, agents), colour_of(agents, first)
        called = f"the {WORDS[first.kind]}" if who.is_alone else first.name
        for agent in (one for cast in casts for one in cast.solution.agents if one.name == first.name):
            for grasp in agent.grasps:
                words = called if len(agent.grasps) == 1 else f"{called}'s {hand_of(grasp.name, who)}"
                rows[grasp.name] = {"name": grasp.name, "who": words, "colour": _hex(colour)}
    return list(rows.values())


def _labels(casts: Sequence[Cast]) -> list[dict[str, Any]]:
    """Return what stands above heads: the names of two lifts, and of agents that there are several of."""
    labels = []
    for cast, name in zip(casts, _names(casts), strict=True):
        agents = cast.solution.agents
        if len(casts) > 1:
            labels.append(_label(cast, lead_of(agents), name + (" (ghost)" if cast.ghost else ""), cast.colour))
        for agent in agents:
            if not who_is(agent, agents).is_alone:
                labels.append(_label(cast, agent, agent.name, colour_of(agents, agent)))
    return labels


def _label(cast: Cast, agent: AgentTrajectory, text: str, colour: Colour) -> dict[str, Any]:
    x, y, z = head_of(cast, agent).tolist()
    return {"text": text, "colour": _hex(colour), "at": [x, y, z + ABOVE_HEAD]}


def _hex(colour: Colour) -> str:
    return "#" + "".join(f"{round(255 * value):02x}" for value in colour)


def _fill(data: dict[str, Any], title: str) -> str:
    assets = files("liftopt.viz") / "assets"
    text = json.dumps(data, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")
    licences = [meshcat_text(name) for name in LICENCES if not name.endswith(".json")]
    pieces = {
        "@TITLE@": title.replace("&", "&amp;").replace("<", "&lt;"),
        "@STYLE@": (assets / "playback.css").read_text(encoding="utf-8"),
        "@LICENCES@": "\n".join(licences).replace("--", "- -").replace("</", "<\\/"),
        "@VIEWER@": meshcat_text(VIEWER).replace("</script", "<\\/script"),
        "@DATA@": text,
        "@CAMERA@": (assets / "camera.js").read_text(encoding="utf-8"),
        "@SCRIPT@": (assets / "playback.js").read_text(encoding="utf-8"),
    }
    page = (assets / "playback.html").read_text(encoding="utf-8")
    # In one pass: a piece may hold what looks like a mark.
    return re.sub("|".join(pieces), lambda mark: pieces[mark.group()], page)
