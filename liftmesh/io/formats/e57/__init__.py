"""E57, files of laser scanners: headers are checked, libE57 decodes in a separate process."""
