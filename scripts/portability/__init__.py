"""The kernel built by several compilers for several machines: the same bits."""
