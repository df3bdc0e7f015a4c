"""Files referenced by another file: only those in its folder and below, after resolving links."""

from pathlib import Path

from cutpoint.errors import ModelError


def file_within(folder: Path, name: str, otherwise: str) -> Path:
    """The path of a file that is named relative to a folder.

    otherwise: advice for a file kept elsewhere.
    Raises ModelError, without a place: the file does not exist, or is not within the folder.
    """
    path = folder / name
    try:
        if not path.resolve().is_relative_to(folder.resolve()):
            told = f"{name!r} is not within {str(folder)!r}, so it is not read, for safety"
            raise ModelError(f"{told}; put the file there, or {otherwise}", file=name)
        if not path.exists():
            raise ModelError(f"there is no file {name!r} in {str(folder)!r}; put it there", file=name)
    except (OSError, RuntimeError, ValueError) as problem:  # names that are too long, circular links
        if isinstance(problem, ModelError):
            raise
        told = getattr(problem, "strerror", problem)
        raise ModelError(f"{name[:80]!r} cannot be read: {told}", file=name) from problem
    return path
