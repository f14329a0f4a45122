"""The robot of the laboratory: trajectories for it, a dry run of them, and what it recorded."""
