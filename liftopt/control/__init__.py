"""A lift that is solved anew while it runs."""
