"""What was found: the solution of a lift, its verification and its accuracy."""
