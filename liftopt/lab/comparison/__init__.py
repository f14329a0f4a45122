"""The experiment beside the prediction."""
