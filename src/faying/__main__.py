"""python -m faying"""

from faying.cli import main

main()
