/* Asks callgrind, from a program that runs under it: the requests are instructions that do nothing
   on a processor. Counting is started once and then goes on, since callgrind translates all code
   anew each time it is switched. `mark` lets callgrind write its state to its log, with the
   instructions that each thread has executed so far. (A dump of what every function has executed,
   from which callgrind can be told to begin anew, takes as long as most calls that are counted.) */

#include <valgrind/callgrind.h>
#include <valgrind/valgrind.h>

void start(void) {
    CALLGRIND_START_INSTRUMENTATION;
}

void mark(void) {
    VALGRIND_MONITOR_COMMAND("status internal");
}
