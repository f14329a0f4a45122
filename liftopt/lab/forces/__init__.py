"""The force of a hand: sensors, their calibration and their records."""
