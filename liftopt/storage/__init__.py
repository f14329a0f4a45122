"""Results in files, in and out: whole or not at all, and read with care where they come from elsewhere."""
