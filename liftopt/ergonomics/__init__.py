"""What a solved lift asks of the person: share of strength, posture scores and lifting guides, each with its scope."""
