"""The estimators of D and G, and what they share."""
