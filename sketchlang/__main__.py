"""`python -m sketchlang` is the command line."""

from sketchlang.cli import main

main()
