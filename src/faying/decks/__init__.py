"""The joint in the words of other solvers: one file for each, all fed by the same `JointDeck`."""
