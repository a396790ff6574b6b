"""`python -m rectbench` is the command line."""

from rectbench.cli import main

if __name__ == "__main__":
    main()
