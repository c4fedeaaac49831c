"""Conversion between `Cloud` and files, and between `Cloud` and objects of other libraries."""
