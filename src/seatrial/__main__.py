"""The command line as ``python -m seatrial``, where the script of that name is not on the path."""

from seatrial.cli import main

if __name__ == "__main__":
    main()
