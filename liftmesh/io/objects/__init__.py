"""Conversion between `Cloud` and objects of other libraries, one module per library."""
