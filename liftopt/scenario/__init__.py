"""What is asked: who lifts what, from where to where, how fast."""
