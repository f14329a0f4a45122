"""What users do with a lift, composed of the rooms behind it: ``import liftopt`` offers it."""
