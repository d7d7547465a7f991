"""Run the command line by ``python -m contvines``."""

from contvines.command.entry import main

main()
