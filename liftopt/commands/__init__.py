"""The command line: how its words are read, and how what was found is told."""
