"""`python -m contvines` does what `contvines` does."""

from contvines.command.entry import main

main()
