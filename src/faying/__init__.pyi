# The public names. Each is imported when it is first used (lazy_loader reads this file).

__version__: str
