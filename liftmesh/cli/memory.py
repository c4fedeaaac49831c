"""Whether a command failed for lack of memory, which shows as many kinds of exceptions."""

from __future__ import annotations


def out_of_memory(error: BaseException | None) -> bool:
    """Whether an exception is due to lack of memory."""
    if error is None:
        return False
    words = (
        "failed to map segment",
        "cannot allocate memory",
        "Cannot allocate memory",
        "without setting an exception",  # Python's parser can lose its MemoryError
        "without exception set",
    )
    kinds = (ImportError, OSError, SystemError)
    unable = isinstance(error, kinds) and any(word in str(error) for word in words)
    unable |= "std::bad_alloc" in str(error)  # of GEOS, under the name of its own error
    return unable or isinstance(error, MemoryError) or out_of_memory(error.__cause__)
