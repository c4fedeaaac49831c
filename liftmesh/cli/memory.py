"""Whether a command failed for lack of memory, which shows as many kinds of exceptions."""

from __future__ import annotations


def out_of_memory(error: BaseException | None) -> bool:
    """Whether an exception is due to lack of memory.

    Parameters
    ----------
    error : BaseException, optional
        The exception; that of a compiled module that cannot be loaded is recognised by its message.

    Returns
    -------
    bool
        True also if lack of memory is the cause of another exception.

    Examples
    --------
    >>> out_of_memory(ImportError("a.so: failed to map segment from shared object"))
    True
    >>> out_of_memory(RuntimeError("std::bad_alloc"))
    True
    """
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
