// Points that come and go, and terrains that are simplified.
#pragma once

#include "clouds.hpp"

namespace parallel {

// Inserts and removes rows, one by one and many at once, on several callers' threads; the number of
// triangles must be that of a fresh run. Then it simplifies a terrain of the rows. Ends the process
// if anything differs.
void check_changes(const Cloud& cloud);

}  // namespace parallel
