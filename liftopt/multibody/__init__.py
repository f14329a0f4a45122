"""Who lifts what: the human arm, the Sawyer robot and the table as URDFs and Pinocchio models."""
