"""Files in general: written whole, read within bounds, and what every reader and writer of text shares."""
