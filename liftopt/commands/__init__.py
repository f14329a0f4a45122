"""The command line: how its words are read."""
