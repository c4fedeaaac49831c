"""LAS and LAZ, the files of airborne lidar: laspy and lazrs decode them, once they are checked."""
