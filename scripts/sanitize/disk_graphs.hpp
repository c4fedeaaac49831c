// Graphs of disks and stars in metrics of their own.
#pragma once

#include "clouds.hpp"

namespace parallel {

// Makes the graph of disks around the rows, and the stars of the rows, on several callers' threads,
// interrupts both, and verifies the graph on one thread and on many, also spoilt. Ends the process
// if anything differs.
void check_disks(const Cloud& cloud);

}  // namespace parallel
