"""Several lifts: what an answer hinges on, and what it trades."""
