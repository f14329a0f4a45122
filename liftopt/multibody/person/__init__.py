"""The person: segments, ranges of motion and strengths by stature, mass and sex."""
