"""The command `faying`: each subcommand parses, calls the library, and shows; one file per command."""

from faying.cli.main import main

__all__ = ["main"]
