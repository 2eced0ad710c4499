"""All problems, in the order of the table."""

from peers import bolts, friction, modes, surfaces

PROBLEMS = [problem for room in (surfaces, bolts, friction, modes) for problem in room.PROBLEMS]
