"""The local page: a server on this machine alone, in front of a project folder and the command line."""
