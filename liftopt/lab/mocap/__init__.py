"""Motion capture: files of markers and what they say of a person."""
