"""`python -m rbfem`."""

from rbfem.cli import main

main()
