"""Run the command line by ``python -m contvines.command``."""

from contvines.command.entry import main

main()
