"""The optimal-control problem: agents that hold one object, collocated on cubic B-splines."""
