"""Graphs of disks compared with CGAL's."""
