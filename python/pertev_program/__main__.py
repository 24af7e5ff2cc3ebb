"""`python -m pertev_program` is the program, wherever its command is not on the path."""

from pertev_program import main

main()
