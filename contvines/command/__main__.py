"""`python -m contvines.command` does what `contvines` does."""

from contvines.command.entry import main

main()
