"""Objects of other libraries, to and from `Cloud`: a module for each library."""
