"""Files and objects of other libraries, to and from `Cloud`."""
