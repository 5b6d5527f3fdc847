"""What can go wrong, sorted by whose turn it is: the exit code of the command line follows the class."""


class RbfemError(Exception):
    """Anything rbfem says on purpose. `exit_code` is what the command line returns."""

    exit_code = 1


class RunError(RbfemError):
    """The run itself failed: a step beyond its limit, a full disk, a state that is no longer finite."""

    exit_code = 1


class InputError(RbfemError):
    """A case or a mesh is wrong. The message names the place, what was read, what was expected and what to do."""

    exit_code = 2


class MissingLibraryError(RbfemError):
    """A library of the operating system is missing. The message names it and the command that installs it."""

    exit_code = 3
