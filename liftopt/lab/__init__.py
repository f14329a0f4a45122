"""The laboratory: what devices recorded, and what the robot is given. Solutions are read here, never the solver."""
