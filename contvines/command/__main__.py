"""`python -m contvines.command` does what `contvines` does."""

from contvines.command.cli import main

main()
