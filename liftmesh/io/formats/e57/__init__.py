"""E57, files of terrestrial laser scanners: headers are checked, and libE57 decodes them apart."""
