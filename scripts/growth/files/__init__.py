"""Families of files: the worst known of each format, and the ordinary ones beside them."""
